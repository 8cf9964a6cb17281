/** The frames of a video file one by one, with their time stamps, decoded by the browser. */

import { FILES, SENTENCES } from "../python_data.js";
import { makeRaster } from "../raster.js";
import { fill } from "../sentences.js";

export const MOST_SECONDS = 120; // what is kept of each frame to play the map takes memory
const MOST_FRAMES = 3600;
const MOST_PACKETS = 200; // by which the compression is judged
const MOST_PIXELS = 9e6; // of a frame
/** Colours of files that do not say theirs, as FFmpeg has them: BT.601 with levels from 16 to 235. */
const UNTOLD = {
  primaries: "smpte170m", transfer: "smpte170m", matrix: "smpte170m", fullRange: false,
};

const COMMAND = "the command skinnet track reads it at any length";

/** A video that is open; close it in the end. */
export class ClipFrames {
  /** Open a file; throws a sentence if its frames cannot be read. */
  static async open(blob, name) {
    if (!globalThis.VideoDecoder) {
      throw new Error(
        "This browser gives no access to the frames of videos (WebCodecs). Use a newer one, open " +
          "the page from this computer or by HTTPS, or use the command skinnet track.",
      );
    }
    const media = await importMedia();
    const source = new media.BlobSource(blob);
    const input = new media.Input({ source, formats: media.ALL_FORMATS });
    try {
      const track = await findTrack(input, name);
      const seconds = await input.getDurationFromMetadata([track]);
      refuseLong(name, seconds);
      const isTold = Boolean((await track.getColorSpace()).matrix);
      const sink = new media.VideoSampleSink(track);
      const frames = new ClipFrames({
        input, sink, name, seconds, isTold, Sample: media.VideoSample,
      });
      frames.notes.push(...(await noteCompression(track, name)));
      return frames;
    } catch (error) {
      input.dispose();
      throw error;
    }
  }

  constructor(parts) {
    Object.assign(this, parts, { notes: [], isComplete: true, first: null });
    this.canvas = new OffscreenCanvas(1, 1);
    this.context = this.canvas.getContext("2d", { willReadFrequently: true });
  }

  /** Frames {frame, time}, upright, from 0 seconds on; time stamps that go back are left out. */
  async *[Symbol.asyncIterator]() {
    let [last, count, dropped] = [-1, 0, 0];
    for await (const sample of this.decode()) {
      this.first ??= sample.timestamp;
      const time = sample.timestamp - this.first;
      const isLate = time > last;
      const frame = isLate ? await this.convert(sample) : null;
      sample.close();
      if (!isLate) {
        dropped += 1;
        continue;
      }
      if (time > MOST_SECONDS || count >= MOST_FRAMES) {
        this.stop(last);
        break;
      }
      [last, count] = [time, count + 1];
      yield { frame, time };
    }
    if (dropped) {
      this.notes.push(`${dropped} frames of ${this.name} whose time stamps go back were left out.`);
    }
  }

  /** Decoded samples; what comes before a damaged part is kept. */
  async *decode() {
    let isRead = false;
    try {
      for await (const sample of this.sink.samples()) {
        isRead = true;
        yield sample;
      }
    } catch (error) {
      if (!isRead) {
        throw new Error(`The frames of ${this.name} cannot be decoded (${error.message}).`);
      }
      this.isComplete = false;
      this.notes.push(`${this.name} is broken (${error.message}). What came before is read.`);
    }
  }

  /** A sample's pixels; browsers differ in the colours of files that do not say theirs. */
  async convert(sample) {
    const isKnown = this.isTold || !["I420", "NV12"].includes(sample.format);
    if (isKnown) return this.draw(sample);
    const { format, codedWidth, codedHeight, rotation, timestamp } = sample;
    const data = new Uint8Array(sample.allocationSize());
    const layout = await sample.copyTo(data);
    const told = new this.Sample(data, {
      format, codedWidth, codedHeight, rotation, timestamp, layout, colorSpace: UNTOLD,
    });
    const frame = this.draw(told);
    told.close();
    return frame;
  }

  draw(sample) {
    const { canvas, context } = this;
    const [width, height] = [sample.displayWidth, sample.displayHeight];
    if (width * height > MOST_PIXELS) {
      throw new Error(
        `The frames of ${this.name} have ${width} × ${height} pixels, and at most ` +
          `${MOST_PIXELS / 1e6} million are read here; make them smaller, or use skinnet track.`,
      );
    }
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
    sample.draw(context, 0, 0, width, height);
    const { data } = context.getImageData(0, 0, width, height);
    return makeRaster(data, width, height, 4);
  }

  stop(last) {
    this.isComplete = false;
    this.notes.push(
      `${this.name} is longer than the page reads: it was read to ${last.toFixed(1)} s; ${COMMAND}.`,
    );
  }

  close() {
    this.input.dispose();
  }
}

/** Say that a video is compressed strongly, by the first of its packets. */
async function noteCompression(track, name) {
  const { averageBitrate, averagePacketRate } = await track.computePacketStats(MOST_PACKETS);
  const pixels = (await track.getCodedWidth()) * (await track.getCodedHeight());
  const bits = averageBitrate / averagePacketRate / pixels;
  return bits < FILES.LEAST_BITS ? [fill(SENTENCES.compressed, { name, bits: bits.toFixed(3) })] : [];
}

/** The library that takes files apart; it is only loaded for videos. */
async function importMedia() {
  try {
    return await import("../../runtime/mediabunny.min.mjs");
  } catch {
    throw new Error(
      "This page lacks Mediabunny, which opens videos. In a checkout, make runtime fetches it; or " +
        "install skinnet anew, from a wheel.",
    );
  }
}

async function findTrack(input, name) {
  const track = await findVideo(input, name);
  if (!track) throw new Error(`${name} has no picture, only sound or data; give a video.`);
  const codec = (await track.getCodec()) ?? "unknown";
  if (!(await track.canDecode())) {
    throw new Error(
      `This browser cannot decode ${name} (its codec is ${codec}). Convert it to H.264, such as by ` +
        `ffmpeg -i ${name} -c:v libx264 -crf 12 clip.mp4, or use the command skinnet track.`,
    );
  }
  return track;
}

async function findVideo(input, name) {
  try {
    return await input.getPrimaryVideoTrack();
  } catch {
    throw new Error(
      `${name} is no video that this page can read; give a file such as MP4, MOV or WebM.`,
    );
  }
}

function refuseLong(name, seconds) {
  if (!(seconds > MOST_SECONDS)) return;
  throw new Error(
    `${name} lasts ${Math.round(seconds)} seconds, and at most ${MOST_SECONDS} are read here; cut ` +
      `it, or ${COMMAND}.`,
  );
}
