/** White balance by something white or grey in the photograph (`Capture.from_reference`). */

import { LINEAR, toSrgb } from "./srgb.js";

/** Linear sRGB to the balanced channels of the mean camera. */
const TO_CAMERA = [
  [0.540070474, 0.361235976, 0.098693445],
  [0.050515458, 0.726624548, 0.222859979],
  [0.002372061, 0.270590574, 0.727037191],
];

const SHARE = 0.004; // half of the side of the square around a point, of the longer side
const LEAST_HALF = 2; // the same in pixels

const CLIPPED = 250; // levels from which a channel is overexposed, and below which all is noise
const DARK = 20;
const MOST_CLIPPED = 0.02; // share of the pixels that may be overexposed
const MOST_SPREAD = 0.25; // standard deviation of the brightness, relative to its mean
const MOST_COLOURED = 0.9; // norm of log R/G and log B/G
const LEAST = 1e-3; // smallest value whose logarithm is taken

/** Logarithms of the errors in R/G and B/G; throws a sentence if the place cannot be used. */
export function measureWhite(photo, x, y) {
  const { colours, clipped } = readSquare(photo, Math.floor(x), Math.floor(y));
  if (clipped > MOST_CLIPPED) {
    throw new Error(
      "The white reference is overexposed, which hides its true colour. Choose a darker part of " +
        "it, or something grey.",
    );
  }
  const brightness = colours.map((colour) => average(colour));
  const mean = average(brightness);
  const spread = Math.sqrt(average(brightness.map((value) => (value - mean) ** 2)));
  if (spread > MOST_SPREAD * Math.max(mean, 0.02)) {
    throw new Error(
      "The white reference is uneven: a shadow or an edge lies in it. Choose a place of one colour.",
    );
  }
  return balance([0, 1, 2].map((channel) => average(colours.map((colour) => colour[channel]))));
}

function readSquare({ data, width, height, channels }, x, y) {
  const half = Math.max(LEAST_HALF, Math.round(SHARE * Math.max(width, height)));
  const colours = [];
  let clipped = 0;
  for (let row = Math.max(0, y - half); row < Math.min(height, y + half + 1); row++) {
    for (let column = Math.max(0, x - half); column < Math.min(width, x + half + 1); column++) {
      const start = (row * width + column) * channels;
      const levels = [0, 1, 2].map((channel) => data[start + channel]);
      if (Math.max(...levels) >= CLIPPED) clipped += 1;
      colours.push(levels.map((level) => LINEAR[level]));
    }
  }
  return { colours, clipped: clipped / colours.length };
}

function balance(linear) {
  const levels = linear.map((value) => 255 * toSrgb(value));
  const named = `The white reference (${levels.map(Math.round).join(", ")})`;
  if (Math.max(...levels) < DARK) {
    throw new Error(
      `${named} is too dark: below ${DARK} of 255 its colour is noise. Choose something brighter ` +
        "in the light that falls on the face.",
    );
  }
  const [red, green, blue] = TO_CAMERA.map((row) =>
    Math.log(Math.max(row.reduce((sum, weight, at) => sum + weight * linear[at], 0), LEAST)),
  );
  const logs = [red - green, blue - green];
  if (Math.hypot(...logs) > MOST_COLOURED) {
    throw new Error(
      `${named} is coloured more than light makes white. Choose something white or grey.`,
    );
  }
  return logs;
}

function average(values) {
  return values.reduce((sum, value) => sum + value, 0) / values.length;
}
