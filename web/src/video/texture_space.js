/** The texture space of a face in a video: a mesh of its landmarks at rest (`_texture_space.py`). */

import { placeFace } from "../face_place.js";
import { TEXTURE } from "../python_data.js";
import { clamp } from "../rounding.js";
import { makeMatrix } from "../turned_square.js";
import { triangulate } from "./delaunay.js";
import { markRegions } from "./face_regions.js";

const { SIZE, MARGIN } = TEXTURE;

/** A square of texels, each at a fixed place in a triangle of landmarks. */
export class TextureSpace {
  /** The texture space of a face at rest by its landmarks in a picture. */
  static fromLandmarks(landmarks) {
    const square = placeFace(landmarks);
    const atRest = toTexels({ ...square, side: MARGIN * square.side }, landmarks);
    return new TextureSpace(atRest, triangulate(atRest));
  }

  constructor(landmarks, triangles) {
    Object.assign(this, { landmarks, triangles });
    const found = coverTexels(landmarks, triangles);
    this.places = found.map(({ place }) => place); // of the covered texels in the texture
    this.corners = Int32Array.from(found.flatMap(({ corners }) => corners));
    this.weights = Float32Array.from(found.flatMap(({ weights }) => weights));
    this.regions = markRegions(landmarks, SIZE).map((mask) =>
      Uint8Array.from(this.places, (place) => mask[place]),
    );
  }

  get count() {
    return this.places.length;
  }

  /** Columns and rows of the covered texels in a picture with these landmarks. */
  place(landmarks) {
    const { corners, weights, count } = this;
    const placed = new Float32Array(2 * count);
    for (let at = 0; at < corners.length; at++) {
      const [x, y] = landmarks[corners[at]];
      const texel = 2 * Math.floor(at / 3);
      placed[texel] += weights[at] * x;
      placed[texel + 1] += weights[at] * y;
    }
    return placed;
  }

  /** Lay values of the covered texels out as a texture. */
  fill(values, blank = NaN) {
    const texture = new Float32Array(SIZE * SIZE).fill(blank);
    this.places.forEach((place, at) => {
      texture[place] = values[at];
    });
    return texture;
  }
}

/** Side of a texel in pixels of a picture with these landmarks. */
export function measureTexel(landmarks) {
  return (MARGIN * placeFace(landmarks).side) / SIZE;
}

/** Sample an image bilinearly at columns and rows of pixels' corners: [points, channels]. */
export function sample({ data, width, height, channels }, points) {
  const count = points.length / 2;
  const sampled = new Float32Array(count * channels);
  for (let at = 0; at < count; at++) {
    const x = clamp(points[2 * at] - 0.5, 0, width - 1.001);
    const y = clamp(points[2 * at + 1] - 0.5, 0, height - 1.001);
    const [column, row] = [Math.trunc(x), Math.trunc(y)];
    const [right, down] = [x - column, y - row];
    const near = Math.min(column + 1, width - 1) - column;
    const upper = row * width + column;
    const lower = Math.min(row + 1, height - 1) * width + column;
    for (let channel = 0; channel < channels; channel++) {
      const read = (place) => data[place * channels + channel];
      const above = read(upper) * (1 - right) + read(upper + near) * right;
      const below = read(lower) * (1 - right) + read(lower + near) * right;
      sampled[at * channels + channel] = above * (1 - down) + below * down;
    }
  }
  return sampled;
}

/** Places in the texture of points of a picture. */
function toTexels(square, points) {
  const [a, b, c, d, e, f] = makeMatrix(square, SIZE);
  const determinant = a * e - b * d;
  return points.map(([x, y]) => [
    (e * (x - c) - b * (y - f)) / determinant,
    (a * (y - f) - d * (x - c)) / determinant,
  ]);
}

/** The covered texels, in their order: their triangle's corners and barycentric coordinates. */
function coverTexels(landmarks, triangles) {
  const found = new Map();
  for (const corners of triangles) {
    const points = corners.map((corner) => landmarks[corner]);
    for (const [place, weights] of listTexels(points)) {
      if (!found.has(place)) found.set(place, { place, corners, weights });
    }
  }
  return [...found.values()].sort((one, other) => one.place - other.place);
}

/** Places of the texels whose centres lie in a triangle, with their barycentric coordinates. */
function* listTexels(points) {
  const [[left, right], [top, bottom]] = [0, 1].map((axis) => {
    const ends = points.map((point) => point[axis]);
    return [
      Math.max(0, Math.ceil(Math.min(...ends) - 0.5)),
      Math.min(SIZE - 1, Math.floor(Math.max(...ends) - 0.5)),
    ];
  });
  for (let row = top; row <= bottom; row++) {
    for (let column = left; column <= right; column++) {
      const weights = weigh(points, column + 0.5, row + 0.5);
      if (weights.every((weight) => weight >= -1e-9)) yield [row * SIZE + column, weights];
    }
  }
}

function weigh([[ax, ay], [bx, by], [cx, cy]], x, y) {
  const determinant = (by - cy) * (ax - cx) + (cx - bx) * (ay - cy);
  const first = ((by - cy) * (x - cx) + (cx - bx) * (y - cy)) / determinant;
  const second = ((cy - ay) * (x - cx) + (ax - cx) * (y - cy)) / determinant;
  return [first, second, 1 - first - second];
}
