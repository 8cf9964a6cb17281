/** Colours of frames compared with those of a baseline. */

import { BASELINE, FRAME_COLOURS } from "../python_data.js";
import { findMedian } from "../statistics.js";

const { BRIGHTEST, DARKEST } = FRAME_COLOURS;

/** Mean colours of texels in a baseline, and which texels can be used. */
export class FrameComparison {
  /**
   * @param frames colours of the covered texels, [texels * 3] each; NaN for what is not seen
   * @param skin which texels are skin
   * @param regions texels of each region
   */
  constructor(frames, skin, regions) {
    this.base = averageFrames(frames);
    this.usable = skin.map((isSkin, at) => {
      const [red, green, blue] = this.base.subarray(3 * at, 3 * at + 3);
      const isLit = Math.max(red, green, blue) < BRIGHTEST && Math.min(red, green, blue) > DARKEST;
      return Number(isSkin && isLit);
    });
    this.regions = regions.map((mask) => mask.map((value, at) => value & this.usable[at]));
    this.lists = this.regions.map((mask) => [...mask.keys()].filter((at) => mask[at]));
    this.levels = this.lists.map((list) => average(this.base, list));
  }

  /** Log ratios of the regions to the baseline, NaN if hidden; of texels; and which are seen. */
  compare(colours) {
    const { base, usable } = this;
    const texels = colours.map((value, at) => Math.log(value / base[at]));
    const seen = usable.map((_, at) => {
      const [red, green, blue] = colours.subarray(3 * at, 3 * at + 3);
      return Number(Math.max(red, green, blue) < BRIGHTEST && Math.min(red, green, blue) > 0);
    });
    hideOthers(texels, seen, usable);
    return { ratios: this.lists.map((list) => this.compareRegion(colours, list, seen)), texels, seen };
  }

  compareRegion(colours, list, seen) {
    const shown = list.filter((at) => seen[at]);
    const isEnough =
      shown.length >= BASELINE.LEAST_TEXELS && shown.length >= BASELINE.LEAST_SHARE * list.length;
    if (!isEnough) return [NaN, NaN, NaN];
    const [lit, base] = [average(colours, shown), average(this.base, shown)];
    return lit.map((value, at) => Math.log(value) - Math.log(base[at]));
  }
}

/** Mean of frames, each brought to the same brightness. */
function averageFrames(frames) {
  const levels = frames.map(measureLevel);
  const middle = findMedian(levels);
  const sums = new Float64Array(frames[0].length);
  const counts = new Float64Array(frames[0].length);
  frames.forEach((frame, number) => {
    const factor = middle / levels[number];
    frame.forEach((value, at) => {
      if (Number.isNaN(value)) return;
      sums[at] += value * factor;
      counts[at] += 1;
    });
  });
  return Float32Array.from(sums, (sum, at) => sum / counts[at]);
}

/** The median of the texels' brightness. */
function measureLevel(frame) {
  const levels = [];
  for (let at = 0; at < frame.length; at += 3) {
    const level = (frame[at] + frame[at + 1] + frame[at + 2]) / 3;
    if (!Number.isNaN(level)) levels.push(level);
  }
  return findMedian(levels);
}

function average(colours, list) {
  const sums = [0, 0, 0];
  for (const at of list) {
    for (let channel = 0; channel < 3; channel++) sums[channel] += colours[3 * at + channel];
  }
  return sums.map((sum) => sum / Math.max(list.length, 1));
}

/** Leave out texels whose chroma differs from that of the others. */
function hideOthers(texels, seen, usable) {
  const both = [...seen.keys()].filter((at) => seen[at] && usable[at]);
  const middle = [0, 1, 2].map((channel) =>
    both.length ? findMedian(both.map((at) => texels[3 * at + channel])) : 0,
  );
  seen.forEach((_, at) => {
    const [red, green, blue] = middle.map((value, channel) => texels[3 * at + channel] - value);
    const chroma = Math.max(Math.abs(red - green), Math.abs(blue - green));
    if (!(chroma < BASELINE.MOST_CHROMA)) seen[at] = 0;
  });
}
