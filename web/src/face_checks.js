/** Faces that cannot be read, as `skinnet.inference._face_checks` says of them. */

import { checkColour } from "./colour_content.js";
import { placeFaceInCut } from "./head_crop.js";
import { FACES, SENTENCES } from "./python_data.js";
import { roundHalfEven } from "./rounding.js";
import { Refusal, capitalise, fill, toPercent } from "./sentences.js";
import { findMedian } from "./statistics.js";
import { cutSquare, placePoint } from "./turned_square.js";

/**
 * Notes on a face; throws a sentence if it cannot be read. `who` it is begins with a small letter.
 * A face that the user has marked may be drawn.
 */
export function checkFace(photo, crop, face, who, name, isMarked) {
  const start = capitalise(who);
  const width = face.box.right - face.box.left;
  if (width < FACES.LEAST_WIDTH) {
    throw new Refusal(fill(SENTENCES.small, { who: start, width, _LEAST_WIDTH: FACES.LEAST_WIDTH }));
  }
  const share = measureInside(face, photo);
  const inside = toPercent(share);
  if (share < FACES.LEAST_INSIDE) {
    throw new Refusal(fill(SENTENCES.outside, { who: start, inside }));
  }
  if (!isMarked) refuseDrawing(photo, face, start);
  checkCrop(photo, crop, face, name, isMarked);
  return share < FACES.MOST_INSIDE ? [fill(SENTENCES.partlyOutside, { who: start, inside })] : [];
}

function measureInside(face, photo) {
  const inside = listInside(face, photo, FACES.STEPS);
  return inside.filter((isInside) => isInside).length / inside.length;
}

/** Whether the pixels of a face, cut at a size, are inside the photograph. */
function listInside(face, { width, height }, size) {
  const square = placeSquare(face);
  return Array.from({ length: size * size }, (_, at) => {
    const [x, y] = placePoint(square, size, [(at % size) + 0.5, Math.floor(at / size) + 0.5]);
    return x > 0 && y > 0 && x < width && y < height;
  });
}

function placeSquare({ box, tilt }) {
  return {
    x: (box.left + box.right) / 2,
    y: (box.top + box.bottom) / 2,
    side: box.right - box.left,
    tilt: (tilt * Math.PI) / 180,
  };
}

function refuseDrawing(photo, face, who) {
  const size = Math.min(FACES.FLAT_SIZE, face.box.right - face.box.left);
  const { data } = cutSquare(placeSquare(face), photo, size);
  const pixels = [];
  listInside(face, photo, size).forEach((isInside, at) => {
    if (isInside) pixels.push([data[3 * at], data[3 * at + 1], data[3 * at + 2]]);
  });
  const share = measureFlatShare(pixels);
  if (share > FACES.FLAT_SHARE) {
    throw new Refusal(fill(SENTENCES.drawn, { who, share: toPercent(share) }));
  }
}

/** The largest share of pixels in one colour that is not saturated. */
function measureFlatShare(pixels) {
  const brightness = pixels.map((pixel) => Math.max(...pixel));
  const middle = findMedian(brightness);
  if (middle < FACES.DARK) return 0;
  const scale = FACES.MIDDLE / middle / FACES.COLOUR_WIDTH;
  const unsaturated = pixels.filter((_, at) => brightness[at] < FACES.WHITE);
  let most = 0;
  for (let shift = 0; shift < 8; shift++) {
    const counts = new Map();
    for (const pixel of unsaturated) {
      const level = (channel) => Math.trunc(pixel[channel] * scale + ((shift >> channel) & 1) / 2);
      const key = level(0) + 1000 * level(1) + 1e6 * level(2);
      counts.set(key, (counts.get(key) ?? 0) + 1);
    }
    most = Math.max(most, ...counts.values());
  }
  return most / pixels.length;
}

function checkCrop(photo, crop, face, name, isMarked) {
  if (!crop.square) {
    checkColour(photo, crop.box, face.box, name, isMarked);
    return;
  }
  const size = Math.min(roundHalfEven(crop.square.side), FACES.COLOUR_SIZE);
  const whole = { left: 0, top: 0, right: size, bottom: size };
  const cut = cutSquare(crop.square, photo, size);
  checkColour(cut, whole, placeFaceInCut(size), name, isMarked);
}
