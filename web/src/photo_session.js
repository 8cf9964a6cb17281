/** One photograph: its faces, and what was read of each. */

import { refuseGrey } from "./colour_content.js";
import { findFaces } from "./face_finder.js";
import { FaceReading } from "./face_reading.js";
import { resize } from "./resizing.js";
import { roundHalfEven } from "./rounding.js";

const VIEW = 1024; // longest side, in pixels, of the photograph as the page shows it

export class PhotoSession {
  constructor(networks, photo, name) {
    Object.assign(this, { networks, photo, name, faces: [], readings: new Map() });
    const scale = Math.min(1, VIEW / Math.max(photo.width, photo.height));
    const [width, height] = [photo.width, photo.height].map((side) =>
      Math.max(1, Math.round(side * scale)),
    );
    this.view = scale < 1 ? resize(photo, width, height) : photo;
  }

  /** What the page shows before any face is found. */
  describePhoto() {
    const { view, photo, name } = this;
    const size = [photo.width, photo.height];
    return { name, size, view: { ...view, data: view.data.slice() } };
  }

  /** Find faces; `isQuick` for those that the whole photograph shows at a glance. */
  async findFaces(isQuick) {
    this.faces = await findFaces(this.networks, this.photo, isQuick);
    if (!isQuick && !this.faces.length) refuseGrey(this.photo, this.name);
    const sides = this.faces.map(({ box }) => box.right - box.left);
    return { faces: this.faces, largest: sides.indexOf(Math.max(...sides)) };
  }

  /** Read a face {box, tilt}; `white` is a place of something white, or null. */
  async read(face, white = null) {
    const key = makeKey(face);
    const reading = await FaceReading.read(this.networks, this.photo, this.describe(face), white);
    reading.setFactors(this.readings.get(key)?.factors ?? reading.factors);
    this.readings.set(key, reading);
    this.reading = reading;
    return { ...reading.describe(), key };
  }

  editView(factors) {
    return this.reading.editView(factors);
  }

  /** The whole photograph, with the edits of all faces, as a PNG file. */
  async writePhoto(factors) {
    this.reading.setFactors(factors);
    const { data, width, height } = this.photo;
    const canvas = new OffscreenCanvas(width, height);
    const context = canvas.getContext("2d", { willReadFrequently: true });
    context.putImageData(new ImageData(data, width, height), 0, 0);
    for (const reading of this.readings.values()) await reading.editCanvas(context);
    return canvas.convertToBlob({ type: "image/png" });
  }

  writeMaps() {
    return this.reading.writeMaps(this.name);
  }

  /** A face among the photograph's others, and what it is called in notes. */
  describe(face) {
    const { name, faces } = this;
    const keys = faces.map(makeKey);
    const number = keys.indexOf(makeKey(face)) + 1;
    const others = faces.filter((_, at) => at + 1 !== number);
    const who = number && others.length ? `face ${number} in ${name}` : `the face in ${name}`;
    return { face, who, name, others, isMarked: !number };
  }
}

/** The face of a square that the user has drawn around one, from the brows to the chin. */
export function makeFace({ left, top, right, bottom }) {
  const box = { left, top, right, bottom };
  for (const side of Object.keys(box)) box[side] = roundHalfEven(box[side]);
  return { box, tilt: 0 };
}

function makeKey({ box }) {
  return [box.left, box.top, box.right, box.bottom].join(",");
}
