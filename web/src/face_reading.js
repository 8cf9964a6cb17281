/** What is read of one face, and its edit. */

import { writeNpy, writeZip } from "./archive.js";
import { SCALES, colourPlane } from "./colour_scales.js";
import { Editor, UNCHANGED, isUnchanged } from "./editing.js";
import { checkFace } from "./face_checks.js";
import { segmentFaceSkin } from "./face_skin.js";
import { GuidedPlane } from "./guided_filter.js";
import { cropHead, cutHead, fadeEdges, turnBack } from "./head_crop.js";
import { adoptMask } from "./mask_adoption.js";
import { keepOwnSkin } from "./own_skin.js";
import { MASK } from "./python_data.js";
import { cropRaster } from "./raster.js";
import { ResizedPlane, resize } from "./resizing.js";
import {
  averageSkin, doubtWhite, findInterval, isSkin, listDoubts, measureSkin,
} from "./uncertainty.js";
import { measureWhite } from "./white_reference.js";

const HEAD_VIEW = 512; // longest side, in pixels, of the head as the page shows and edits it
const EDGE_RADIUS = 1; // of the guided filter of a mask without landmarks, in its pixels
const MAP_SIZE = 640; // longer side, in pixels, of maps that are downloaded in colour
const LEVEL = 0.9; // of the intervals

export class FaceReading {
  /**
   * Read a face, described as `who` in the photograph of a `name`; `others` are the photograph's
   * other faces, `white` is a place or null. Throws a sentence if it cannot be read.
   */
  static async read(networks, photo, { face, who, name, others, isMarked }, white) {
    const known = white ? { white_balance: measureWhite(photo, white.x, white.y) } : {};
    const crop = cropHead(face, photo);
    const checked = checkFace(photo, crop, face, who, name, isMarked);
    const cut = cutHead(crop, photo, networks.workingSize);
    const { planes: upright, capture, faceSd } = await networks.encode(cut, known);
    const { planes, width, height } = turnBack(
      crop, upright, cut.width, cut.height, networks.workingSize,
    );
    const part = cropRaster(photo, crop.box);
    const skin = findSkin(part, face, others, crop.box, { plane: planes.mask, width, height });
    const head = shrinkHead(part);
    const mask = guideMask(head, skin).readRows(head, 0, head.height);
    const adopted = { plane: mask, width: head.width, height: head.height };
    Object.assign(planes, adoptMask(planes, width, height, adopted, part));
    const fade = fadeEdges(crop, width, height, photo);
    const doubts = listDoubts({
      who, upright, faceSd,
      skinShare: mask.filter(isSkin).length / mask.length,
      ...measureSkin(photo, crop.box, planes.mask, width, height),
      whiteBalance: [...capture.white_balance],
      isWhiteKnown: white !== null,
    });
    const blind = white && (await networks.encode(cut)).capture.white_balance;
    const whiteDoubts = white ? doubtWhite(who, known.white_balance, blind) : [];
    const notes = [...checked, ...whiteDoubts, ...doubts];
    return new FaceReading({
      networks, face, crop, planes, width, height, capture, faceSd, fade, checked, notes, photo, skin,
      head,
    });
  }

  constructor(parts) {
    Object.assign(this, parts);
    this.factors = UNCHANGED;
    this.editor = new Editor(this.networks, this);
    this.headMask = this.makeMask(this.head);
    this.known = new Map();
  }

  /** Maps, means and notes for the page. */
  describe() {
    const { planes, width, height, crop, notes } = this;
    const shown = [...Object.keys(SCALES), "mask"];
    const copies = Object.fromEntries(shown.map((name) => [name, planes[name].slice()]));
    const head = { ...this.head, data: this.head.data.slice() };
    const means = this.computeMeans();
    return { planes: copies, width, height, box: crop.box, head, notes, means };
  }

  /** Set the edit; its paint, if there is one, says where it is. */
  setFactors(factors) {
    const { paint } = factors;
    if (paint?.id !== this.factors.paint?.id) {
      const { fade } = this;
      this.editor.fade = paint ? fade.map((value, at) => value * paint.values[at]) : fade;
      this.known.clear();
    }
    this.factors = factors;
  }

  /** Edit the view of the head; what is not edited is transparent. Null without an edit. */
  async editView(factors) {
    this.setFactors(factors);
    if (isUnchanged(factors)) return null;
    const head = { ...this.head, data: this.head.data.slice() };
    this.editor.apply(head, this.headMask, await this.editor.computeChange(factors), this.known);
    for (const [first, { weights }] of this.known) {
      const start = first * head.width;
      weights.forEach((weight, at) => {
        if (weight === 0) head.data[4 * (start + at) + 3] = 0;
      });
    }
    return head;
  }

  /** Compute what all edits of the view need, so that the first one takes no longer than others. */
  async prepareEdits() {
    const head = { ...this.head, data: this.head.data.slice() };
    const change = await this.editor.computeChange(UNCHANGED);
    this.editor.apply(head, this.headMask, change, this.known);
  }

  /** Edit the photograph in a canvas, at its full size. */
  async editCanvas(context) {
    if (isUnchanged(this.factors)) return;
    const { left, top, right, bottom } = this.crop.box;
    const image = context.getImageData(left, top, right - left, bottom - top);
    const part = { data: image.data, width: image.width, height: image.height, channels: 4 };
    const change = await this.editor.computeChange(this.factors);
    this.editor.apply(part, this.makeMask(part), change);
    context.putImageData(image, left, top);
  }

  /** The maps as a ZIP archive: NumPy files of fractions, pictures in colour, and a summary. */
  async writeMaps(name) {
    const { planes, width, height } = this;
    const files = { "summary.json": new TextEncoder().encode(this.summarise(name)) };
    for (const [map, plane] of Object.entries(planes)) {
      files[`${map}.npy`] = writeNpy(plane, width, height);
    }
    for (const map of Object.keys(SCALES)) files[`${map}.png`] = await this.drawMap(map);
    return writeZip(files);
  }

  /** The mask of a picture of the rectangle that is read. */
  makeMask(part) {
    return guideMask(part, this.skin);
  }

  /** Means over the skin with their intervals of 90 %; null without skin. */
  computeMeans() {
    const { planes, faceSd } = this;
    const describe = (name, at) => {
      const mean = averageSkin(planes[name], planes.mask);
      const [, top] = this.networks.outputs[name].range;
      return mean === null ? null : { mean, interval: findInterval(mean, faceSd[at], top) };
    };
    return { melanin: describe("melanin", 0), hemoglobin: describe("hemoglobin", 1) };
  }

  summarise(name) {
    const { crop, notes, face, capture, planes, photo, networks } = this;
    const skin = planes.mask.filter((value) => isSkin(value)).length / planes.mask.length;
    const summary = {
      photograph: name,
      size: [photo.width, photo.height],
      box: crop.box,
      tilt: face.tilt,
      skin_share: skin,
      ...this.computeMeans(),
      level: LEVEL,
      white_balance: [...capture.white_balance],
      notes,
      model: { version: networks.version, optics: networks.optics },
    };
    return JSON.stringify(summary, null, 2);
  }

  async drawMap(name) {
    const { planes, width, height } = this;
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

/** The skin of a face in its rectangle; without landmarks, or without any, that of the network. */
function findSkin(part, face, others, box, coarse) {
  const isSeen = face.landmarks && coarse.plane.some(isSkin);
  const landmarks = isSeen && face.landmarks.map(([x, y]) => [x - box.left, y - box.top]);
  const skin = isSeen
    ? segmentFaceSkin(part, landmarks, coarse)
    : { ...coarse, plane: coarse.plane.slice(), radius: EDGE_RADIUS };
  keepOwnSkin(skin.plane, skin.width, skin.height, box, face, others);
  return skin;
}

/** The mask of a picture of the rectangle, whose edges it follows. */
function guideMask(part, { plane, width, height, radius }) {
  return new GuidedPlane(part, plane, width, height, radius, MASK.EDGE_VARIANCE);
}

/** The head as the page shows and edits it. */
function shrinkHead(part) {
  const scale = HEAD_VIEW / Math.max(part.width, part.height);
  if (scale >= 1) return part;
  const [width, height] = [part.width, part.height].map((side) => Math.round(side * scale));
  return resize(part, Math.max(1, width), Math.max(1, height));
}
