/** Noise of a region's colours, from the differences between successive frames (`_noise.py`). */

import { NOISE } from "../python_data.js";
import { add, dot, makeIdentity, scale, solve, square } from "./matrices.js";

const { SECONDS, MOST, FLOOR } = NOISE;

/** Covariance of the noise of log RGB; half of the mean square of differences between neighbours. */
export class RunningNoise {
  constructor() {
    Object.assign(this, { sum: makeIdentity(0), weight: 0, before: [NaN, NaN, NaN] });
    this.time = -Infinity;
  }

  get covariance() {
    return add(scale(this.sum, 1 / Math.max(this.weight, 1e-9)), makeIdentity(FLOOR ** 2));
  }

  /** Add the log ratios of a frame; NaN if the region is not seen. */
  add(time, ratios) {
    const difference = ratios.map((ratio, at) => (ratio - this.before[at]) / Math.SQRT2);
    if (difference.every(Number.isFinite)) {
      const fade = Number.isFinite(this.time) ? Math.exp(-Math.max(time - this.time, 0) / SECONDS) : 0;
      const cut = this.limit(difference);
      this.sum = add(scale(this.sum, fade), square(cut));
      this.weight = fade * this.weight + 1;
    }
    Object.assign(this, { before: ratios, time });
  }

  limit(difference) {
    const distance = dot(difference, solve(this.covariance, difference));
    if (this.weight <= 5) return difference;
    const factor = Math.sqrt(Math.min(1, MOST / Math.max(distance, 1e-12)));
    return difference.map((one) => one * factor);
  }
}
