/** The table of regions: their change at the time that is shown, and their largest one. */

import { INTERVAL, REGIONS } from "../python_data.js";
import { findPercentile } from "../statistics.js";
import { formatChange, formatChanges } from "./change_scale.js";
import { toColour } from "./course_view.js";

const { QUANTILE } = INTERVAL;

export class RegionTable {
  /** Calls `onShow(name, isShown)` where the line of a region is switched. */
  constructor(body, onShow) {
    this.cells = REGIONS.NAMES.map((name) => {
      const row = body.insertRow();
      const head = document.createElement("th");
      head.scope = "row";
      head.append(buildSwitch(name, onShow));
      row.append(head);
      return [row.insertCell(), row.insertCell()];
    });
  }

  setReadings(readings) {
    this.cells.forEach(([, largest], at) => {
      largest.textContent = describeLargest(readings, at);
    });
  }

  /** Show the changes of a reading. */
  setReading({ change, changeSd }) {
    this.cells.forEach(([now], at) => {
      now.replaceChildren(...describeChange(change[at], changeSd[at]));
    });
  }
}

function buildSwitch(name, onShow) {
  const label = document.createElement("label");
  label.className = "check region";
  const box = document.createElement("input");
  Object.assign(box, { type: "checkbox", checked: true });
  box.addEventListener("change", () => onShow(name, box.checked));
  const swatch = document.createElement("span");
  swatch.className = "swatch";
  if (name !== REGIONS.FACE) swatch.style.backgroundColor = toColour(name);
  label.append(box, swatch, nameRegion(name));
  return label;
}

function nameRegion(name) {
  const words = name.replace("_", " ");
  return words[0].toUpperCase() + words.slice(1);
}

/** A change with its interval of 90 %, as nodes. */
function describeChange(change, sd) {
  if (!Number.isFinite(change)) return ["not seen"];
  const interval = document.createElement("small");
  interval.textContent = formatChanges(change - QUANTILE * sd, change + QUANTILE * sd);
  return [formatChange(change), interval];
}

/** The largest change of a region and its time, but for one frame in a hundred. */
function describeLargest(readings, at) {
  const known = readings.filter(({ change }) => Number.isFinite(change[at]));
  if (!known.length) return "not seen";
  const sizes = known.map(({ change }) => Math.abs(change[at]));
  const most = findPercentile(sizes, 99);
  const { change, time } = known[sizes.findIndex((size) => size >= most)];
  return `${formatChange(change[at])} at ${time.toFixed(1)} s`;
}
