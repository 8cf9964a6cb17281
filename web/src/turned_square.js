/** Squares of a photograph that may be turned: cut, and the way back for points. */

import { clamp, roundHalfEven } from "./rounding.js";
import { cropRaster, makeRaster } from "./raster.js";
import { reduce } from "./resizing.js";

const ENOUGH_DETAIL = 1.4; // pixels of the photograph in one of the cut, to which it is shrunk first

const GREY = 128; // of what is outside the photograph

/** @typedef {{x: number, y: number, side: number, tilt: number}} TurnedSquare tilt in radians */

/** The affine matrix [a, b, c, d, e, f] from a cut of `size` pixels to the photograph. */
export function makeMatrix(square, size) {
  const scale = square.side / size;
  const cos = scale * Math.cos(square.tilt);
  const sin = scale * Math.sin(square.tilt);
  const half = size / 2;
  const c = square.x - (cos * half - sin * half);
  const f = square.y - (sin * half + cos * half);
  return [cos, -sin, c, sin, cos, f];
}

/** Place a point of the cut square of `size` pixels in the photograph. */
export function placePoint(square, size, [x, y]) {
  const [a, b, c, d, e, f] = makeMatrix(square, size);
  return [a * x + b * y + c, d * x + e * y + f];
}

export function listCorners(square) {
  return [[0, 0], [1, 0], [1, 1], [0, 1]].map((point) => placePoint(square, 1, point));
}

/** Cut the square from a photograph, upright: red, green and blue of size x size pixels. */
export function cutSquare(square, photo, size) {
  const cut = makeRaster(new Uint8Array(3 * size * size).fill(GREY), size, size, 3);
  const bounds = findBounds(square, photo);
  if (bounds.right <= bounds.left || bounds.bottom <= bounds.top) return cut;
  const shrink = Math.max(1, roundHalfEven(square.side / size / ENOUGH_DETAIL));
  const part = reduce(cropRaster(photo, bounds), shrink, shrink);
  const matrix = makeMatrix(square, size);
  matrix[2] -= bounds.left;
  matrix[5] -= bounds.top;
  interpolate(part, matrix.map((value) => value / shrink), cut);
  return cut;
}

function findBounds(square, photo) {
  const turn = Math.abs(Math.cos(square.tilt)) + Math.abs(Math.sin(square.tilt));
  const half = (square.side / 2) * turn;
  return {
    left: Math.max(0, Math.floor(square.x - half)),
    top: Math.max(0, Math.floor(square.y - half)),
    right: Math.min(photo.width, Math.ceil(square.x + half)),
    bottom: Math.min(photo.height, Math.ceil(square.y + half)),
  };
}

/** Bilinear interpolation as in Pillow: values are cut off, not rounded. */
function interpolate(part, [a, b, c, d, e, f], cut) {
  const { width, height, channels, data } = part;
  let to = 0;
  for (let row = 0; row < cut.height; row++) {
    for (let column = 0; column < cut.width; column++, to += 3) {
      const x = a * (column + 0.5) + b * (row + 0.5) + c;
      const y = d * (column + 0.5) + e * (row + 0.5) + f;
      if (x < 0 || x >= width || y < 0 || y >= height) continue;
      const left = Math.floor(x - 0.5);
      const top = Math.floor(y - 0.5);
      const dx = x - 0.5 - left;
      const dy = y - 0.5 - top;
      const first = clamp(top, 0, height - 1) * width;
      const second = top + 1 < height ? (top + 1) * width : first;
      const near = clamp(left, 0, width - 1);
      const far = clamp(left + 1, 0, width - 1);
      for (let channel = 0; channel < 3; channel++) {
        const upperNear = data[(first + near) * channels + channel];
        const lowerNear = data[(second + near) * channels + channel];
        const upper = upperNear + (data[(first + far) * channels + channel] - upperNear) * dx;
        const lower = lowerNear + (data[(second + far) * channels + channel] - lowerNear) * dx;
        cut.data[to + channel] = upper + (lower - upper) * dy;
      }
    }
  }
}

/** Intersection over union of two squares, as if they were upright. */
export function measureOverlap(a, b) {
  const half = (a.side + b.side) / 2;
  const share = (p, q) => Math.max(0, Math.min(half - Math.abs(p - q), a.side, b.side));
  const common = share(a.x, b.x) * share(a.y, b.y);
  return common / (a.side ** 2 + b.side ** 2 - common);
}
