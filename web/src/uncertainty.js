/** How sure values are: errors of their natural logarithms are Gaussian. */

import { measureSquare } from "./colour_content.js";
import { BALANCES, DOUBTS, SENTENCES, SKIN } from "./python_data.js";
import { roundHalfEven } from "./rounding.js";
import { fill, toPercent } from "./sentences.js";
import { LINEAR } from "./srgb.js";

const QUANTILE = 1.6448536269514722; // of the normal distribution, for intervals of 90 %

const MOST_PIXELS = 1 << 20; // of larger boxes, every second pixel is looked at, and so on

const DARKEST = 1e-4; // linear sRGB

const PICK_WHITE =
  "If something white or grey is in the photograph, lit as the face is, click on it with the tool " +
  "“Pick white”: its colour tells the light.";

const LEAST_MASK = 0.5; // pixels with a larger mask are counted as skin

export function isSkin(mask) {
  return mask > LEAST_MASK;
}

/** Between which fractions the true one lies in nine of ten photographs. */
export function findInterval(value, logSd, top) {
  const factor = Math.exp(QUANTILE * logSd);
  return [Math.min(value / factor, top), Math.min(value * factor, top)];
}

/** Mean of a plane over skin; null without skin. */
export function averageSkin(plane, mask) {
  let sum = 0;
  let count = 0;
  plane.forEach((value, at) => {
    if (!isSkin(mask[at])) return;
    sum += value;
    count += 1;
  });
  return count ? sum / count : null;
}

/**
 * Sentences on why what was read should not be trusted, those of Python apart from the remedy.
 * @param who what was read, such as "the face in a.jpg"
 * @param upright planes of the cut, as the network gives them
 * @param skinShare share of skin in what was read
 * @param clipped share of the skin that is saturated
 * @param chromaticity log R/G and log B/G of the skin; null without skin
 */
export function listDoubts({
  who, upright, skinShare, clipped, chromaticity, faceSd, whiteBalance, isWhiteKnown,
}) {
  const doubts = noteLittleSkin(who, skinShare);
  if (!skinShare) return doubts;
  const melanin = averageSkin(upright.melanin, upright.mask);
  if (clipped > DOUBTS.CLIPPED_SHARE) {
    doubts.push(fill(SENTENCES.clipped, { who, share: toPercent(clipped) }));
  }
  if (melanin !== null && melanin >= DOUBTS.DARK_SKIN) doubts.push(fill(SENTENCES.darkSkin, { who }));
  const tint = isWhiteKnown || !chromaticity ? null : findTint(chromaticity);
  return [...doubts, ...listUnknown({ who, faceSd, whiteBalance, isWhiteKnown, tint })];
}

/** Note that there is hardly any skin in what was read. */
function noteLittleSkin(who, share) {
  if (share >= DOUBTS.LITTLE_SKIN) return [];
  if (share === 0) return [fill(SENTENCES.noSkin, { who })];
  return [fill(SENTENCES.littleSkin, { who, value: Number((100 * share).toPrecision(1)) })];
}

/** The cast of skin by its log R/G and log B/G; null if its colour is usual. */
function findTint(chromaticity) {
  if (measureSquare(chromaticity) < DOUBTS.TINTED) return null;
  const [red, blue] = chromaticity.map((ratio, at) => Math.exp(ratio - SKIN.USUAL_RATIOS[at]));
  const cb = 0.5 * blue - 0.169 * red - 0.331;
  const cr = 0.5 * red - 0.419 - 0.081 * blue;
  return DOUBTS.CASTS.at(roundHalfEven(Math.atan2(-cb, cr) / (Math.PI / 4)) % DOUBTS.CASTS.length);
}

/** Whether a white balance that was told is far from what is seen without it. */
export function doubtWhite(who, told, blind) {
  const isApart = told.some((one, at) => Math.abs(one - blind[at]) > BALANCES.MOST_BLIND);
  const format = (balance) => Array.from(balance, (one) => one.toFixed(2)).join(", ");
  if (!isApart) return [];
  return [fill(SENTENCES.whiteDoubt, { who, told: format(told), blind: format(blind) })];
}

/** What cannot be told, and what would help. */
function listUnknown({ who, faceSd, whiteBalance, isWhiteKnown, tint }) {
  const [melanin, hemoglobin] = faceSd.map((sd) => Math.exp(QUANTILE * sd));
  const doubts = [];
  if (melanin ** 2 > DOUBTS.MELANIN_SPAN) {
    const factor = Number(melanin.toPrecision(2));
    doubts.push(fill(SENTENCES.melaninDoubt, { who, melanin: factor }));
  }
  if (hemoglobin ** 2 > DOUBTS.HEMOGLOBIN_SPAN) {
    doubts.push(fill(SENTENCES.hemoglobinDoubt, { who }));
  }
  if (tint !== null) doubts.push(fill(SENTENCES.tinted, { who, tint }));
  else if (!isWhiteKnown && Math.max(...whiteBalance.map(Math.abs)) > DOUBTS.COLOURED) {
    doubts.push(fill(SENTENCES.lightDoubt, { who }));
  }
  if (doubts.length) doubts.push(isWhiteKnown ? SENTENCES.daylight : PICK_WHITE);
  return doubts;
}

/** Of the skin in a box of the photograph: the share that is saturated, and its colour. */
export function measureSkin(photo, box, mask, width, height) {
  const [across, down] = [box.right - box.left, box.bottom - box.top];
  const step = Math.max(1, Math.floor(Math.sqrt((across * down) / MOST_PIXELS)));
  let clipped = 0;
  let count = 0;
  const sums = [0, 0, 0];
  for (let y = 0; y < down; y += step) {
    const line = Math.floor(((y + 0.5) * height) / down) * width;
    for (let x = 0; x < across; x += step) {
      if (!isSkin(mask[line + Math.floor(((x + 0.5) * width) / across)])) continue;
      count += 1;
      const at = ((box.top + y) * photo.width + box.left + x) * photo.channels;
      const { data } = photo;
      if (data[at] === 255 || data[at + 1] === 255 || data[at + 2] === 255) clipped += 1;
      sums.forEach((_, channel) => {
        sums[channel] += LINEAR[data[at + channel]];
      });
    }
  }
  if (!count) return { clipped: 0, chromaticity: null };
  const [red, green, blue] = sums.map((sum) => Math.log(Math.max(sum / count, DARKEST)));
  return { clipped: clipped / count, chromaticity: [red - green, blue - green] };
}
