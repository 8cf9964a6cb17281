/** Whether a clip shows nothing but one still image (`_still_image.py`). */

import { STILL } from "../python_data.js";

const { BLOCK, MOST_BLOCK, MOST_MEAN, LEAST_SECONDS } = STILL;

/** Compares frames with the first one, until one differs. */
export class StillImage {
  constructor() {
    Object.assign(this, { first: null, last: 0, isSame: true, isAlike: true });
  }

  /** Whether no frame differs by more than compression makes of a still image. */
  get isStill() {
    return this.isSame || (this.isAlike && this.last >= LEAST_SECONDS);
  }

  add(frame, time) {
    this.last = time;
    if (!this.first) this.first = frame;
    else if (this.isAlike) this.compare(frame);
    if (!this.isAlike) this.first = { width: 0, height: 0 }; // its pixels are needed no more
  }

  compare(frame) {
    this.isSame &&= isSame(this.first.data, frame.data);
    this.isAlike = this.isSame || isAlike(this.first, frame);
  }
}

function isSame(before, now) {
  return before.length === now.length && before.every((value, at) => value === now[at]);
}

/** Whether blocks of pixels, and pixels on average, differ little. */
function isAlike(before, { data, width, height, channels }) {
  if (before.data.length !== data.length) return false;
  const [across, down] = [Math.floor(width / BLOCK), Math.floor(height / BLOCK)];
  const sums = new Float64Array(3 * across * down);
  let total = 0;
  for (let y = 0; y < height; y++) {
    for (let x = 0; x < width; x++) {
      const block = y < down * BLOCK && x < across * BLOCK
        ? 3 * (Math.floor(y / BLOCK) * across + Math.floor(x / BLOCK))
        : null;
      for (let channel = 0; channel < 3; channel++) {
        const at = (y * width + x) * channels + channel;
        const change = data[at] - before.data[at];
        total += Math.abs(change);
        if (block !== null) sums[block + channel] += change;
      }
    }
  }
  const largest = sums.reduce((most, sum) => Math.max(most, Math.abs(sum)), 0) / BLOCK ** 2;
  return largest <= MOST_BLOCK && total / (3 * width * height) <= MOST_MEAN;
}
