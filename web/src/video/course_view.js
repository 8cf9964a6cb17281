/** The course of the regions over time, with the interval of the face. */

import { COURSE, INTERVAL, REGIONS } from "../python_data.js";
import { findPercentile } from "../statistics.js";
import { formatChange } from "./change_scale.js";

const HEIGHT = 320; // in pixels of CSS
const MARGINS = { left: 62, top: 10, right: 12, bottom: 30 };
const TICK = 110; // least distance between two labels of time

export class CourseView {
  /** Draws in a canvas, and calls `onTime(time)` where it is clicked. */
  constructor(canvas, onTime) {
    Object.assign(this, { canvas, time: 0, shown: new Set(REGIONS.NAMES) });
    new ResizeObserver(() => this.draw()).observe(canvas);
    this.plot = new OffscreenCanvas(1, 1); // all but the mark of the time
    canvas.addEventListener("click", (event) => {
      if (!this.box) return;
      const { left, right } = this.box;
      const x = event.clientX - canvas.getBoundingClientRect().left;
      const share = Math.min(1, Math.max(0, (x - left) / (right - left)));
      onTime(this.start + share * (this.end - this.start));
    });
  }

  setReadings(readings) {
    this.readings = readings;
    this.start = readings[0].time;
    this.end = Math.max(readings.at(-1).time, this.start + 1e-3);
    const ends = ({ change, changeSd }) =>
      [-1, 1].map((way) => change[0] + way * INTERVAL.QUANTILE * changeSd[0]);
    this.reach = Math.max(
      COURSE.SHOWN,
      1.1 * findReach(readings.flatMap(({ change }) => [...change])),
      1.05 * findReach(readings.flatMap(ends)),
    );
    this.canvas.setAttribute("aria-label", describeCourse(readings));
    this.draw();
  }

  setTime(time) {
    this.time = time;
    this.mark();
  }

  show(name, isShown) {
    if (isShown) this.shown.add(name);
    else this.shown.delete(name);
    this.draw();
  }

  x(time) {
    const { left, right } = this.box;
    return left + ((time - this.start) / (this.end - this.start)) * (right - left);
  }

  y(change) {
    const { top, bottom } = this.box;
    const share = Math.max(-1, Math.min(1, change / this.reach));
    return (top + bottom) / 2 - (share * (bottom - top)) / 2;
  }

  draw() {
    const { canvas, plot } = this;
    const width = canvas.clientWidth;
    if (!this.readings || !width) return;
    const { left, top, right, bottom } = MARGINS;
    this.box = { left, top, right: width - right, bottom: HEIGHT - bottom };
    this.density = globalThis.devicePixelRatio || 1;
    const [across, down] = [width, HEIGHT].map((side) => Math.round(side * this.density));
    Object.assign(canvas, { width: across, height: down });
    Object.assign(plot, { width: across, height: down });
    const context = plot.getContext("2d");
    context.scale(this.density, this.density);
    this.drawGrid(context);
    if (this.shown.has(REGIONS.FACE)) this.drawBand(context);
    REGIONS.NAMES.forEach((name, at) => {
      if (at && this.shown.has(name)) this.drawLine(context, at, toColour(name), 2);
    });
    if (this.shown.has(REGIONS.FACE)) this.drawLine(context, 0, readStyle(this.canvas, "--ink"), 3);
    this.mark();
  }

  /** Draw the plot, and mark the time that is shown. */
  mark() {
    const { canvas, plot, box, density } = this;
    if (!box) return;
    const context = canvas.getContext("2d");
    context.clearRect(0, 0, canvas.width, canvas.height);
    context.drawImage(plot, 0, 0);
    context.fillStyle = readStyle(canvas, "--accent");
    const [x, top, height] = [this.x(this.time) - 1, box.top, box.bottom - box.top];
    context.fillRect(...[x, top, 2, height].map((side) => side * density));
  }

  drawGrid(context) {
    const { left, right, bottom } = this.box;
    context.font = "13px system-ui, sans-serif";
    context.strokeStyle = readStyle(this.canvas, "--line");
    context.fillStyle = readStyle(this.canvas, "--soft");
    context.lineWidth = 1;
    Object.assign(context, { textAlign: "right", textBaseline: "middle" });
    for (const share of [-1, -0.5, 0, 0.5, 1]) {
      const y = this.y(share * this.reach);
      context.strokeRect(left, y, right - left, 0);
      context.fillText(formatChange(share * this.reach), left - 8, y);
    }
    context.textAlign = "center";
    const marks = Math.max(1, Math.floor((right - left) / TICK));
    for (let mark = 0; mark <= marks; mark++) {
      const time = this.start + (mark / marks) * (this.end - this.start);
      context.fillText(`${time.toFixed(1)} s`, Math.min(this.x(time), right - 14), bottom + 16);
    }
  }

  /** The interval of the face; it begins anew after frames that are not read. */
  drawBand(context) {
    context.fillStyle = readStyle(this.canvas, "--ink");
    context.globalAlpha = 0.16;
    for (const run of this.listRuns(0)) {
      const side = (reading, way) => {
        const change = reading.change[0] + way * INTERVAL.QUANTILE * reading.changeSd[0];
        return [this.x(reading.time), this.y(change)];
      };
      context.beginPath();
      run.forEach((reading) => context.lineTo(...side(reading, 1)));
      [...run].reverse().forEach((reading) => context.lineTo(...side(reading, -1)));
      context.fill();
    }
    context.globalAlpha = 1;
  }

  drawLine(context, region, colour, width) {
    Object.assign(context, { strokeStyle: colour, lineWidth: width, lineJoin: "round" });
    for (const run of this.listRuns(region)) {
      context.beginPath();
      run.forEach(({ time, change }) => context.lineTo(this.x(time), this.y(change[region])));
      context.stroke();
    }
  }

  /** Readings of a region one after the other, within one shot. */
  listRuns(region) {
    const runs = [[]];
    let shot = null;
    for (const reading of this.readings) {
      const isRead = Number.isFinite(reading.change[region]);
      if (!isRead || reading.shot !== shot) runs.push([]);
      if (isRead) runs.at(-1).push(reading);
      shot = reading.shot;
    }
    return runs.filter((run) => run.length);
  }
}

export function toColour(name) {
  return `rgb(${COURSE.COLOURS[name].join(" ")})`;
}

/** The smallest and the largest change of the face, in words. */
function describeCourse(readings) {
  const changes = readings.map(({ change }) => change[0]).filter(Number.isFinite);
  if (!changes.length) return "Change of hemoglobin over time: no frame could be read.";
  const [low, high] = [Math.min(...changes), Math.max(...changes)].map(formatChange);
  const seconds = (readings.at(-1).time - readings[0].time).toFixed(1);
  return `Change of hemoglobin over ${seconds} seconds: that of the face is between ${low} and ${high}.`;
}

function readStyle(element, name) {
  return getComputedStyle(element).getPropertyValue(name);
}

/** Size of the largest of some changes, but for single ones. */
function findReach(changes) {
  const sizes = changes.filter(Number.isFinite).map(Math.abs);
  return sizes.length ? findPercentile(sizes, 99.5) : 0;
}
