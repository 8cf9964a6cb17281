/** One shot of a video, between two cuts: its baseline, resting maps and readings (`_shot.py`). */

import { placeFace, toBox } from "../face_place.js";
import { CHANGE_SCALE, FRAME_NOISE, SHOT, STATES, TRACKER } from "../python_data.js";
import { clamp } from "../rounding.js";
import { Refusal } from "../sentences.js";
import { BloodResponse } from "./blood_response.js";
import { ChangeMap } from "./change_map.js";
import { ColourTable } from "./colour_table.js";
import { sampleFrame } from "./frame_colours.js";
import { FrameComparison } from "./frame_comparison.js";
import { LookSeries } from "./look_series.js";
import { add, makeIdentity, scale } from "./matrices.js";
import { makeBlank } from "./readings.js";
import { poolLooks, readLook } from "./resting_maps.js";
import { RunningNoise } from "./running_noise.js";
import { SlowErrors } from "./slow_errors.js";
import { TextureSpace } from "./texture_space.js";
import { ToneDoubt } from "./tone_curve.js";

const PIGMENTS = ["melanin", "hemoglobin"];

export class Shot {
  /** Reads the frames of a shot that starts at a time; `baseline` is its first and last second. */
  constructor(networks, number, start, baseline) {
    Object.assign(this, { networks, number, start, baseline, space: null, rest: null });
    Object.assign(this, { waiting: [], looks: [], notes: [], doubt: new ToneDoubt() });
    this.series = new LookSeries();
    Object.assign(this, { refusal: null, isRefused: false }); // why no frame of it could be read
  }

  /** Add a frame. Returns the readings that are ready: all of the baseline at its end. */
  async add(number, time, frame, { landmarks, bend }) {
    if (this.isRefused) return [makeBlank(number, time, this.number, STATES.HIDDEN)];
    const colours = landmarks && this.sample(frame, landmarks);
    if (!this.rest && colours) await this.look(frame, time, landmarks);
    const one = { number, time, colours, bend, landmarks };
    if (this.rest) {
      if (colours && this.series.isDue(time)) await this.lookAgain(frame, time, landmarks);
      return [this.read(one)];
    }
    if (this.waiting.length < SHOT.MOST_BUFFERED) this.waiting.push(one);
    const isKnown = this.looks.length || this.refusal;
    return isKnown && time - this.start >= this.baseline[1] ? this.finish() : [];
  }

  /** End the baseline now. Returns the readings of the frames that waited. */
  async finish() {
    const { waiting } = this;
    this.waiting = [];
    if (!this.rest && this.looks.length) await this.begin(waiting);
    if (this.rest) return waiting.map((one) => this.read(one));
    this.isRefused = this.refusal !== null;
    const state = this.isRefused ? STATES.HIDDEN : STATES.LOST;
    return waiting.map(({ number, time }) => makeBlank(number, time, this.number, state));
  }

  sample(frame, landmarks) {
    this.space ??= TextureSpace.fromLandmarks(landmarks);
    return sampleFrame(frame, this.space, landmarks);
  }

  /** Let the network read the frame, if it is time for another look. */
  async look(frame, time, landmarks) {
    const [begin, end] = this.baseline;
    const gap = (end - begin) / Math.max(TRACKER.LOOKS - 1, 1);
    const due = begin + this.looks.length * gap;
    if (time - this.start < due - 1e-6 || this.looks.length >= TRACKER.LOOKS) return;
    const look = await this.attempt(frame, time, landmarks);
    if (look) this.looks.push({ ...look, time });
  }

  /** Read a frame; null if it cannot be read, such as a face that is too small. */
  async attempt(frame, time, landmarks) {
    try {
      return await this.readLook(frame, time, landmarks);
    } catch (error) {
      if (!(error instanceof Refusal)) throw error;
      this.refusal = error;
      return null;
    }
  }

  readLook(frame, time, landmarks) {
    const square = placeFace(landmarks);
    const face = { box: toBox(square), tilt: (square.tilt * 180) / Math.PI, landmarks };
    return readLook(this.networks, frame, face, this.space, `the frame at ${time.toFixed(2)} s`);
  }

  /** Read melanin once more; readings that were given do not depend on it. */
  async lookAgain(frame, time, landmarks) {
    this.series.postpone(time);
    const look = await this.attempt(frame, time, landmarks);
    if (look) this.addMelanin(time, look);
  }

  addMelanin(time, { maps }) {
    const [face] = this.comparison.lists;
    const share = face.length ? face.reduce((sum, at) => sum + maps.mask[at], 0) / face.length : 0;
    this.series.add(time, maps.melanin, share);
  }

  /** Melanin of all looks of the shot, and of its regions. */
  poolMelanin() {
    const [face] = this.comparison.lists;
    const pooled = this.series.pool(face.length ? face : [...this.space.places.keys()]);
    return { ...pooled, regions: this.average(pooled.texels, 0) };
  }

  /** Set the baseline, and the answer of the regions to blood. */
  async begin(waiting) {
    const { space, networks } = this;
    this.notes = this.looks.flatMap((look) => look.notes);
    this.rest = poolLooks(this.looks);
    this.comparison = new FrameComparison(this.chooseBase(waiting), this.rest.skin, space.regions);
    this.looks.forEach((look) => this.addMelanin(look.time, look));
    this.series.start(this.looks.at(-1).time);
    const top = PIGMENTS.map((name) => networks.outputs[name].range[1]);
    const table = await ColourTable.make(networks, this.rest.capture, top);
    this.melanin = this.average(this.rest.melanin, 0);
    this.hemoglobin = this.average(this.rest.hemoglobin, 1);
    const { regions } = this.comparison;
    this.responses = regions.map((texels) => new BloodResponse(table, this.rest, texels));
    this.scaleSd = this.findScaleSd(table);
    this.map = new ChangeMap(space, this.rest, this.comparison, table);
    this.noises = regions.map(() => new RunningNoise());
    this.slow = new SlowErrors(regions, space.places);
    this.learnNoise(waiting);
    this.looks = [];
  }

  /** Colours of the frames of the baseline; of all that wait if the face is in none of it. */
  chooseBase(waiting) {
    const [begin, end] = this.baseline;
    const seen = waiting.filter(({ colours }) => colours);
    const chosen = seen.filter(({ time }) => begin <= time - this.start && time - this.start <= end);
    return (chosen.length ? chosen : seen).map(({ colours }) => colours);
  }

  /** Relative standard deviations of changes, by those of the resting maps. */
  findScaleSd(table) {
    return this.comparison.regions.map((texels, region) => {
      const own = findOwnScale(this.melanin.means[region]);
      const parts = [this.melanin, this.hemoglobin].map(({ sds }, pigment) => {
        const [less, more] = [-1, 1].map((way) => {
          const factors = [1, 1];
          factors[pigment] = Math.exp(way * sds[region]);
          return new BloodResponse(table, this.rest, texels, factors).measureChroma();
        });
        return Math.log(more / less) / 2;
      });
      return Math.hypot(own, ...parts);
    });
  }

  /** Learn the noise from the baseline; its spread shows slow errors of the compression. */
  learnNoise(waiting) {
    const rows = waiting
      .filter(({ colours }) => colours)
      .map(({ time, colours }) => this.learn(time, this.comparison.compare(colours)));
    this.noiseFactors = this.noises.map(({ covariance }, region) =>
      compareSpreads(rows.map((ratios) => ratios[region]), covariance),
    );
  }

  /** Learn noise and slow errors from a frame that was compared; returns its ratios. */
  learn(time, { ratios, texels, seen }) {
    this.noises.forEach((noise, region) => noise.add(time, ratios[region]));
    this.slow.add(time, texels, seen);
    return ratios;
  }

  read({ number, time, colours, bend, landmarks }) {
    if (!colours) return makeBlank(number, time, this.number, STATES.LOST);
    const compared = this.comparison.compare(colours);
    const { ratios } = compared;
    if (ratios[0].some(Number.isNaN)) return makeBlank(number, time, this.number, STATES.HIDDEN);
    // A frame of the baseline is learnt from already.
    if (time > this.noises[0].time) this.learn(time, compared);
    const gloss =
      SHOT.GLOSS_SD + SHOT.GLOSS_BY_BEND * bend ** 2 + SHOT.GLOSS_BY_SHADING * spreadShading(ratios);
    const found = ratios.map((ratio, region) => this.solve(region, ratio, bend, gloss));
    const reading = makeBlank(number, time, this.number, STATES.READ);
    found.forEach((one, region) => {
      if (one) this.fill(reading, region, one);
    });
    return { ...reading, landmarks, texture: this.map.draw(compared, found[0].gain) };
  }

  /** Solve for the change of a region; null if it is hidden. */
  solve(region, ratios, bend, gloss) {
    if (ratios.some(Number.isNaN)) return null;
    const covariance = add(
      scale(this.noises[region].covariance, this.noiseFactors[region]),
      this.slow.findCovariance(region),
      makeIdentity((FRAME_NOISE.CHROMA_BY_BEND * bend) ** 2),
      // Red answers least to blood, so that its ratio tells how much light there is.
      this.doubt.findCovariance(this.comparison.levels[region], ratios[0]),
    );
    return this.responses[region].solve(ratios, covariance, gloss);
  }

  fill(reading, region, { change, sd, gain }) {
    reading.change[region] = change;
    reading.noiseSd[region] = sd;
    reading.changeSd[region] = Math.hypot(sd, this.scaleSd[region] * change);
    reading.hemoglobin[region] = this.hemoglobin.means[region] * Math.exp(change);
    reading.logSd[region] = Math.hypot(this.hemoglobin.sds[region], reading.changeSd[region]);
    reading.gain[region] = Math.exp(gain);
  }

  /** Means of a pigment in the regions, and the standard deviations of their logarithms. */
  average(texels, pigment) {
    const face = this.rest.faceSd[pigment];
    const share = this.networks.regionShare[pigment];
    const mean = (list, find) => list.reduce((sum, at) => sum + find(at), 0) / list.length;
    const { lists } = this.comparison;
    const sds = lists.map((list) => {
      const pixels = list.length ? mean(list, (at) => this.rest.pixelSd[pigment][at] ** 2) : 0;
      return Math.sqrt(face ** 2 + share * Math.max(pixels - face ** 2, 0));
    });
    sds[0] = face;
    return { means: lists.map((list) => mean(list, (at) => texels[at])), sds };
  }
}

/** Relative standard deviation of a change where melanin is as much: what is not known of skins. */
function findOwnScale(melanin) {
  const darkness = Math.log(Math.max(melanin, 1e-3) / 0.1);
  const [less, more] = CHANGE_SCALE.SCALE_BY_TONE;
  return Math.min(CHANGE_SCALE.SCALE_SD + (darkness < 0 ? -less : more) * darkness, CHANGE_SCALE.MOST_SCALE_SD);
}

/** Standard deviation over the regions of their gain: exposure is common to all. */
function spreadShading(ratios) {
  const known = ratios.slice(1).map(([red]) => red).filter(Number.isFinite);
  if (known.length < 2) return 0;
  const mean = known.reduce((sum, one) => sum + one, 0) / known.length;
  return Math.sqrt(known.reduce((sum, one) => sum + (one - mean) ** 2, 0) / known.length);
}

/** Variance of a region's chroma in a baseline over that of its noise, at least 1. */
function compareSpreads(ratios, noise) {
  const seen = ratios.filter((one) => one.every(Number.isFinite));
  if (seen.length <= 5) return 1;
  const means = [0, 1, 2].map((at) => seen.reduce((sum, one) => sum + one[at], 0) / seen.length);
  const whole = means.map((_, row) =>
    means.map((_, column) => {
      const product = (one) => (one[row] - means[row]) * (one[column] - means[column]);
      return seen.reduce((sum, one) => sum + product(one), 0) / (seen.length - 1);
    }),
  );
  return clamp(measureChroma(whole) / measureChroma(noise), 1, FRAME_NOISE.MOST_FACTOR);
}

/** Variance of what channels do not share. */
function measureChroma(covariance) {
  const trace = covariance[0][0] + covariance[1][1] + covariance[2][2];
  const sum = covariance.flat().reduce((total, value) => total + value, 0);
  return Math.max(trace - sum / 3, 1e-12);
}

