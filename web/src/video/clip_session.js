/** One clip in the worker: it is read frame by frame, with progress, until it ends or is cancelled. */

import { SENTENCES, STATES } from "../python_data.js";
import { fill } from "../sentences.js";
import { resize } from "../resizing.js";
import { packReading } from "./clip_bytes.js";
import { ClipFrames } from "./clip_frames.js";
import { ClipTracker } from "./clip_tracker.js";
import { SeveralFaces } from "./face_follower.js";
import { findLeastChange, noteLeastChange } from "./least_change.js";
import { StillImage } from "./still_image.js";

const VIEW = 1024; // longest side, in pixels, of the frame in which a face is chosen

export class ClipSession {
  /** Calls `onProgress({time, seconds, frames})` after each frame, unless `isCancelled()`. */
  constructor(networks, onProgress, isCancelled) {
    Object.assign(this, { networks, onProgress, isCancelled });
  }

  /** Read a clip: its readings; or {faces, view} if it shows several, and `choice` is null. */
  async read(blob, name, choice, baseline) {
    const frames = await ClipFrames.open(blob, name);
    try {
      return await this.track(frames, name, new ClipTracker(this.networks, choice, baseline));
    } finally {
      frames.close();
    }
  }

  async track(frames, name, tracker) {
    const readings = [];
    const still = new StillImage();
    let size = null;
    for await (const { frame, time } of frames) {
      if (this.isCancelled()) break;
      size ??= [frame.width, frame.height];
      still.add(frame, time);
      try {
        readings.push(...(await tracker.add(frame, time)).map(packReading));
      } catch (error) {
        if (error instanceof SeveralFaces) return askWhich(error, frame);
        throw error;
      }
      this.onProgress({ time, seconds: frames.seconds, frames: tracker.number });
      await new Promise((resume) => setTimeout(resume)); // so that a cancel is heard
    }
    if (!tracker.number && this.isCancelled()) throw new Error("It was cancelled before any frame.");
    if (!tracker.number) throw new Error(`${name} has no frames that can be read.`);
    if (still.isStill && !this.isCancelled()) refuseStill(name);
    readings.push(...(await tracker.finish()).map(packReading));
    return this.describe(frames, name, tracker, readings, size);
  }

  describe(frames, name, tracker, readings, size) {
    const least = findLeastChange(readings);
    const summary = { ...tracker.summarise(), least_change: least };
    const notes = [...tracker.notes, ...noteLeastChange(least), ...frames.notes];
    const lost = readings.filter(({ state }) => state === STATES.LOST).length;
    if (lost) notes.push(fill(SENTENCES.framesWithoutFace, { lost, value: readings.length }));
    if (this.isCancelled()) notes.push("It was cancelled; what was read before is shown.");
    const { version, optics, trainedOn } = this.networks;
    return {
      name, size, readings, summary, notes,
      isComplete: frames.isComplete && !this.isCancelled(),
      start: frames.first,
      shots: tracker.shots,
      spaces: tracker.spaces,
      model: { version, trained_on: trainedOn, optics },
    };
  }
}

function refuseStill(name) {
  throw new Error(
    `All frames of ${name} are the same but for compression: it is a still image, in which nothing ` +
      "changes over time; give a photograph to read it.",
  );
}

/** The faces of a frame, and the frame as the page shows it. */
function askWhich({ message, faces }, frame) {
  const scale = Math.min(1, VIEW / Math.max(frame.width, frame.height));
  const [width, height] = [frame.width, frame.height].map((side) => Math.round(side * scale));
  const view = scale < 1 ? resize(frame, width, height) : frame;
  return { question: message, faces: faces.map(({ box }) => box), view, scale };
}
