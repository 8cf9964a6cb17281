/** Textures and landmarks of readings in few bytes, so that those of a whole clip can be kept. */

import { CHANGES } from "../python_data.js";
import { clamp } from "../rounding.js";

const STEPS = 127; // of a change on either side of 0
const LARGEST = 1.25 * CHANGES.LARGEST_CHANGE;
const HIDDEN = -128;
const PART = 4; // of a pixel

/** A reading with its texture and landmarks in bytes. */
export function packReading(reading) {
  const { texture, landmarks } = reading;
  return {
    ...reading,
    texture: texture && Int8Array.from(texture, packChange),
    landmarks: landmarks && Int16Array.from(landmarks.flat(), (place) => Math.round(PART * place)),
  };
}

function packChange(change) {
  if (Number.isNaN(change)) return HIDDEN;
  return clamp(Math.round((change / LARGEST) * STEPS), -STEPS, STEPS);
}

/** Log changes; NaN where they are hidden. */
export function unpackTexture(texture) {
  return Float32Array.from(texture, (step) => (step === HIDDEN ? NaN : (step / STEPS) * LARGEST));
}

/** Points [[x, y], ...], enlarged by a scale. */
export function unpackLandmarks(landmarks, scale) {
  const factor = scale / PART;
  return Array.from({ length: landmarks.length / 2 }, (_, at) => [
    landmarks[2 * at] * factor, landmarks[2 * at + 1] * factor,
  ]);
}
