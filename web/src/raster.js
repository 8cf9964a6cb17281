/**
 * Pixels with `channels` interleaved values each.
 * @typedef {{data: Uint8Array|Uint8ClampedArray|Float32Array, width: number, height: number,
 *   channels: number}} Raster
 */

/** @returns {Raster} */
export function makeRaster(data, width, height, channels = 1) {
  return { data, width, height, channels };
}

/** A raster of the same kind of values, all of them 0. */
export function makeBlank(like, width, height, channels = like.channels) {
  return makeRaster(new like.data.constructor(width * height * channels), width, height, channels);
}

/** The part of a raster in a box {left, top, right, bottom}. */
export function cropRaster(raster, box) {
  const { width, channels } = raster;
  const cropped = makeBlank(raster, box.right - box.left, box.bottom - box.top);
  const length = cropped.width * channels;
  for (let row = 0; row < cropped.height; row++) {
    const start = ((box.top + row) * width + box.left) * channels;
    cropped.data.set(raster.data.subarray(start, start + length), row * length);
  }
  return cropped;
}

/** Red, green and blue of pixels with alpha. */
export function dropAlpha(raster) {
  if (raster.channels === 3) return raster;
  const pixels = raster.width * raster.height;
  const data = new Uint8Array(3 * pixels);
  for (let pixel = 0; pixel < pixels; pixel++) {
    for (let channel = 0; channel < 3; channel++) {
      data[3 * pixel + channel] = raster.data[4 * pixel + channel];
    }
  }
  return makeRaster(data, raster.width, raster.height, 3);
}

/** A raster continued by its mirror image: the last pixel is repeated first. */
export function padMirrored(raster, rows, columns) {
  const { width, height, channels } = raster;
  const padded = makeBlank(raster, width + columns[0] + columns[1], height + rows[0] + rows[1]);
  for (let y = 0; y < padded.height; y++) {
    const row = mirror(y - rows[0], height);
    for (let x = 0; x < padded.width; x++) {
      const from = (row * width + mirror(x - columns[0], width)) * channels;
      const to = (y * padded.width + x) * channels;
      for (let channel = 0; channel < channels; channel++) {
        padded.data[to + channel] = raster.data[from + channel];
      }
    }
  }
  return padded;
}

function mirror(index, length) {
  const place = ((index % (2 * length)) + 2 * length) % (2 * length);
  return place < length ? place : 2 * length - 1 - place;
}
