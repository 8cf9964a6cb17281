/** Linear colours of a face in a frame, averaged to the size of texels (`_frame_colours.py`). */

import { makeRaster } from "../raster.js";
import { roundHalfEven } from "../rounding.js";
import { measureTexel, sample } from "./texture_space.js";
import { USUAL_LINEAR } from "./tone_curve.js";

/** Linear RGB of the covered texels [texels * 3]; NaN outside of the frame. */
export function sampleFrame(frame, space, landmarks) {
  const points = space.place(landmarks);
  const step = Math.max(1, roundHalfEven(measureTexel(landmarks)));
  const part = findPart(points, step, frame);
  if (part.right - part.left < 2 * step || part.bottom - part.top < 2 * step) {
    return new Float32Array(3 * space.count).fill(NaN);
  }
  const small = shrink(frame, part, step);
  const moved = points.map((place, at) => (place - (at % 2 ? part.top : part.left)) / step);
  const colours = sample(small, moved);
  for (let at = 0; at < space.count; at++) {
    const [x, y] = [points[2 * at], points[2 * at + 1]];
    if (x < 0 || y < 0 || x > frame.width || y > frame.height) colours.fill(NaN, 3 * at, 3 * at + 3);
  }
  return colours;
}

/** The pixels around points, within the frame. */
function findPart(points, step, { width, height }) {
  const low = [Infinity, Infinity];
  const high = [-Infinity, -Infinity];
  points.forEach((place, at) => {
    low[at % 2] = Math.min(low[at % 2], place);
    high[at % 2] = Math.max(high[at % 2], place);
  });
  return {
    left: Math.max(0, Math.floor(low[0] - 2 * step)),
    top: Math.max(0, Math.floor(low[1] - 2 * step)),
    right: Math.min(width, Math.ceil(high[0] + 2 * step)),
    bottom: Math.min(height, Math.ceil(high[1] + 2 * step)),
  };
}

/** Average linear light over squares of pixels: all pixels count, which lowers the noise. */
function shrink({ data, width, channels }, { left, top, right, bottom }, step) {
  const [wide, tall] = [Math.floor((right - left) / step), Math.floor((bottom - top) / step)];
  const sums = new Float32Array(3 * wide * tall);
  for (let y = 0; y < tall * step; y++) {
    const line = 3 * wide * Math.floor(y / step);
    let at = ((top + y) * width + left) * channels;
    for (let x = 0; x < wide * step; x++, at += channels) {
      const to = line + 3 * Math.floor(x / step);
      sums[to] += USUAL_LINEAR[data[at]];
      sums[to + 1] += USUAL_LINEAR[data[at + 1]];
      sums[to + 2] += USUAL_LINEAR[data[at + 2]];
    }
  }
  return makeRaster(sums.map((sum) => sum / step ** 2), wide, tall, 3);
}
