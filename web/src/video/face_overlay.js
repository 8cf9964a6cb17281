/** The map laid over a face: each triangle of its mesh is filled with its part of the texture. */

import { TEXTURE } from "../python_data.js";
import { clamp } from "../rounding.js";
import { colourChange } from "./change_scale.js";

const { SIZE } = TEXTURE;

/**
 * Draw a texture of log changes over an image, transparent where it is hidden.
 * @param image ImageData, which is written to
 * @param space the texture space, {landmarks, triangles}
 * @param landmarks of the face in pixels of the image
 * @param texture Float32Array [size * size]; NaN is hidden
 */
export function drawOverlay(image, space, landmarks, texture) {
  const colours = colourTexture(texture);
  for (const corners of space.triangles) {
    const target = corners.map((corner) => landmarks[corner]);
    const source = corners.map((corner) => space.landmarks[corner]);
    fillTriangle(image, target, source, colours);
  }
}

/** Red, green, blue and alpha of each texel, the colours weighed by alpha. */
function colourTexture(texture) {
  const colours = new Float32Array(4 * texture.length);
  texture.forEach((change, at) => {
    if (!Number.isNaN(change)) colours.set([...colourChange(change), 255], 4 * at);
  });
  return colours;
}

function fillTriangle({ data, width, height }, target, source, colours) {
  const [[ax, ay], [bx, by], [cx, cy]] = target;
  const determinant = (by - cy) * (ax - cx) + (cx - bx) * (ay - cy);
  if (Math.abs(determinant) < 1e-9) return;
  const [left, right] = frame([ax, bx, cx], width);
  const [top, bottom] = frame([ay, by, cy], height);
  for (let row = top; row <= bottom; row++) {
    for (let column = left; column <= right; column++) {
      const [x, y] = [column + 0.5 - cx, row + 0.5 - cy];
      const first = ((by - cy) * x + (cx - bx) * y) / determinant;
      const second = ((cy - ay) * x + (ax - cx) * y) / determinant;
      const third = 1 - first - second;
      if (first < 0 || second < 0 || third < 0) continue;
      const place = (axis) =>
        first * source[0][axis] + second * source[1][axis] + third * source[2][axis] - 0.5;
      blend(colours, place(0), place(1), data, 4 * (row * width + column));
    }
  }
}

/** First and last pixel whose centre may lie between some places. */
function frame(places, length) {
  const first = Math.ceil(Math.min(...places) - 0.5);
  const last = Math.floor(Math.max(...places) - 0.5);
  return [Math.max(0, first), Math.min(length - 1, last)];
}

/** Write the colour between four texels. */
function blend(colours, x, y, data, to) {
  const [column, row] = [clamp(Math.floor(x), 0, SIZE - 2), clamp(Math.floor(y), 0, SIZE - 2)];
  const [right, down] = [clamp(x - column, 0, 1), clamp(y - row, 0, 1)];
  const first = 4 * (row * SIZE + column);
  const read = (channel) => {
    const at = first + channel;
    const above = colours[at] + right * (colours[at + 4] - colours[at]);
    const next = at + 4 * SIZE;
    const below = colours[next] + right * (colours[next + 4] - colours[next]);
    return above + down * (below - above);
  };
  const alpha = read(3);
  if (alpha <= 0) return;
  for (let channel = 0; channel < 3; channel++) data[to + channel] = (255 * read(channel)) / alpha;
  data[to + 3] = alpha;
}
