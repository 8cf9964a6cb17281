/** What is read of one frame (`_readings.py`). */

import { REGIONS } from "../python_data.js";

/**
 * @typedef {object} Reading
 * @property {number} number of the frame, from 0
 * @property {number} time in seconds
 * @property {number} shot its number, from 1; a cut begins another one
 * @property {string} state read, lost (no face was found) or hidden (too little skin is seen)
 * @property {number[]} change log of hemoglobin over that of the baseline; NaN if not read
 * @property {number[]} changeSd its standard deviation
 * @property {number[]} noiseSd that where it is 0: by noise and gloss, without the doubt of its size
 * @property {number[]} hemoglobin volume fraction
 * @property {number[]} logSd standard deviation of its logarithm
 * @property {number[]} gain exposure and shading relative to the baseline
 * @property {Float32Array|null} texture log change over the face
 * @property {number[][]|null} landmarks of the face in the frame
 */

/** The reading of a frame of which nothing is read. */
export function makeBlank(number, time, shot, state) {
  const blank = () => REGIONS.NAMES.map(() => NaN);
  return {
    number, time, shot, state, change: blank(), changeSd: blank(), noiseSd: blank(),
    hemoglobin: blank(), logSd: blank(), gain: blank(), texture: null, landmarks: null,
  };
}
