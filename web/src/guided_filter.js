/** The fast guided filter (He and Sun 2015): a mask that follows the edges of a photograph. */

import { filterMean } from "./filters.js";
import { ResizedPlane, resize } from "./resizing.js";
import { LINEAR } from "./srgb.js";

const BLACK = 0.02; // linear sRGB that is added before the logarithm

const LOGS = LINEAR.map((value) => Math.log(value + BLACK));
const GUIDE = LOGS.map((value) => (value - LOGS[0]) / (LOGS[255] - LOGS[0]));

const PAIRS = [[0, 0], [0, 1], [0, 2], [1, 1], [1, 2], [2, 2]];

/** A plane in [0, 1], enlarged to the size of a photograph, whose edges it follows. */
export class GuidedPlane {
  constructor(photo, plane, width, height, radius, epsilon) {
    const small = resize(photo, width, height);
    this.planes = fitGuide(small, plane, radius, epsilon).map(
      (each) => new ResizedPlane(each, width, height, photo.width, photo.height),
    );
  }

  /** Rows from the first up to, without, the last; the photograph's must not be changed yet. */
  readRows(photo, first, last) {
    const [red, green, blue, sum] = this.planes.map((plane) => plane.readRows(first, last));
    const { data, channels } = photo;
    let pixel = first * photo.width * channels;
    for (let at = 0; at < sum.length; at++, pixel += channels) {
      const value =
        sum[at] +
        red[at] * GUIDE[data[pixel]] +
        green[at] * GUIDE[data[pixel + 1]] +
        blue[at] * GUIDE[data[pixel + 2]];
      sum[at] = Math.min(1, Math.max(0, value));
    }
    return sum;
  }
}

/** A plane filtered by a photograph of the same size, not limited to [0, 1]. */
export function filterGuided(photo, plane, radius, epsilon) {
  const [red, green, blue, sum] = fitGuide(photo, plane, radius, epsilon);
  const { data, channels } = photo;
  return sum.map((value, at) =>
    value +
    red[at] * GUIDE[data[at * channels]] +
    green[at] * GUIDE[data[at * channels + 1]] +
    blue[at] * GUIDE[data[at * channels + 2]]);
}

/** Slopes of red, green and blue, and the intercept, of linear functions of the guide's colours. */
function fitGuide(photo, plane, radius, epsilon) {
  const { width, height, channels, data } = photo;
  const average = (values) => filterMean(values, width, height, radius);
  const colours = [0, 1, 2].map((channel) =>
    Float32Array.from(plane, (_, at) => GUIDE[data[at * channels + channel]]),
  );
  const means = colours.map(average);
  const mean = average(plane);
  const products = PAIRS.map(([i, j]) => average(colours[i].map((one, at) => one * colours[j][at])));
  const crossed = colours.map((colour) => average(colour.map((one, at) => one * plane[at])));
  const fitted = [0, 1, 2, 3].map(() => new Float32Array(plane.length));
  for (let at = 0; at < plane.length; at++) {
    const slopes = solve(
      PAIRS.map(([i, j], pair) =>
        products[pair][at] - means[i][at] * means[j][at] + (i === j ? epsilon : 0)),
      crossed.map((each, channel) => each[at] - means[channel][at] * mean[at]),
    );
    let intercept = mean[at];
    slopes.forEach((slope, channel) => {
      fitted[channel][at] = slope;
      intercept -= slope * means[channel][at];
    });
    fitted[3][at] = intercept;
  }
  return fitted.map(average);
}

/** Solve a symmetric system of three equations by its cofactors. */
function solve([rr, rg, rb, gg, gb, bb], [r, g, b]) {
  const [crr, crg, crb] = [gg * bb - gb * gb, gb * rb - rg * bb, rg * gb - gg * rb];
  const [cgg, cgb, cbb] = [rr * bb - rb * rb, rb * rg - rr * gb, rr * gg - rg * rg];
  const scale = 1 / (rr * crr + rg * crg + rb * crb);
  return [
    scale * (crr * r + crg * g + crb * b),
    scale * (crg * r + cgg * g + cgb * b),
    scale * (crb * r + cgb * g + cbb * b),
  ];
}
