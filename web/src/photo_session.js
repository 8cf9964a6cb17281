/** One photograph: its faces, and what was read of each. */

import { findFaces } from "./face_finder.js";
import { FaceReading } from "./face_reading.js";
import { resize } from "./resizing.js";
import { roundHalfEven } from "./rounding.js";

const VIEW = 1024; // longest side, in pixels, of the photograph as the page shows it
const LEAST_FACE = 24; // width of a face, in pixels
const GREY = 6; // most difference of the channels in a photograph without colour

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
    const sides = this.faces.map(({ box }) => box.right - box.left);
    return { faces: this.faces, largest: sides.indexOf(Math.max(...sides)) };
  }

  /** Read a face {box, tilt}; `white` is a place of something white, or null. */
  async read(face, white = null) {
    this.refuseFace(face);
    const key = makeKey(face);
    const others = this.faces.filter((other) => makeKey(other) !== key);
    const reading = await FaceReading.read(this.networks, this.photo, face, others, white);
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

  refuseFace({ box }) {
    const width = box.right - box.left;
    if (width < LEAST_FACE) {
      throw new Error(
        `The face is ${width} pixels wide, and ${LEAST_FACE} are needed; give the picture at its ` +
          "full size.",
      );
    }
    if (isGrey(this.view)) {
      throw new Error("The photograph has no colour, which pigments are read from; give another.");
    }
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

function isGrey({ data, channels }) {
  for (let at = 0; at < data.length; at += channels) {
    const [red, green, blue] = [data[at], data[at + 1], data[at + 2]];
    if (Math.max(red, green, blue) - Math.min(red, green, blue) > GREY) return false;
  }
  return true;
}
