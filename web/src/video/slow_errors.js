/** Errors of the regions' colours that stay for seconds, by how patches differ (`_slow_errors.py`). */

import { REGIONS, SLOW_ERRORS, TEXTURE } from "../python_data.js";
import { add, makeIdentity, scale, square } from "./matrices.js";

const { PATCH, LEAST_FILLED, SMOOTH, SECONDS } = SLOW_ERRORS;

/** Covariance of slow errors; those of patches are taken as independent. */
export class SlowErrors {
  /** `regions` are the texels of each region, `places` those of all texels in the texture. */
  constructor(regions, places) {
    this.patches = regions.flatMap((mask, region) =>
      REGIONS.NAMES[region] === REGIONS.FACE ? [] : listPatches(mask, region, places),
    );
    this.counts = regions.map((mask) =>
      Math.max(mask.reduce((sum, value) => sum + value, 0) / PATCH ** 2, 0.5),
    );
    Object.assign(this, { whole: null, time: null });
  }

  /** The covariance of a region now. */
  findCovariance(region) {
    return scale(this.whole ?? makeIdentity(0), 1 / this.counts[region]);
  }

  /** Add log ratios of the texels of a frame to the baseline, where they are seen. */
  add(time, texels, seen) {
    if (!this.patches.length) return;
    const passed = this.time === null ? 0 : time - this.time;
    this.time = time;
    this.patches.forEach((patch) => smooth(patch, average(patch, texels, seen), passed));
    const found = this.comparePatches();
    if (!found) return;
    this.whole ??= found;
    const share = 1 - Math.exp(-passed / SECONDS);
    this.whole = add(scale(this.whole, 1 - share), scale(found, share));
  }

  /** Covariance of patches about the mean of their region; null with too few. */
  comparePatches() {
    let [sum, free] = [makeIdentity(0), 0];
    REGIONS.NAMES.forEach((_, region) => {
      const known = this.patches.filter((patch) => patch.region === region && patch.colour);
      if (known.length < 2) return;
      free += known.length - 1;
      const mean = [0, 1, 2].map((at) =>
        known.reduce((total, { colour }) => total + colour[at], 0) / known.length,
      );
      for (const { colour } of known) sum = add(sum, square(colour.map((one, at) => one - mean[at])));
    });
    return free ? scale(sum, 1 / free) : null;
  }
}

/** The patches of a region that it fills enough. */
function listPatches(mask, region, places) {
  const patches = new Map();
  places.forEach((place, at) => {
    if (!mask[at]) return;
    const [row, column] = [Math.floor(place / TEXTURE.SIZE), place % TEXTURE.SIZE];
    const number = Math.floor(row / PATCH) * TEXTURE.SIZE + Math.floor(column / PATCH);
    if (!patches.has(number)) patches.set(number, { region, texels: [], colour: null });
    patches.get(number).texels.push(at);
  });
  return [...patches.values()].filter(({ texels }) => texels.length >= LEAST_FILLED * PATCH ** 2);
}

/** Mean of a patch; null where less than a half of it is seen. */
function average({ texels }, ratios, seen) {
  const shown = texels.filter((at) => seen[at]);
  if (shown.length < texels.length / 2) return null;
  return [0, 1, 2].map((channel) =>
    shown.reduce((sum, at) => sum + ratios[3 * at + channel], 0) / shown.length,
  );
}

function smooth(patch, mean, passed) {
  if (!mean) return;
  const share = 1 - Math.exp(-passed / SMOOTH);
  patch.colour = patch.colour?.map((one, at) => one + share * (mean[at] - one)) ?? mean;
}
