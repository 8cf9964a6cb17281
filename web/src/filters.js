/** Filters of planes [height, width] of floats. */

/** Gaussian filter that mirrors the plane at its sides, as scipy.ndimage does. */
export function filterGaussian(plane, width, height, sigma) {
  return filterBoth(plane, width, height, makeGaussian(sigma), mirrorAll);
}

export function makeGaussian(sigma) {
  const radius = Math.floor(4 * sigma + 0.5);
  const weights = Array.from({ length: 2 * radius + 1 }, (_, at) =>
    Math.exp(-0.5 * ((at - radius) / sigma) ** 2),
  );
  const total = weights.reduce((sum, weight) => sum + weight, 0);
  return weights.map((weight) => weight / total);
}

/** Mean over squares of 2 radius + 1 pixels; the plane is mirrored about its last pixels. */
export function filterMean(plane, width, height, radius) {
  const length = 2 * radius + 1;
  return filterBoth(plane, width, height, Array(length).fill(1 / length), mirrorInner);
}

function filterBoth(plane, width, height, kernel, mirror) {
  const wide = filterLines(plane, width, height, 1, width, kernel, mirror);
  return filterLines(wide, height, width, width, 1, kernel, mirror);
}

/** Filter `lines` lines of `length` values that lie `step` apart, by a symmetric kernel. */
export function filterLines(plane, length, lines, step, stride, kernel, mirror) {
  const radius = (kernel.length - 1) / 2;
  const filtered = new Float32Array(plane.length);
  const padded = new Float64Array(length + 2 * radius);
  const places = Int32Array.from(padded, (_, at) => mirror(at - radius, length) * step);
  for (let line = 0; line < lines; line++) {
    for (let at = 0; at < padded.length; at++) padded[at] = plane[line * stride + places[at]];
    for (let at = 0; at < length; at++) {
      let sum = kernel[radius] * padded[at + radius];
      for (let tap = 0, end = kernel.length - 1; tap < radius; tap++, end--) {
        sum += kernel[tap] * (padded[at + tap] + padded[at + end]);
      }
      filtered[line * stride + at * step] = sum;
    }
  }
  return filtered;
}

export function mirrorAll(at, length) {
  const place = ((at % (2 * length)) + 2 * length) % (2 * length);
  return place < length ? place : 2 * length - 1 - place;
}

function mirrorInner(at, length) {
  if (length === 1) return 0;
  const period = 2 * length - 2;
  const place = ((at % period) + period) % period;
  return place < length ? place : period - place;
}
