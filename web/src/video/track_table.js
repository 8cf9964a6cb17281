/** The readings as a table and a summary, with the names of `skinnet track` (`_track_files.py`). */

import { REGIONS, SENTENCES, TRACK_TABLE } from "../python_data.js";
import { findInterval } from "../uncertainty.js";

const { FIELDS } = TRACK_TABLE;

/** Columns of the table; those of the pulse are missing, which the page does not compute. */
const COLUMNS = [
  "frame", "time", "shot", "state", "gain",
  ...REGIONS.NAMES.flatMap((name) => FIELDS.map((field) => `${name}_${field}`)),
];

/** The table of readings as a CSV file. */
export function writeTable(readings) {
  const rows = readings.map((reading) => {
    const { number, time, shot, state, gain } = reading;
    const regions = REGIONS.NAMES.flatMap((_, at) => Object.values(describeRegion(reading, at)));
    const numbers = [gain[0], ...regions].map((value) => round(value) ?? "");
    return [number, time.toFixed(6), shot, state, ...numbers].join(",");
  });
  return `${[COLUMNS.join(","), ...rows].join("\n")}\n`;
}

/** The summary as JSON, with all rows as `series`; without pulse and events. */
export function writeSummary(clip) {
  const { name, isComplete, readings, summary, notes, shots, model } = clip;
  const frames = { read: 0, lost: 0, hidden: 0 };
  readings.forEach(({ state }) => { frames[state] += 1; });
  const about = {
    file: name,
    complete: isComplete,
    seconds: Number((readings.at(-1).time - readings[0].time).toFixed(3)),
    frames, shots, ...summary, notes, model,
    disclaimer: SENTENCES.disclaimer,
    series: readings.map(describeRow),
  };
  return `${JSON.stringify(about, null, 2)}\n`;
}

function describeRow(reading) {
  const regions = REGIONS.NAMES.map((name, at) => [
    name,
    Object.fromEntries(
      Object.entries(describeRegion(reading, at)).map(([field, value]) => [field, round(value)]),
    ),
  ]);
  return {
    frame: reading.number,
    time: Number(reading.time.toFixed(6)),
    shot: reading.shot,
    state: reading.state,
    gain: round(reading.gain[0]),
    regions: Object.fromEntries(regions),
  };
}

/** The fields of a region, in the order of the columns. */
function describeRegion({ change, changeSd, hemoglobin, logSd }, at) {
  const [low, high] = findInterval(hemoglobin[at], logSd[at], Infinity);
  const values = [hemoglobin[at], low, high, change[at], changeSd[at]];
  return Object.fromEntries(FIELDS.map((field, place) => [field, values[place]]));
}

/** Six significant digits; null for what is not read. */
function round(value) {
  return Number.isFinite(value) ? Number(value.toPrecision(6)) : null;
}
