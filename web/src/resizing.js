/** Resizing as Pillow does it, to the last bit, so that the network sees what it sees in Python. */

import { makeBlank, makeRaster } from "./raster.js";

const PRECISION = 22; // bits of Pillow's weights of 8-bit pixels
const ONE = 2 ** PRECISION;
const HALF = ONE / 2;

const REDUCING_GAP = 3; // images are first averaged over squares if they shrink by more

/** Resize bilinearly; where the image shrinks, average over all pixels. */
export function resize(raster, width, height) {
  const across = Math.max(1, Math.trunc(raster.width / width / REDUCING_GAP));
  const down = Math.max(1, Math.trunc(raster.height / height / REDUCING_GAP));
  const small = across > 1 || down > 1 ? reduce(raster, across, down) : raster;
  return resample(small, width, height, raster.width / across, raster.height / down);
}

/** Average over rectangles of whole pixels. */
export function reduce(raster, across, down) {
  if (across === 1 && down === 1) return raster;
  const { width, height, channels, data } = raster;
  const small = makeBlank(raster, Math.ceil(width / across), Math.ceil(height / down));
  for (let row = 0; row < small.height; row++) {
    const rows = Math.min(down, height - row * down);
    for (let column = 0; column < small.width; column++) {
      const columns = Math.min(across, width - column * across);
      const divide = makeDivision(data, rows * columns);
      for (let channel = 0; channel < channels; channel++) {
        let sum = 0;
        for (let y = row * down; y < row * down + rows; y++) {
          let at = (y * width + column * across) * channels + channel;
          for (let x = 0; x < columns; x++, at += channels) sum += data[at];
        }
        small.data[(row * small.width + column) * channels + channel] = divide(sum);
      }
    }
  }
  return small;
}

/** Pillow divides by a multiplication, which rounds down a little more often. */
function makeDivision(data, count) {
  if (data instanceof Float32Array) return (sum) => sum / count;
  const multiplier = Math.trunc(Math.fround(2 ** 32 / (256 * count)));
  const half = count >> 1;
  return (sum) => Math.floor(((sum + half) * multiplier) / 2 ** 24);
}

function resample(raster, width, height, rightEnd, lowerEnd) {
  const isSame = (size, length, end) => size === length && end === length;
  const wide = isSame(width, raster.width, rightEnd)
    ? raster
    : resampleRows(raster, computeWeights(raster.width, rightEnd, width));
  return isSame(height, raster.height, lowerEnd)
    ? wide
    : resampleColumns(wide, computeWeights(raster.height, lowerEnd, height));
}

/** The pixels that each resized pixel is made of, and their weights. */
function computeWeights(length, end, size) {
  const scale = Math.fround(end) / size; // Pillow's box is in single precision
  const support = Math.max(1, scale);
  return Array.from({ length: size }, (_, index) => {
    const centre = (index + 0.5) * scale;
    const first = Math.max(0, Math.trunc(centre - support + 0.5));
    const last = Math.min(length, Math.trunc(centre + support + 0.5));
    const weights = new Float64Array(last - first);
    let total = 0;
    for (let at = 0; at < weights.length; at++) {
      weights[at] = Math.max(0, 1 - Math.abs((at + first - centre + 0.5) / support));
      total += weights[at];
    }
    return { first, weights: weights.map((weight) => weight / total) };
  });
}

function resampleRows(raster, places) {
  const { width, height, channels, data } = raster;
  const rounded = roundWeights(data, places);
  const wide = makeBlank(raster, places.length, height);
  const isFloat = data instanceof Float32Array;
  let to = 0;
  for (let row = 0; row < height; row++) {
    for (let column = 0; column < rounded.length; column++) {
      const weights = rounded[column].weights;
      const start = (row * width + rounded[column].first) * channels;
      for (let channel = 0; channel < channels; channel++) {
        let sum = 0;
        let at = start + channel;
        for (let index = 0; index < weights.length; index++, at += channels) {
          sum += data[at] * weights[index];
        }
        wide.data[to++] = isFloat ? sum : toByte(sum);
      }
    }
  }
  return wide;
}

function resampleColumns(raster, places) {
  const { width, channels, data } = raster;
  const rounded = roundWeights(data, places);
  const length = width * channels;
  const tall = makeBlank(raster, width, places.length);
  const isFloat = data instanceof Float32Array;
  const sums = new Float64Array(length);
  rounded.forEach(({ first, weights }, row) => {
    sums.fill(0);
    for (let index = 0; index < weights.length; index++) {
      const weight = weights[index];
      const start = (first + index) * length;
      for (let at = 0; at < length; at++) sums[at] += data[start + at] * weight;
    }
    const start = row * length;
    for (let at = 0; at < length; at++) tall.data[start + at] = isFloat ? sums[at] : toByte(sums[at]);
  });
  return tall;
}

/** 8-bit pixels are summed with integer weights, others in double precision. */
function roundWeights(data, places) {
  if (data instanceof Float32Array) return places;
  const whole = (weight) => Math.trunc(0.5 + weight * ONE);
  return places.map(({ first, weights }) => ({ first, weights: weights.map(whole) }));
}

function toByte(sum) {
  return Math.min(255, Math.max(0, Math.floor((sum + HALF) / ONE)));
}

/** A plane of floats resized bilinearly, of which some rows at a time are made, to save memory. */
export class ResizedPlane {
  constructor(plane, width, height, newWidth, newHeight) {
    const raster = makeRaster(plane, width, height);
    this.wide = resample(raster, newWidth, height, width, height);
    this.places = computeWeights(height, height, newHeight);
  }

  /** Rows from the first up to, without, the last. */
  readRows(first, last) {
    return resampleColumns(this.wide, this.places.slice(first, last)).data;
  }
}
