/** The smallest change that a single frame tells from none (`_least_change.py`). */

import { INTERVAL, LEAST_CHANGE, REGIONS, SENTENCES } from "../python_data.js";
import { capitalise, fill } from "../sentences.js";

/** Relative changes by the names of the regions; null where a region is hidden. */
export function findLeastChange(readings) {
  const least = REGIONS.NAMES.map((name, at) => {
    const known = readings.map(({ noiseSd }) => noiseSd[at]).filter(Number.isFinite);
    if (!known.length) return [name, null];
    const variance = known.reduce((sum, sd) => sum + sd ** 2, 0) / known.length;
    return [name, Number((Math.exp(INTERVAL.QUANTILE * Math.sqrt(variance)) - 1).toFixed(4))];
  });
  return Object.fromEntries(least);
}

/** Sentences on a face of which single frames tell little. */
export function noteLeastChange(least) {
  const face = least[REGIONS.FACE];
  if (face === null || face <= LEAST_CHANGE.MUCH) return [];
  const [percent, why] = [Math.round(100 * face), SENTENCES.whyUnclear];
  if (face <= LEAST_CHANGE.UNREADABLE) return [fill(SENTENCES.unclear, { percent, why })];
  const unreadable = SENTENCES.unreadable.replace("{value}{value}", capitalise(why));
  return [fill(unreadable, { percent })];
}
