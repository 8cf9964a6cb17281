/** A face in a video, followed frame by frame (`tracker.py`). */

import { REGIONS, SENTENCES, STATES, TRACKER } from "../python_data.js";
import { fill } from "../sentences.js";
import { findMedian } from "../statistics.js";
import { findInterval } from "../uncertainty.js";
import { FaceFollower } from "./face_follower.js";
import { describeConstancy } from "./melanin_constancy.js";
import { makeBlank } from "./readings.js";
import { Shot } from "./shot.js";

const LEVEL = 0.9; // of the intervals

/** Reads hemoglobin over time, fed frame by frame; `choice` is the number of a face, or null. */
export class ClipTracker {
  constructor(networks, choice, baseline = TRACKER.BASELINE) {
    Object.assign(this, { networks, baseline, shot: null, shots: [], rests: [], spaces: [] });
    this.refusal = null;
    this.follower = new FaceFollower(networks, choice);
    this.notes = new Set();
    Object.assign(this, { number: 0, last: 0 });
  }

  /** Add the next frame. Returns the readings that are ready: all of a baseline at its end. */
  async add(frame, time) {
    const followed = await this.follower.follow(frame, time);
    const readings = followed.isCut ? await this.cut(time) : [];
    this.last = time;
    readings.push(...(await this.read(frame, time, followed)));
    this.number += 1;
    return readings;
  }

  /** Read the frames that waited. */
  finish() {
    return this.closeShot();
  }

  async read(frame, time, followed) {
    if (!this.shot) {
      const number = this.shots.length + 1;
      if (!followed.landmarks) return [makeBlank(this.number, time, number, STATES.LOST)];
      this.shot = new Shot(this.networks, number, time, this.baseline);
    }
    const readings = await this.shot.add(this.number, time, frame, followed);
    if (this.shot.isRefused && !this.rests.length) throw this.shot.refusal;
    return readings;
  }

  /** End the shot at a cut: another light and white balance may begin. */
  async cut(time) {
    const waiting = await this.closeShot();
    this.notes.add(fill(SENTENCES.cut, { time: time.toFixed(2) }));
    return waiting;
  }

  async closeShot() {
    const { shot } = this;
    if (!shot) return [];
    this.shot = null;
    const waiting = await shot.finish();
    if (!shot.rest) {
      this.noteRefusal(shot);
      return waiting;
    }
    shot.notes.forEach((note) => this.notes.add(note));
    this.keepShot(shot, shot.poolMelanin());
    return waiting;
  }

  noteRefusal({ refusal, start }) {
    if (!refusal) return;
    this.refusal ??= refusal;
    const values = { start: start.toFixed(2), refusal: refusal.message };
    this.notes.add(fill(SENTENCES.shotRefused, values));
  }

  keepShot({ number, start, rest, hemoglobin, space }, melanin) {
    this.shots.push({
      number,
      start: round(start),
      end: round(this.last),
      baseline: this.baseline.map((each) => round(start + each)),
      looks: rest.looks,
    });
    this.rests.push({ number, melanin, hemoglobin });
    this.spaces.push({ landmarks: space.landmarks, triangles: space.triangles, number });
  }

  /** Means of the regions with their intervals: melanin of all shots, hemoglobin of the first. */
  summarise() {
    if (!this.rests.length && this.refusal) throw this.refusal;
    if (!this.rests.length) throw new Error(fill(SENTENCES.noFace, { _number: this.number }));
    const shots = this.rests.map(({ number, melanin }) => ({ ...melanin, number }));
    const pool = (find) => REGIONS.NAMES.map((_, at) => {
      const known = shots.map((shot) => find(shot, at)).filter(Number.isFinite);
      return known.length ? findMedian(known) : NaN;
    });
    const means = pool((shot, at) => Math.log(shot.regions.means[at])).map(Math.exp);
    const sds = pool((shot, at) => shot.regions.sds[at]);
    return {
      melanin: this.describe("melanin", { means, sds }),
      melanin_constancy: describeConstancy(shots),
      resting_hemoglobin: this.describe("hemoglobin", this.rests[0].hemoglobin),
    };
  }

  describe(name, { means, sds }) {
    const [, top] = this.networks.outputs[name].range;
    return Object.fromEntries(
      REGIONS.NAMES.map((region, at) => [region, describeMean(means[at], sds[at], top)]),
    );
  }
}

function describeMean(mean, sd, top) {
  if (!Number.isFinite(mean)) return { mean: null, sd: null, interval: null, level: LEVEL };
  const digits = (value) => Number(value.toPrecision(6));
  const interval = findInterval(mean, sd, top).map(digits);
  return { mean: digits(mean), sd: digits(mean * sd), interval, level: LEVEL };
}

function round(seconds) {
  return Number(seconds.toFixed(3));
}
