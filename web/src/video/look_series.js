/** Melanin through a shot: looks of the network that are spread over it, and pooled (`_look_series.py`). */

import { LOOKS } from "../python_data.js";
import { findMedian } from "../statistics.js";

const { SPACING, MOST, LEAST, CUT, LEAST_SPREAD, ROUNDS } = LOOKS;

/** Keeps a bounded number of looks, however long the shot is. */
export class LookSeries {
  constructor() {
    Object.assign(this, { first: [], later: [], spacing: SPACING, due: Infinity });
  }

  /** Begin to spread looks from a time on, the end of the baseline. */
  start(time) {
    this.due = time + this.spacing;
  }

  isDue(time) {
    return time >= this.due;
  }

  /** Wait for the next look, whether this one could be read or not. */
  postpone(time) {
    this.due = time + this.spacing;
  }

  /** Add the melanin of a frame, of which the network takes a share of the face for skin. */
  add(time, melanin, share) {
    const look = { time, share, logs: melanin.map((one) => Math.log(Math.max(one, LEAST))) };
    if (this.due === Infinity) {
      this.first.push(look);
      return;
    }
    this.later.push(look);
    if (this.later.length <= MOST) return;
    this.later = this.later.filter((_, at) => at % 2 === 0);
    this.spacing *= 2;
  }

  /** Fractions of the texels, and times, means of the face and weights of the looks. */
  pool(face) {
    const looks = [...this.first, ...this.later];
    const times = looks.map(({ time }) => time);
    const spans = differentiate(times);
    const average = (logs, change) => face.reduce((sum, at) => sum + change(logs[at]), 0) / face.length;
    const weights = lowerOutliers(
      looks.map(({ logs }) => average(logs, (one) => one)),
      looks.map(({ share }, at) => Math.max(spans[at], 1e-3) * share),
    );
    const texels = looks[0].logs.map((_, texel) =>
      Math.exp(looks.reduce((sum, { logs }, at) => sum + weights[at] * logs[texel], 0)),
    );
    return { texels, times, weights, means: looks.map(({ logs }) => average(logs, Math.exp)) };
  }
}

/** Half of the time between the neighbours of each time, as `numpy.gradient` has it. */
function differentiate(times) {
  const last = times.length - 1;
  if (!last) return [1];
  return times.map((time, at) => {
    if (at === 0) return times[1] - time;
    if (at === last) return time - times[last - 1];
    return (times[at + 1] - times[at - 1]) / 2;
  });
}

/** Weights with sum 1, lower for levels far from the rest (Huber 1964). */
function lowerOutliers(levels, given) {
  const normalise = (values) => {
    const sum = values.reduce((total, value) => total + value, 0);
    return values.map((value) => value / sum);
  };
  const weights = given.map((weight) => Math.max(weight, 1e-9));
  let robust = normalise(weights);
  for (let round = 0; round < ROUNDS; round++) {
    const middle = levels.reduce((sum, level, at) => sum + robust[at] * level, 0);
    const deviations = levels.map((level) => Math.abs(level - middle));
    const spread = Math.max(1.4826 * findMedian(deviations), LEAST_SPREAD);
    robust = normalise(
      weights.map((weight, at) => weight * Math.min(1, (CUT * spread) / Math.max(deviations[at], 1e-9))),
    );
  }
  return robust;
}
