/** A change of skin as a change of colour, applied to a photograph of any size. */

import { filterGaussian } from "./filters.js";
import { clamp } from "./rounding.js";
import { ResizedPlane } from "./resizing.js";
import { LINEAR, toLevel, toLinearFast } from "./srgb.js";

const RAMP_START = 0.1; // masks between which changes set in
const RAMP_END = 0.9;
const RATIO_OFFSET = 1e-3; // linear sRGB added to both colours of a ratio
const SHADING_SIGMA = 1.5; // of the Gaussian, in pixels of the network, that averages shading
const MOST_CONTRAST = 3; // largest ratio of shading to its mean, and of the mean to it
const LEAST_CHANGE = 1e-6; // in linear sRGB; pixels that change by less keep their exact values
const STRIP = 64; // rows that are edited at once, which bounds the memory
const SHINE = 0.1; // specular reflection of which the colour is taken

/**
 * Factors of an edit: melanin, hemoglobin and shine are multiplied; shading is the exponent of its
 * ratio to the mean, so that 0 makes the light even and 2 doubles its contrast.
 */
export const UNCHANGED = { melanin: 1, hemoglobin: 1, shading: 1, shine: 1 };

export function isUnchanged(factors) {
  return Object.entries(UNCHANGED).every(([name, value]) => factors[name] === value);
}

/** Edits one reading: planes [height, width], capture, and weights that fade out at sides. */
export class Editor {
  constructor(networks, { planes, capture, width, height, fade }) {
    Object.assign(this, { networks, planes, capture, width, height, fade });
  }

  /** The change of colours of an edit, as planes of the reading's size. */
  async computeChange(factors) {
    this.before ??= await this.decodeBare(UNCHANGED);
    this.shine ??= await this.findShine();
    const after = await this.decodeBare(factors);
    return {
      colours: this.compareColours(this.before, after),
      shading: this.scaleShading(factors.shading),
      shine: this.shine.map((value) => value * (factors.shine - 1)),
    };
  }

  /** Linear colours of the skin alone, evenly lit, with its pigments multiplied. */
  async decodeBare(factors, specular = 0) {
    const { width, height, planes } = this;
    const even = (value) => new Float32Array(width * height).fill(value);
    const scale = (name) => planes[name].map((value) => clamp(value * factors[name], 0, 1));
    const bare = {
      melanin: scale("melanin"),
      hemoglobin: scale("hemoglobin"),
      shading: even(1),
      specular: even(specular),
    };
    const image = await this.networks.decode(bare, this.capture, width, height);
    return image.map(toLinearFast);
  }

  /** The colour of a specular reflection of 1, which is that of the light in the photograph. */
  async findShine() {
    const shiny = await this.decodeBare(UNCHANGED, SHINE);
    const sums = [0, 0, 0];
    shiny.forEach((value, at) => {
      sums[at % 3] += value - this.before[at];
    });
    return sums.map((sum) => (3 * sum) / (SHINE * shiny.length));
  }

  /** Losses and gains of red, green and blue, smoothed over the skin. */
  compareColours(before, after) {
    const { width, height, planes } = this;
    const changes = Array.from({ length: 6 }, () => new Float32Array(width * height));
    for (let at = 0; at < width * height; at++) {
      const sum = before[3 * at] + before[3 * at + 1] + before[3 * at + 2] + RATIO_OFFSET;
      for (let channel = 0; channel < 3; channel++) {
        const [old, changed] = [before[3 * at + channel], after[3 * at + channel]];
        const ratio = (changed + RATIO_OFFSET) / (old + RATIO_OFFSET);
        changes[channel][at] = Math.min(ratio, 1) - 1;
        changes[3 + channel][at] = Math.max(changed - old, 0) / sum;
      }
    }
    const weight = planes.mask.map((value) => value + 1e-4);
    const smooth = (plane) => filterGaussian(plane, width, height, 1);
    const share = smooth(weight);
    return changes.map((change) =>
      smooth(change.map((value, at) => value * weight[at])).map((value, at) => value / share[at]),
    );
  }

  /** What shading is multiplied by; at the edge of the skin it is that of the skin nearby. */
  scaleShading(exponent) {
    const { width, height } = this;
    const { shading, mask } = this.planes;
    const weight = mask.map((value) => value ** 2 + 1e-6);
    const smooth = (plane) => filterGaussian(plane, width, height, SHADING_SIGMA);
    const share = smooth(weight);
    const near = smooth(shading.map((value, at) => value * weight[at]));
    const sum = (plane) => plane.reduce((total, value) => total + value, 0);
    const mean = Math.max(sum(near) / sum(share), 1e-3);
    return near.map((value, at) => {
      const ratio = clamp(value / share[at] / mean, 1 / MOST_CONTRAST, MOST_CONTRAST);
      return ratio ** (exponent - 1);
    });
  }

  /**
   * Change the pixels of a raster that shows the reading's rectangle.
   * @param {Map} [known] weights and specular of this raster and mask, kept from one edit to the next
   */
  apply(raster, mask, { colours, shading, shine }, known = null) {
    const enlarge = (plane) =>
      new ResizedPlane(plane, this.width, this.height, raster.width, raster.height);
    const planes = [...colours, shading].map(enlarge);
    const [specular, fade] = [this.planes.specular, this.fade].map(enlarge);
    for (let first = 0; first < raster.height; first += STRIP) {
      const last = Math.min(first + STRIP, raster.height);
      const fixed = known?.get(first) ?? {
        weights: weigh(mask.readRows(raster, first, last), fade.readRows(first, last)),
        specular: specular.readRows(first, last),
      };
      known?.set(first, fixed);
      const rows = planes.map((plane) => plane.readRows(first, last));
      changePixels(raster, first * raster.width, rows, fixed, shine);
    }
  }
}

/** Weights that rise from 0 to 1 where the mask, times the fade, does from .1 to .9. */
function weigh(mask, fade) {
  return mask.map((value, at) =>
    clamp((value * fade[at] - RAMP_START) / (RAMP_END - RAMP_START), 0, 1),
  );
}

/** Change pixels from a place on; the rows are six changes of colour, and of shading. */
function changePixels({ data, channels }, place, rows, { weights, specular }, shine) {
  const ratio = rows[6];
  for (let at = 0; at < weights.length; at++) {
    const weight = weights[at];
    if (weight === 0) continue;
    const start = (place + at) * channels;
    const red = Math.max(0, LINEAR[data[start]] - specular[at]);
    const green = Math.max(0, LINEAR[data[start + 1]] - specular[at]);
    const blue = Math.max(0, LINEAR[data[start + 2]] - specular[at]);
    const sum = red + green + blue;
    for (let channel = 0; channel < 3; channel++) {
      const diffuse = channel === 0 ? red : channel === 1 ? green : blue;
      const added = rows[channel][at] * diffuse + rows[3 + channel][at] * sum;
      const lit = (diffuse + added) * ratio[at] - diffuse;
      const change = weight * (lit + shine[channel] * specular[at]);
      if (change > -LEAST_CHANGE && change < LEAST_CHANGE) continue;
      data[start + channel] = toLevel(LINEAR[data[start + channel]] + change);
    }
  }
}
