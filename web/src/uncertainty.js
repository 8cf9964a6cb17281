/** How sure values are: errors of their natural logarithms are Gaussian. */

const QUANTILE = 1.6448536269514722; // of the normal distribution, for intervals of 90 %

const MELANIN_SPAN = 3; // ratios of an interval's ends above which a pigment cannot be told
const HEMOGLOBIN_SPAN = 5;
const COLOURED = 0.35; // error of log R/G or log B/G above which the light is strongly coloured
const CLIPPED_SHARE = 0.1; // of the skin that may be overexposed without a note
const SKIN = 0.5; // pixels with a larger mask are counted as skin

export function isSkin(mask) {
  return mask > SKIN;
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

/** Sentences on why what was read should not be trusted. */
export function listDoubts(cut, mask, faceSd, whiteBalance, isWhiteKnown) {
  const [melanin, hemoglobin] = faceSd.map((sd) => Math.exp(QUANTILE * sd));
  const doubts = [];
  if (melanin ** 2 > MELANIN_SPAN) {
    doubts.push(
      `Melanin cannot be told well from this photograph: it may be ${melanin.toPrecision(2)} ` +
        "times higher or lower than what is read.",
    );
  }
  if (hemoglobin ** 2 > HEMOGLOBIN_SPAN) {
    doubts.push(
      "Hemoglobin cannot be told from this photograph: what is read is near that of people at " +
        "large.",
    );
  }
  if (!isWhiteKnown && Math.max(...whiteBalance.map(Math.abs)) > COLOURED) {
    doubts.push(
      "The light is strongly coloured, or the camera's white balance is wrong; the pigments are " +
        "only as right as the guess of it.",
    );
  }
  if (doubts.length) {
    doubts.push(
      isWhiteKnown
        ? "Give a photograph in daylight, without coloured light, filters or retouching."
        : "If something white or grey is in the photograph, lit as the face is, click on it with " +
          "the tool “Pick white”.",
    );
  }
  const clipped = measureClipping(cut, mask);
  if (clipped > CLIPPED_SHARE) {
    doubts.unshift(
      `${Math.round(100 * clipped)} % of the skin is overexposed: its colour is lost, and its ` +
        "pigments are read too low. Give a photograph with a shorter exposure.",
    );
  }
  return doubts;
}

/** Share of skin in which a channel is saturated. */
function measureClipping(photo, mask) {
  let clipped = 0;
  let count = 0;
  mask.forEach((value, at) => {
    if (!isSkin(value)) return;
    count += 1;
    const start = at * photo.channels;
    if ([0, 1, 2].some((channel) => photo.data[start + channel] === 255)) clipped += 1;
  });
  return count ? clipped / count : 0;
}
