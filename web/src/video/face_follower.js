/** A face followed from frame to frame by its landmarks (`_face_follower.py`). */

import { findFaces } from "../face_finder.js";
import { findLandmarks } from "../face_mesh.js";
import { placeFace } from "../face_place.js";
import { FOLLOWER } from "../python_data.js";
import { resize } from "../resizing.js";
import { makeRaster } from "../raster.js";
import { invert } from "../statistics.js";

const { LEAST_ODDS, SEARCH, MARGIN, SMOOTH, CUT, THUMBNAIL } = FOLLOWER;

/** A frame shows several faces, of which none was chosen. */
export class SeveralFaces extends Error {
  constructor(faces) {
    super(`The video shows ${faces.length} faces. Which one is meant? Choose it in the picture.`);
    this.faces = faces;
  }
}

/** Finds a face, and follows it; `choice` is its number from left to right, from 0, or null. */
export class FaceFollower {
  constructor(networks, choice) {
    Object.assign(this, { networks, choice, landmarks: null, rest: null, bent: null });
    Object.assign(this, { thumbnail: null, place: null, time: -Infinity, searched: -Infinity });
  }

  /** Find the face in the next frame: {landmarks or null, isCut, bend}. */
  async follow(frame, time) {
    const isCut = this.noticeCut(frame);
    if (isCut) Object.assign(this, { landmarks: null, rest: null, searched: -Infinity });
    if (this.landmarks) await this.move(frame);
    if (!this.landmarks && time - this.searched >= SEARCH) {
      Object.assign(this, { searched: time, bent: null });
      this.landmarks = await this.search(frame);
    }
    if (!this.landmarks) return { landmarks: null, isCut, bend: 0 };
    return { ...this.smooth(this.landmarks, time), isCut };
  }

  async move(frame) {
    const square = placeFace(this.landmarks);
    const near = { ...square, side: MARGIN * square.side };
    const { landmarks, odds } = await findLandmarks(this.networks, frame, near);
    this.landmarks = odds > LEAST_ODDS ? landmarks : null;
    if (this.landmarks) this.place = placeFace(landmarks);
  }

  async search(frame) {
    const faces = await findFaces(this.networks, frame);
    if (!faces.length) return null;
    const face = this.place ? findNearest(faces, this.place) : this.choose(faces);
    this.place = placeFace(face.landmarks);
    return face.landmarks;
  }

  choose(faces) {
    if (this.choice === null && faces.length > 1) throw new SeveralFaces(faces);
    return faces[Math.min(this.choice ?? 0, faces.length - 1)];
  }

  /** Smooth what bends over time, and leave what moves, turns and stretches. */
  smooth(points, time) {
    this.rest ??= points;
    const affine = fitAffine(this.rest, points);
    const bent = points.map(([x, y], at) => [x - affine[at][0], y - affine[at][1]]);
    this.bent ??= bent;
    const share = 1 - Math.exp(-Math.max(time - this.time, 0) / SMOOTH);
    this.bent = this.bent.map((old, at) => old.map((one, axis) => one + share * (bent[at][axis] - one)));
    this.time = time;
    const squares = this.bent.reduce((sum, [x, y]) => sum + x * x + y * y, 0);
    const bend = Math.sqrt(squares / points.length) / placeFace(points).side;
    const landmarks = affine.map(([x, y], at) =>
      [x + this.bent[at][0], y + this.bent[at][1]].map(Math.fround),
    );
    return { landmarks, bend };
  }

  /** Whether the whole picture has changed, its brightness aside. */
  noticeCut(frame) {
    const now = normalise(makeThumbnail(frame));
    const before = this.thumbnail;
    this.thumbnail = now;
    if (!before) return false;
    const squares = now.reduce((sum, value, at) => sum + (value - before[at]) ** 2, 0);
    return squares / now.length / 2 > CUT;
  }
}

/** The face that is nearest to a place; numbers of faces change when one is hidden. */
function findNearest(faces, place) {
  const measure = ({ landmarks }) => {
    const { x, y, side } = placeFace(landmarks);
    return Math.hypot(x - place.x, y - place.y) + Math.abs(side - place.side);
  };
  return faces.reduce((best, face) => (measure(face) < measure(best) ? face : best));
}

/** The source's points under the affine map that takes them next to the target's. */
function fitAffine(source, target) {
  const rows = source.map(([x, y]) => [x, y, 1]);
  const normal = [0, 1, 2].map((one) =>
    [0, 1, 2].map((other) => rows.reduce((sum, row) => sum + row[one] * row[other], 0)),
  );
  const inverse = invert(normal);
  const columns = [0, 1].map((axis) => {
    const right = [0, 1, 2].map((one) =>
      rows.reduce((sum, row, at) => sum + row[one] * target[at][axis], 0),
    );
    return inverse.map((row) => row.reduce((sum, value, at) => sum + value * right[at], 0));
  });
  return rows.map((row) => columns.map((column) => row.reduce((sum, one, at) => sum + one * column[at], 0)));
}

/** Grey levels of a small picture. */
function makeThumbnail({ data, width, height, channels }) {
  const step = Math.max(1, Math.floor(width / (4 * THUMBNAIL[0])));
  const [wide, tall] = [Math.ceil(width / step), Math.ceil(height / step)];
  const picked = new Uint8Array(3 * wide * tall);
  for (let at = 0; at < wide * tall; at++) {
    const from = (Math.floor(at / wide) * step * width + (at % wide) * step) * channels;
    for (let channel = 0; channel < 3; channel++) picked[3 * at + channel] = data[from + channel];
  }
  const small = resize(makeRaster(picked, wide, tall, 3), ...THUMBNAIL).data;
  return Array.from({ length: small.length / 3 }, (_, at) =>
    (small[3 * at] + small[3 * at + 1] + small[3 * at + 2]) / 3,
  );
}

function normalise(grey) {
  const mean = grey.reduce((sum, value) => sum + value, 0) / grey.length;
  const variance = grey.reduce((sum, value) => sum + (value - mean) ** 2, 0) / grey.length;
  return grey.map((value) => (value - mean) / Math.max(Math.sqrt(variance), 2));
}
