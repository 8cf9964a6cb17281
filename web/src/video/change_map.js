/** The map of the change over a face's texture, smoothed. */

import { filterGaussian } from "../filters.js";
import { CHANGE_MAP, TEXTURE } from "../python_data.js";
import { add, dot, makeIdentity, solve, square } from "./matrices.js";

const { SIZE } = TEXTURE;
const { BLUR, LEAST_SEEN, NOISE_SD, GLOSS_SD, LIGHT_SD, STEP, LEAST_COLOUR } = CHANGE_MAP;

export class ChangeMap {
  /** Weigh log red, green and blue in the change of each covered texel. */
  constructor(space, rest, comparison, table) {
    Object.assign(this, { space, usable: comparison.usable });
    this.weights = Float32Array.from(
      [...rest.melanin.keys()].flatMap((at) => weighTexel(rest, comparison.base, table, at)),
    );
    this.isShown = space.fill(this.usable, 0);
  }

  /** Log change of each texel of the texture; NaN where it is not skin. */
  draw({ texels, seen }, gain) {
    const { usable, weights, space } = this;
    const values = new Float32Array(space.count);
    const chosen = new Float32Array(space.count);
    for (let at = 0; at < space.count; at++) {
      if (!seen[at] || !usable[at]) continue;
      chosen[at] = 1;
      for (let place = 3 * at; place < 3 * at + 3; place++) {
        values[at] += (texels[place] - gain) * weights[place];
      }
    }
    const [sum, share] = [values, chosen].map((layer) =>
      filterGaussian(space.fill(layer, 0), SIZE, SIZE, BLUR),
    );
    return sum.map((value, at) =>
      this.isShown[at] && share[at] >= LEAST_SEEN ? value / share[at] : NaN,
    );
  }
}

function weighTexel(rest, base, table, at) {
  const lit = [-1, 1].map((way) => {
    const bare = [0, 0, 0];
    table.read(rest.melanin[at], rest.hemoglobin[at] * Math.exp(way * STEP), bare);
    return bare.map((value) => Math.log(Math.max(value, LEAST_COLOUR) + rest.gloss[at]));
  });
  const slope = lit[1].map((high, channel) => (high - lit[0][channel]) / (2 * STEP));
  const colour = [...base.subarray(3 * at, 3 * at + 3)];
  const white = colour.map((value) => (GLOSS_SD * colour[1]) / Math.max(value, LEAST_COLOUR));
  const noise = makeIdentity(NOISE_SD ** 2);
  const weights = solve(add(noise, LIGHT_SD ** 2, square(white)), slope);
  const information = Math.max(dot(weights, slope), 1e-9);
  return weights.map((weight) => weight / information);
}
