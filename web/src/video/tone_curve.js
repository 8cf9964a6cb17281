/** The usual tone curve of a camera, and what the doubt of it does (`_tone_doubt.py`). */

import { TONE_CURVE, TONE_DOUBT } from "../python_data.js";
import { clamp } from "../rounding.js";
import { toLinear } from "../srgb.js";

const { BEND_SD, STEP, LEAST, USUAL_BEND } = TONE_DOUBT;

/** Linear light of display sRGB in [0, 1] that a curve has bent. */
function undoTone(display, bend) {
  const steps = Array.from({ length: TONE_CURVE.STEPS }, (_, at) => at / (TONE_CURVE.STEPS - 1));
  const bent = steps.map((x) => clamp(x + bend * x * (1 - x) * (2 * x - 1), 0, 1));
  return display.map((value) => toLinear(interpolate(value, bent, steps)));
}

/** Interpolate between rising places, as `numpy.interp` does. */
export function interpolate(value, places, values) {
  const last = places.length - 1;
  if (!(value > places[0])) return values[0];
  if (value >= places[last]) return values[last];
  let [low, high] = [0, last];
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (places[middle] <= value) low = middle;
    else high = middle;
  }
  const share = (value - places[low]) / (places[high] - places[low]);
  return values[low] + share * (values[high] - values[low]);
}

const LEVELS = Array.from({ length: 256 }, (_, level) => level / 255);

/** Linear light of the 256 levels by the usual curve. */
export const USUAL_LINEAR = Float32Array.from(undoTone(LEVELS, USUAL_BEND));

/** What an error of the curve's bend does to ratios of colours where the light changes. */
export class ToneDoubt {
  constructor() {
    const log = (bend) => undoTone(LEVELS.slice(1), bend).map((one) => Math.log(Math.max(one, LEAST)));
    const [more, less] = [log(USUAL_BEND + STEP), log(USUAL_BEND - STEP)];
    this.levels = log(USUAL_BEND);
    this.answer = more.map((one, at) => (one - less[at]) / (2 * STEP));
  }

  /** Covariance of a region's log ratios, by its linear RGB in the baseline, and its log gain. */
  findCovariance(base, gain) {
    const moved = base.map((value) => {
      const level = Math.log(Math.max(value, LEAST));
      return this.find(level + gain) - this.find(level);
    });
    return moved.map((one) => moved.map((other) => BEND_SD ** 2 * one * other));
  }

  /** Derivative of a log level by the bend. */
  find(level) {
    return interpolate(level, this.levels, this.answer);
  }
}
