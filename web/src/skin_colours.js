/** Colours of one person's skin as a normal distribution (`_skin_colours.py`). */

import { filterLines, makeGaussian, mirrorAll } from "./filters.js";
import { SKIN } from "./python_data.js";
import { findMedian, invert } from "./statistics.js";

const LUMINANCE = [0.2126, 0.7152, 0.0722];

const WITHIN = 1; // log luminance around the median, of samples that are kept
const OUTLIER = 7; // squared distance of samples that are not
const HISTOGRAM_SIGMA = 0.8; // in bins

/** Log R/G, log B/G and log luminance of linear red, green and blue. */
export function computeFeatures(red, green, blue) {
  const log = Math.log(green);
  const luminance = LUMINANCE[0] * red + LUMINANCE[1] * green + LUMINANCE[2] * blue;
  return [Math.log(red) - log, Math.log(blue) - log, Math.log(luminance)];
}

/** Mean and covariance of samples of three features; outliers are removed three times. */
export function fitNormal(samples) {
  const sorted = samples.map((sample) => sample[2]).sort((a, b) => a - b);
  const middle = sorted[Math.floor((sorted.length - 1) / 2)];
  let kept = samples.filter((sample) => Math.abs(sample[2] - middle) < WITHIN);
  for (let round = 0; round < 3; round++) {
    const precision = invert(measureCovariance(kept));
    const centre = [0, 1, 2].map((axis) => findMedian(kept.map((sample) => sample[axis])));
    const near = samples.filter((sample) => measureSquare(sample, centre, precision) < OUTLIER);
    if (near.length) kept = near;
  }
  return { mean: average(kept), covariance: measureCovariance(kept) };
}

function average(samples) {
  return [0, 1, 2].map((axis) => samples.reduce((sum, one) => sum + one[axis], 0) / samples.length);
}

function measureCovariance(samples) {
  const mean = average(samples);
  return [0, 1, 2].map((i) => [0, 1, 2].map((j) => {
    let sum = 0;
    for (const one of samples) sum += (one[i] - mean[i]) * (one[j] - mean[j]);
    return sum / samples.length + SKIN.MIN_COVARIANCE[i][j];
  }));
}

function measureSquare(features, mean, precision) {
  const [a, b, c] = [features[0] - mean[0], features[1] - mean[1], features[2] - mean[2]];
  const [first, second, third] = precision;
  return a * (first[0] * a + first[1] * b + first[2] * c) +
    b * (second[0] * a + second[1] * b + second[2] * c) +
    c * (third[0] * a + third[1] * b + third[2] * c);
}

/** Log density of the skin's colours at pixels; bright ones may have a specular part. */
export function computeLogDensity(linear, features, mean, covariance) {
  const precision = invert(covariance);
  const norm = 0.5 * Math.log((2 * Math.PI) ** 3 * findDeterminant(covariance));
  return Float32Array.from(features, (feature, at) => {
    let least = measureSquare(feature, mean, precision);
    if (feature[2] > mean[2]) {
      const pixel = linear[at];
      const darkest = Math.min(...pixel);
      for (const share of SKIN.SPECULAR_SHARES) {
        const part = share * darkest;
        const diffuse = computeFeatures(pixel[0] - part, pixel[1] - part, pixel[2] - part);
        least = Math.min(least, measureSquare(diffuse, mean, precision));
      }
    }
    return -0.5 * least - norm;
  });
}

function findDeterminant([[a, b, c], [d, e, f], [g, h, i]]) {
  return a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g);
}

/** Log density of other things at all pixels, from those known to be no skin. */
export function estimateLogDensity(features, known) {
  const [, rows, columns] = SKIN.BINS;
  const places = features.map((feature) => {
    const find = (axis) => {
      const place = Math.trunc((feature[axis] - SKIN.LOWEST[axis]) / SKIN.BIN[axis]);
      return Math.min(Math.max(place, 0), SKIN.BINS[axis] - 1);
    };
    return (find(0) * rows + find(1)) * columns + find(2);
  });
  const counts = new Float32Array(SKIN.BINS.reduce((product, count) => product * count));
  let total = 0;
  places.forEach((place, at) => {
    if (!known[at]) return;
    counts[place] += 1;
    total += 1;
  });
  const seen = blurHistogram(counts.map((count) => count / Math.max(1, total)));
  const volume = SKIN.BIN.reduce((product, width) => product * width);
  const density = seen.map((value) =>
    Math.log(((1 - SKIN.UNSEEN) * value + SKIN.UNSEEN / seen.length) / volume));
  return places.map((place) => density[place]);
}

function blurHistogram(values) {
  const [count, rows, columns] = SKIN.BINS;
  const plane = rows * columns;
  const kernel = makeGaussian(HISTOGRAM_SIGMA);
  const deep = filterLines(values, count, plane, plane, 1, kernel, mirrorAll);
  for (let at = 0; at < deep.length; at += plane) {
    const part = deep.subarray(at, at + plane);
    part.set(filterLines(part, rows, columns, columns, 1, kernel, mirrorAll));
  }
  return filterLines(deep, columns, count * rows, 1, columns, kernel, mirrorAll);
}
