/** The colours of log changes: blue is less blood, white the same, red more (`_map_frame.py`). */

import { CHANGES } from "../python_data.js";
import { clamp } from "../rounding.js";

const { LARGEST_CHANGE, CHANGE } = CHANGES;

/** The colour of a place along the scale, from 0 to 1. */
export function colourPlace(place) {
  const at = clamp(place, 0, 1) * (CHANGE.length - 1);
  const first = Math.min(Math.floor(at), CHANGE.length - 2);
  return CHANGE[first].map((low, channel) =>
    Math.round(low + (at - first) * (CHANGE[first + 1][channel] - low)),
  );
}

/** The colour of a log change. */
export function colourChange(change) {
  return colourPlace(change / (2 * LARGEST_CHANGE) + 0.5);
}

/** A log change in percent, with its sign. */
export function formatChange(change) {
  const percent = Math.round(100 * (Math.exp(change) - 1));
  if (percent === 0) return "0 %";
  return `${percent > 0 ? "+" : "−"}${Math.abs(percent)} %`;
}

/** Two log changes in percent. */
export function formatChanges(low, high) {
  return `${formatChange(low).replace(" %", "")} to ${formatChange(high)}`;
}

/** Draw the scale in a canvas, and list the labels of its places [[place, text], ...]. */
export function drawScale(canvas) {
  Object.assign(canvas, { width: 256, height: 1 });
  const data = new Uint8ClampedArray(4 * canvas.width).fill(255);
  for (let at = 0; at < canvas.width; at++) data.set(colourPlace(at / (canvas.width - 1)), 4 * at);
  canvas.getContext("2d").putImageData(new ImageData(data, canvas.width, 1), 0, 0);
  return [0, 0.25, 0.5, 0.75, 1].map((place) => [
    place, formatChange((2 * place - 1) * LARGEST_CHANGE),
  ]);
}
