/** One photograph: its faces, what was read of one of them, and edits of it. */

import { writeNpy, writeZip } from "./archive.js";
import { SCALES, colourPlane } from "./colour_scales.js";
import { Editor } from "./editing.js";
import { findFaces } from "./face_finder.js";
import { GuidedPlane } from "./guided_filter.js";
import { cropHead, cutHead, fadeEdges, turnBack } from "./head_crop.js";
import { cropRaster } from "./raster.js";
import { ResizedPlane, resize } from "./resizing.js";
import { roundHalfEven } from "./rounding.js";
import { averageSkin, findInterval, isSkin, listDoubts } from "./uncertainty.js";
import { measureWhite } from "./white_reference.js";

const VIEW = 1024; // longest side, in pixels, of the photograph as the page shows it
const HEAD_VIEW = 512; // the same of the rectangle that is read and edited
const LEAST_FACE = 24; // width of a face, in pixels
const GREY = 6; // most difference of the channels in a photograph without colour
const EDGE_RADIUS = 1; // of the guided filter of the mask, in pixels of the network
const EDGE_VARIANCE = 3e-4;
const MAP_SIZE = 640; // longer side, in pixels, of maps that are downloaded in colour

export class PhotoSession {
  constructor(networks, photo, name) {
    Object.assign(this, { networks, photo, name });
    this.scale = Math.min(1, VIEW / Math.max(photo.width, photo.height));
    const [width, height] = [photo.width, photo.height].map((side) =>
      Math.max(1, Math.round(side * this.scale)),
    );
    this.view = this.scale < 1 ? resize(photo, width, height) : photo;
  }

  /** What the page shows before any face is found. */
  describePhoto() {
    const { view, photo, name } = this;
    const size = [photo.width, photo.height];
    return { name, size, view: { ...view, data: view.data.slice() } };
  }

  async findFaces() {
    this.faces = await findFaces(this.networks, this.photo);
    const sides = this.faces.map(({ box }) => box.right - box.left);
    return { faces: this.faces, largest: sides.indexOf(Math.max(...sides)) };
  }

  /** Read a face {box, tilt}; `white` is a place of something white, or null. */
  async read(face, white = null) {
    this.refuseFace(face);
    const { networks, photo } = this;
    const known = white ? { white_balance: measureWhite(photo, white.x, white.y) } : {};
    const crop = cropHead(face, photo);
    const cut = cutHead(crop, photo, networks.workingSize);
    const { planes: upright, capture, faceSd } = await networks.encode(cut, known);
    const turned = turnBack(crop, upright, cut.width, cut.height, networks.workingSize);
    const fade = fadeEdges(crop, turned.width, turned.height, photo);
    const notes = listDoubts(cut, upright.mask, faceSd, [...capture.white_balance], white !== null);
    this.reading = { ...turned, crop, capture, faceSd, fade, notes, face };
    this.editor = new Editor(networks, this.reading);
    this.head = this.makeHeadView();
    this.headMask = this.makeMask(this.head);
    this.known = new Map();
    return this.describeReading();
  }

  /** Edit the view of the reading's rectangle. */
  async editView(factors) {
    const change = await this.editor.computeChange(factors);
    const head = { ...this.head, data: this.head.data.slice() };
    this.editor.apply(head, this.headMask, change, this.known);
    return head;
  }

  /** The whole photograph, edited, as a PNG file. */
  async writePhoto(factors) {
    const { photo, reading, editor } = this;
    const { box } = reading.crop;
    const part = cropRaster(photo, box);
    editor.apply(part, this.makeMask(part), await editor.computeChange(factors));
    const canvas = new OffscreenCanvas(photo.width, photo.height);
    const context = canvas.getContext("2d");
    context.putImageData(toImageData(photo), 0, 0);
    context.putImageData(toImageData(part), box.left, box.top);
    return canvas.convertToBlob({ type: "image/png" });
  }

  /** The maps as a ZIP archive: NumPy files of fractions, pictures in colour, and a summary. */
  async writeMaps() {
    const { planes, width, height } = this.reading;
    const files = { "summary.json": new TextEncoder().encode(this.summarise()) };
    for (const [name, plane] of Object.entries(planes)) {
      files[`${name}.npy`] = writeNpy(plane, width, height);
    }
    for (const name of Object.keys(SCALES)) {
      files[`${name}.png`] = await this.drawMap(name);
    }
    return writeZip(files);
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

  /** The mask of a picture of the reading's rectangle. */
  makeMask(part) {
    const { planes, width, height } = this.reading;
    return new GuidedPlane(part, planes.mask, width, height, EDGE_RADIUS, EDGE_VARIANCE);
  }

  makeHeadView() {
    const part = cropRaster(this.photo, this.reading.crop.box);
    const scale = HEAD_VIEW / Math.max(part.width, part.height);
    if (scale >= 1) return part;
    const [width, height] = [part.width, part.height].map((side) => Math.round(side * scale));
    return resize(part, Math.max(1, width), Math.max(1, height));
  }

  describeReading() {
    const { planes, width, height, crop, notes } = this.reading;
    const shown = [...Object.keys(SCALES), "mask"];
    const copies = Object.fromEntries(shown.map((name) => [name, planes[name].slice()]));
    const head = { ...this.head, data: this.head.data.slice() };
    const means = this.computeMeans();
    return { planes: copies, width, height, box: crop.box, head, notes, means };
  }

  /** Means over the skin with their intervals of 90 %; null without skin. */
  computeMeans() {
    const { planes, faceSd } = this.reading;
    const describe = (name, at) => {
      const mean = averageSkin(planes[name], planes.mask);
      const top = this.findTop(name);
      return mean === null ? null : { mean, interval: findInterval(mean, faceSd[at], top) };
    };
    return { melanin: describe("melanin", 0), hemoglobin: describe("hemoglobin", 1) };
  }

  findTop(name) {
    return this.networks.outputs[name].range[1];
  }

  summarise() {
    const { crop, notes, face, capture, planes } = this.reading;
    const { version, optics } = this.networks;
    const skin = planes.mask.filter((value) => isSkin(value)).length / planes.mask.length;
    const summary = {
      photograph: this.name,
      size: [this.photo.width, this.photo.height],
      box: crop.box,
      tilt: face.tilt,
      skin_share: skin,
      ...this.computeMeans(),
      level: 0.9,
      white_balance: [...capture.white_balance],
      notes,
      model: { version, optics },
    };
    return JSON.stringify(summary, null, 2);
  }

  async drawMap(name) {
    const { planes, width, height } = this.reading;
    const scale = MAP_SIZE / Math.max(width, height);
    const [wide, tall] = [width, height].map((side) => Math.round(side * scale));
    const [plane, mask] = [planes[name], planes.mask].map((each) =>
      new ResizedPlane(each, width, height, wide, tall).readRows(0, tall),
    );
    const canvas = new OffscreenCanvas(wide, tall);
    const data = colourPlane(SCALES[name], plane, mask);
    canvas.getContext("2d").putImageData(new ImageData(data, wide, tall), 0, 0);
    const blob = await canvas.convertToBlob({ type: "image/png" });
    return new Uint8Array(await blob.arrayBuffer());
  }
}

/** The face box of a square that the user has drawn around a face, from the brows to the chin. */
export function makeFace({ left, top, right, bottom }) {
  const box = { left, top, right, bottom };
  for (const side of Object.keys(box)) box[side] = roundHalfEven(box[side]);
  return { box, tilt: 0 };
}

function isGrey({ data, channels }) {
  for (let at = 0; at < data.length; at += channels) {
    const [red, green, blue] = [data[at], data[at + 1], data[at + 2]];
    if (Math.max(red, green, blue) - Math.min(red, green, blue) > GREY) return false;
  }
  return true;
}

function toImageData({ data, width, height }) {
  return new ImageData(data, width, height);
}
