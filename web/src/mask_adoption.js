/** The network's planes where the mask is larger than the network's (`_skin_mask.py`). */

import { filterGaussian } from "./filters.js";
import { ResizedPlane, resize } from "./resizing.js";
import { clamp } from "./rounding.js";
import { LINEAR } from "./srgb.js";

const NEARBY = 4; // standard deviation, in pixels of the network, of what averages skin nearby
const LEAST = 1e-3; // weight of what is no skin

const OFFSETS = ["offset_r", "offset_g", "offset_b"];

/**
 * Mask, specular and offsets of planes [height, width] with a mask {plane, width, height} of the same
 * rectangle, which `part` shows.
 */
export function adoptMask(planes, width, height, mask, part) {
  const resized = new ResizedPlane(mask.plane, mask.width, mask.height, width, height);
  const small = resized.readRows(0, height).map((value) => clamp(value, 0, 1));
  const coarse = planes.mask;
  const added = small.map((value, at) => clamp(value - coarse[at], 0, 1));
  const blur = (plane) => filterGaussian(plane, width, height, NEARBY);
  const total = blur(coarse).map((value) => value + LEAST);
  const average = (plane) =>
    blur(plane.map((value, at) => value * coarse[at])).map((value, at) => value / total[at]);
  const excess = findExcess(resize(part, width, height), planes.specular, average);
  const adopted = {
    mask: small,
    specular: planes.specular.map((value, at) => value + added[at] * excess[at]),
  };
  for (const name of OFFSETS) {
    const nearby = average(planes[name]);
    adopted[name] = planes[name].map((value, at) => value + added[at] * (nearby[at] - value));
  }
  return adopted;
}

/** By how much the photograph is brighter than the skin nearby, in all channels. */
function findExcess({ data, channels }, specular, average) {
  const brighter = [0, 1, 2].map((channel) => {
    const diffuse = specular.map((value, at) => LINEAR[data[at * channels + channel]] - value);
    const nearby = average(diffuse);
    return diffuse.map((value, at) => value - nearby[at]);
  });
  return brighter[0].map((value, at) => Math.max(0, Math.min(value, brighter[1][at], brighter[2][at])));
}
