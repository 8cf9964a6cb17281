/** The photograph: before and after with a divider, faces, the point, and what the pointer does. */

import { clamp } from "./rounding.js";

const STEP = 1; // pixels of the view that an arrow key moves the point, and with Shift
const LARGE_STEP = 10;
const GRIP = 12; // distance, in pixels of the screen, at which the divider is taken

const LEAST_CANVAS = 640; // longer side of the canvas, in pixels

const LEAST_BOX = 24; // side of a face that is marked, in pixels of the photograph

/**
 * Calls `onPoint(point, isByKey)`, `onPick(point)`, `onMark(box)`, `onDivide(share)`, and
 * `onPaint(from, to, isDone)`.
 */
export class PictureView {
  constructor(canvas, calls) {
    Object.assign(this, { canvas, calls, tool: "probe", share: 0.5, isZoomed: false });
    Object.assign(this, { faces: [], chosen: -1, point: null, marked: null, drag: null });
    Object.assign(this, { view: null, head: null, edits: new Map() });
    this.context = canvas.getContext("2d", { willReadFrequently: true });
    canvas.addEventListener("pointerdown", (event) => this.press(event));
    canvas.addEventListener("pointermove", (event) => this.move(event));
    canvas.addEventListener("pointerup", (event) => this.release(event));
    canvas.addEventListener("pointercancel", () => this.cancel());
    canvas.addEventListener("keydown", (event) => this.type(event));
  }

  /** Show a photograph by its view; coordinates are those of the photograph. */
  setPhoto({ view, size }) {
    Object.assign(this, { size, faces: [], chosen: -1, point: null, marked: null, head: null });
    this.edits.clear();
    this.view = makeCanvas(view);
    this.draw();
  }

  setFaces(faces, chosen) {
    Object.assign(this, { faces, chosen, marked: null });
    this.draw();
  }

  /** Show what was read: its rectangle, its pixels, and its key among several. */
  setReading({ box, head, key }) {
    Object.assign(this, { box, head: makeCanvas(head), key, point: null });
    this.edits.delete(key);
    this.draw();
  }

  setTool(tool) {
    this.tool = tool;
    this.marked = null;
    this.canvas.classList.toggle("marking", tool === "box" || tool === "paint");
    this.draw();
  }

  setZoom(isZoomed) {
    this.isZoomed = isZoomed;
    this.draw();
  }

  /** Show the brush by its radius, and what is painted by values of the reading's size. */
  setPaint(radius, values, width) {
    Object.assign(this, { radius, painted: values && makePaintCanvas(values, width) });
    this.draw();
  }

  setShare(share) {
    this.share = share;
    this.draw();
  }

  setPoint(point) {
    this.point = point;
    this.draw();
  }

  /** Show the edited pixels of what was read last; null for none. */
  setEdited(head) {
    if (head) this.edits.set(this.key, { box: this.box, head: makeCanvas(head) });
    else this.edits.delete(this.key);
    this.draw();
  }

  /** The part of the photograph that is shown; white and faces are looked for in all of it. */
  get frame() {
    if (this.isZoomed && this.head && ["probe", "paint"].includes(this.tool)) return this.box;
    return { left: 0, top: 0, right: this.size[0], bottom: this.size[1] };
  }

  draw() {
    if (!this.view) return;
    const { canvas } = this;
    const { frame } = this;
    const [width, height] = [frame.right - frame.left, frame.bottom - frame.top];
    const wanted = Math.max(LEAST_CANVAS, this.view.width, this.view.height);
    this.scale = wanted / Math.max(width, height);
    resizeCanvas(canvas, Math.round(width * this.scale), Math.round(height * this.scale));
    this.paint();
    if (this.edits.size) this.drawDivider();
    const unit = canvas.width / Math.max(1, canvas.clientWidth || canvas.width);
    this.faces.forEach((face, index) => this.drawFace(face, index, unit));
    if (this.marked) this.drawBox(this.marked, unit, [6, 4]);
    if (this.tool === "paint" && this.head) this.drawBrush(unit);
    if (this.point) drawCross(this.context, ...this.placeInCanvas(this.point), unit);
  }

  /** Paint the photograph with the edits of all faces, or without. */
  paint(isAfter = true) {
    const { context, view, frame, size } = this;
    const ratio = view.width / size[0];
    const [width, height] = [frame.right - frame.left, frame.bottom - frame.top];
    const source = [frame.left, frame.top, width, height].map((value) => value * ratio);
    context.imageSmoothingQuality = "high";
    context.drawImage(view, ...source, 0, 0, this.canvas.width, this.canvas.height);
    if (this.head) this.paintHead(this.head, this.box);
    if (!isAfter) return;
    for (const { head, box } of this.edits.values()) this.paintHead(head, box);
  }

  paintHead(head, box) {
    const [left, top] = this.placeInCanvas([box.left, box.top]);
    const [right, bottom] = this.placeInCanvas([box.right, box.bottom]);
    this.context.drawImage(head, left, top, right - left, bottom - top);
  }

  drawDivider() {
    const { context, canvas } = this;
    const place = Math.round(this.share * canvas.width);
    if (place <= 0) return;
    context.save();
    context.beginPath();
    context.rect(0, 0, place, canvas.height);
    context.clip();
    this.paint(false);
    context.restore();
    context.fillStyle = "rgb(255 255 255 / 90%)";
    context.fillRect(place - 1, 0, 2, canvas.height);
  }

  /** The brush, and what is painted while no edit shows it. */
  drawBrush(unit) {
    if (this.painted && !this.edits.has(this.key)) this.paintHead(this.painted, this.box);
    if (!this.point) return;
    const [x, y] = this.placeInCanvas(this.point);
    for (const [colour, line] of [["rgb(0 0 0 / 60%)", 3.5], ["white", 1.5]]) {
      this.context.strokeStyle = colour;
      this.context.lineWidth = line * unit;
      this.context.beginPath();
      this.context.arc(x, y, this.radius * this.scale, 0, 2 * Math.PI);
      this.context.stroke();
    }
  }

  placeInCanvas([x, y]) {
    return [(x - this.frame.left) * this.scale, (y - this.frame.top) * this.scale];
  }

  drawFace(face, index, unit) {
    if (this.faces.length < 2) return;
    this.drawBox(face.box, unit, index === this.chosen ? [] : [4, 4], `${index + 1}`);
  }

  drawBox(box, unit, dashes, label = "") {
    const { context, scale } = this;
    const [x, y] = this.placeInCanvas([box.left, box.top]);
    const [width, height] = [(box.right - box.left) * scale, (box.bottom - box.top) * scale];
    for (const [colour, line] of [["rgb(0 0 0 / 60%)", 3.5], ["white", 1.5]]) {
      context.strokeStyle = colour;
      context.lineWidth = line * unit;
      context.setLineDash(dashes.map((dash) => dash * unit));
      context.strokeRect(x, y, width, height);
    }
    context.setLineDash([]);
    if (label) this.drawLabel(label, x, y, unit);
  }

  drawLabel(label, x, y, unit) {
    const { context } = this;
    context.fillStyle = "rgb(0 0 0 / 70%)";
    context.fillRect(x, y, 20 * unit, 20 * unit);
    context.fillStyle = "white";
    context.font = `600 ${14 * unit}px system-ui, sans-serif`;
    context.fillText(label, x + 6 * unit, y + 15 * unit);
  }

  press(event) {
    if (!this.view) return;
    const point = this.locate(event);
    if (this.edits.size && this.tool === "probe" && this.isOnDivider(event)) {
      this.drag = { kind: "divider" };
    } else if (this.tool === "box") {
      this.drag = { kind: "box", start: point };
    } else if (this.tool === "paint") {
      this.drag = { kind: "paint", last: point };
      this.calls.onPoint(point, false);
      this.calls.onPaint(point, point, false);
    } else {
      this.drag = { kind: "point" };
      this.calls.onPoint(point, false);
    }
    this.canvas.setPointerCapture(event.pointerId);
  }

  move(event) {
    if (!this.view) return;
    const point = this.locate(event);
    if (this.drag?.kind === "divider") {
      this.calls.onDivide(this.placeInCanvas(point)[0] / this.canvas.width);
    } else if (this.drag?.kind === "box") {
      this.marked = makeSquare(this.drag.start, point, this.size);
      this.draw();
    } else if (this.drag?.kind === "paint") {
      this.calls.onPoint(point, false);
      this.calls.onPaint(this.drag.last, point, false);
      this.drag.last = point;
    } else if (this.drag || event.pointerType === "mouse") {
      this.calls.onPoint(point, false);
    }
  }

  release(event) {
    const { drag } = this;
    this.drag = null;
    if (drag?.kind === "box") this.finishBox();
    if (drag?.kind === "paint") this.calls.onPaint(drag.last, this.locate(event), true);
    if (drag?.kind === "point" && this.tool === "white") this.calls.onPick(this.locate(event));
  }

  cancel() {
    this.drag = null;
    this.marked = null;
    this.draw();
  }

  finishBox() {
    const box = this.marked;
    this.marked = null;
    this.draw();
    if (box) this.calls.onMark(box);
  }

  /** Arrow keys move the point or the box; plus and minus resize the box; Enter does it. */
  type(event) {
    if (!this.view || event.ctrlKey || event.metaKey || event.altKey) return;
    const step = (event.shiftKey ? LARGE_STEP : STEP) / this.scale;
    const moves = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
    const move = moves[event.key]?.map((axis) => axis * step);
    const isBox = this.tool === "box";
    if (move && isBox) this.resizeBox(...move, 0);
    else if (move) this.calls.onPoint(this.shiftPoint(move), true);
    else if (isBox && ["+", "=", "-"].includes(event.key)) {
      this.resizeBox(0, 0, event.key === "-" ? -LARGE_STEP : LARGE_STEP);
    } else if (event.key === "Enter" && isBox) this.finishBox();
    else if (event.key === "Enter" && this.tool === "white") this.calls.onPick(this.shiftPoint([0, 0]));
    else if (event.key === "Enter" && this.tool === "paint") {
      const point = this.shiftPoint([0, 0]);
      this.calls.onPaint(point, point, true);
    } else if (event.key === "Escape") this.cancel();
    else return;
    event.preventDefault();
  }

  shiftPoint([dx, dy]) {
    const { left, top, right, bottom } = this.frame;
    const [x, y] = this.point ?? [(left + right) / 2, (top + bottom) / 2];
    return [clamp(x + dx, left, right - 1), clamp(y + dy, top, bottom - 1)];
  }

  resizeBox(dx, dy, growth) {
    const [width, height] = this.size;
    const side = Math.min(width, height) / 3;
    const box = this.marked ?? {
      left: (width - side) / 2, top: (height - side) / 2,
      right: (width + side) / 2, bottom: (height + side) / 2,
    };
    const half = Math.max(LEAST_BOX, box.right - box.left + growth) / 2;
    const x = clamp((box.left + box.right) / 2 + dx, 0, width);
    const y = clamp((box.top + box.bottom) / 2 + dy, 0, height);
    this.marked = { left: x - half, top: y - half, right: x + half, bottom: y + half };
    this.draw();
  }

  locate(event) {
    const place = this.canvas.getBoundingClientRect();
    const { frame } = this;
    const between = (low, high, share) => low + clamp(share, 0, 0.9999) * (high - low);
    return [
      between(frame.left, frame.right, (event.clientX - place.left) / place.width),
      between(frame.top, frame.bottom, (event.clientY - place.top) / place.height),
    ];
  }

  isOnDivider(event) {
    const frame = this.canvas.getBoundingClientRect();
    return Math.abs(event.clientX - frame.left - this.share * frame.width) < GRIP;
  }
}

/** Draw a cross whose middle is free. */
export function drawCross(context, x, y, unit) {
  for (const [colour, line] of [["rgb(0 0 0 / 70%)", 3.5], ["white", 1.5]]) {
    context.strokeStyle = colour;
    context.lineWidth = line * unit;
    context.beginPath();
    for (const [dx, dy] of [[1, 0], [-1, 0], [0, 1], [0, -1]]) {
      context.moveTo(x + 3 * dx * unit, y + 3 * dy * unit);
      context.lineTo(x + 11 * dx * unit, y + 11 * dy * unit);
    }
    context.stroke();
  }
}

/** A canvas loses its picture, and time, if its size is set. */
function resizeCanvas(canvas, width, height) {
  if (canvas.width !== width) canvas.width = width;
  if (canvas.height !== height) canvas.height = height;
}

function makeCanvas({ data, width, height }) {
  const canvas = new OffscreenCanvas(width, height);
  canvas.getContext("2d").putImageData(new ImageData(data, width, height), 0, 0);
  return canvas;
}

/** Paint in a colour that skin does not have. */
function makePaintCanvas(values, width) {
  const data = new Uint8ClampedArray(4 * values.length);
  values.forEach((value, at) => data.set([40, 120, 255, 140 * value], 4 * at));
  return makeCanvas({ data, width, height: values.length / width });
}

/** The square from one corner to the other, within the photograph's sides; null if it is small. */
function makeSquare([x, y], [otherX, otherY], [width, height]) {
  const wanted = Math.max(Math.abs(otherX - x), Math.abs(otherY - y));
  const side = Math.min(wanted, width, height);
  if (side < LEAST_BOX) return null;
  const left = otherX < x ? x - side : x;
  const top = otherY < y ? y - side : y;
  return { left, top, right: left + side, bottom: top + side };
}
