/** The table of values: means over the skin, and values at the point. */

import { findInterval } from "./uncertainty.js";

const ROWS = {
  melanin: "Melanin",
  hemoglobin: "Hemoglobin",
  shading: "Shading",
  specular: "Specular",
  mask: "Is skin",
};

const LEAST_SKIN = 0.1; // mask below which a place has no values

export class ValueTable {
  constructor(body) {
    this.cells = {};
    for (const [name, title] of Object.entries(ROWS)) {
      const row = body.insertRow();
      const head = document.createElement("th");
      head.scope = "row";
      head.textContent = title;
      row.append(head);
      this.cells[name] = [row.insertCell(), row.insertCell()];
    }
  }

  setReading(reading) {
    this.reading = reading;
    for (const name of ["melanin", "hemoglobin"]) {
      const found = reading.means[name];
      fill(this.cells[name][0], found ? [found.mean, found.interval] : null);
    }
    this.setPoint(null);
  }

  /** Show the values at a point of the photograph. */
  setPoint(point) {
    const values = point && this.reading ? readValues(this.reading, point) : {};
    for (const name of Object.keys(ROWS)) fill(this.cells[name][1], values[name] ?? null);
  }
}

/** Values at a point, {name: [value, interval]}; empty outside, and only the mask off skin. */
export function readValues({ planes, width, height, box }, [x, y]) {
  const column = Math.floor(((x - box.left) / (box.right - box.left)) * width);
  const row = Math.floor(((y - box.top) / (box.bottom - box.top)) * height);
  if (column < 0 || row < 0 || column >= width || row >= height) return {};
  const at = row * width + column;
  const mask = [planes.mask[at]];
  if (mask[0] < LEAST_SKIN) return { mask };
  const withInterval = (name) => {
    const value = planes[name][at];
    return [value, findInterval(value, planes[`${name}_sd`][at], 1)];
  };
  return {
    melanin: withInterval("melanin"),
    hemoglobin: withInterval("hemoglobin"),
    shading: [planes.shading[at]],
    specular: [planes.specular[at]],
    mask,
  };
}

/** A sentence of what was read. */
export function describeReading(name, { means }, isWhiteKnown) {
  if (!means.melanin) return `No skin was found in the face of ${name}.`;
  const values = ["melanin", "hemoglobin"].map((pigment) => {
    const { mean, interval } = means[pigment];
    return `${pigment} ${format(mean)} (${formatInterval(interval)})`;
  });
  const how = isWhiteKnown ? ", with the white that you picked" : "";
  return `Read ${name}${how}: ${values.join(", ")}.`;
}

/** A sentence of what the table says at a point. */
export function describeValues(values) {
  if (!values.mask) return "Outside of what is read.";
  if (!values.melanin) return "No skin here.";
  return ["melanin", "hemoglobin"]
    .map((name) => `${ROWS[name]} ${format(values[name][0])}, ${formatInterval(values[name][1])}`)
    .join("; ");
}

function fill(cell, found) {
  cell.replaceChildren();
  if (!found) {
    cell.textContent = "–";
    return;
  }
  const [value, interval] = found;
  cell.append(format(value));
  if (!interval) return;
  const small = document.createElement("small");
  small.textContent = `(${formatInterval(interval)})`;
  cell.append(small);
}

export function format(share) {
  return `${formatNumber(share)} %`;
}

export function formatInterval([low, high]) {
  return `${formatNumber(low)} to ${formatNumber(high)} %`;
}

function formatNumber(share) {
  const number = 100 * share;
  return number < 9.95 ? number.toFixed(1) : number.toFixed(0);
}
