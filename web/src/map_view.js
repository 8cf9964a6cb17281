/** A map in colour with its scale. */

import { SCALES, colourPlace, colourPlane, placeValue } from "./colour_scales.js";
import { drawCross } from "./picture_view.js";

const SIDE = 480; // longer side of the canvas, in pixels

export class MapView {
  /** Calls `onPoint(point)` with a point of the photograph. */
  constructor(name, onPoint) {
    this.name = name;
    this.scale = SCALES[name];
    this.canvas = document.createElement("canvas");
    this.canvas.setAttribute("role", "img");
    this.canvas.setAttribute("aria-label", `Map: ${this.scale.title}, ${this.scale.measure}`);
    this.element = this.build();
    const locate = (event) => {
      if (!this.reading) return;
      const frame = this.canvas.getBoundingClientRect();
      const { box } = this.reading;
      const u = (event.clientX - frame.left) / frame.width;
      const v = (event.clientY - frame.top) / frame.height;
      const between = (low, high, share) => low + Math.min(0.999, Math.max(0, share)) * (high - low);
      onPoint([between(box.left, box.right, u), between(box.top, box.bottom, v)]);
    };
    this.canvas.addEventListener("pointermove", locate);
    this.canvas.addEventListener("pointerdown", locate);
  }

  setReading(reading) {
    this.reading = reading;
    const { planes, width, height } = reading;
    const data = colourPlane(this.scale, planes[this.name], planes.mask);
    this.image = new OffscreenCanvas(width, height);
    this.image.getContext("2d").putImageData(new ImageData(data, width, height), 0, 0);
    const enlarge = SIDE / Math.max(width, height);
    this.canvas.width = Math.round(width * enlarge);
    this.canvas.height = Math.round(height * enlarge);
    this.setPoint(null);
  }

  setPoint(point) {
    if (!this.reading) return;
    const { canvas, image } = this;
    const { box } = this.reading;
    const context = canvas.getContext("2d");
    context.clearRect(0, 0, canvas.width, canvas.height);
    context.imageSmoothingQuality = "high";
    context.drawImage(image, 0, 0, canvas.width, canvas.height);
    if (!point) return;
    const x = ((point[0] - box.left) / (box.right - box.left)) * canvas.width;
    const y = ((point[1] - box.top) / (box.bottom - box.top)) * canvas.height;
    drawCross(context, x, y, canvas.width / Math.max(1, canvas.clientWidth || canvas.width));
  }

  build() {
    const figure = document.createElement("figure");
    const caption = document.createElement("figcaption");
    caption.textContent = this.scale.title;
    const view = document.createElement("div");
    view.className = "view";
    view.append(this.canvas);
    figure.append(caption, view, this.buildScale());
    return figure;
  }

  buildScale() {
    const scale = document.createElement("div");
    scale.className = "scale";
    const ticks = document.createElement("div");
    ticks.className = "ticks";
    const last = this.scale.ticks.length - 1;
    this.scale.ticks.forEach((tick, index) => {
      const label = document.createElement("span");
      label.textContent = index === last ? `${tick} %` : `${tick}`;
      label.style.left = `${100 * placeValue(this.scale, tick / 100)}%`;
      ticks.append(label);
    });
    const measure = document.createElement("p");
    measure.className = "hint";
    measure.textContent = this.scale.measure;
    scale.append(this.drawBar(), ticks, measure);
    return scale;
  }

  drawBar() {
    const bar = document.createElement("canvas");
    bar.setAttribute("aria-hidden", "true");
    bar.width = 256;
    bar.height = 1;
    const data = new Uint8ClampedArray(4 * bar.width).fill(255);
    for (let at = 0; at < bar.width; at++) {
      data.set(colourPlace(this.scale, at / (bar.width - 1)), 4 * at);
    }
    bar.getContext("2d").putImageData(new ImageData(data, bar.width, 1), 0, 0);
    return bar;
  }
}
