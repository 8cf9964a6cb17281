/** A clip that plays, with the map of each frame laid over it in step. */

import { unpackLandmarks, unpackTexture } from "./clip_bytes.js";
import { drawOverlay } from "./face_overlay.js";

const SIDE = 560; // longer side, in pixels, of the map over the clip

export class ClipPlayer {
  /** Calls `onTime(time, reading)` with each frame that is shown, and `onFault` if it cannot play. */
  constructor(element, onTime, onFault) {
    Object.assign(this, { element, onTime, onFault, clip: null, isShown: true });
    this.canvas = element.querySelector("canvas");
    this.video = null;
  }

  /** A player of one clip, which comes and goes with it. */
  build() {
    const video = document.createElement("video");
    Object.assign(video, { id: "clip-video", controls: true, loop: true, muted: true });
    video.playsInline = true;
    video.setAttribute("aria-label", "The clip");
    const show = () => this.draw(video.currentTime);
    const events = ["seeked", "loadeddata", ...(video.requestVideoFrameCallback ? [] : ["timeupdate"])];
    for (const event of events) video.addEventListener(event, show);
    video.addEventListener("error", () => { if (this.clip) this.onFault(); });
    this.video = video;
    this.element.prepend(video);
    if (video.requestVideoFrameCallback) this.wait(video);
  }

  wait(video) {
    video.requestVideoFrameCallback((_, { mediaTime }) => {
      if (video !== this.video) return;
      this.draw(mediaTime);
      this.wait(video);
    });
  }

  setClip(blob, clip) {
    this.clear();
    this.build();
    this.clip = clip;
    const scale = Math.min(1, SIDE / Math.max(...clip.size));
    [this.canvas.width, this.canvas.height] = clip.size.map((side) => Math.round(side * scale));
    this.fit(clip.size);
    this.address = URL.createObjectURL(blob);
    this.video.src = this.address;
    if (matchMedia("(prefers-reduced-motion: reduce)").matches) return;
    this.video.play().catch(() => {}); // the user can start it
  }

  /** Give the player the form of the frames, so that the map lies over them. */
  fit([width, height]) {
    const { style } = this.element;
    style.aspectRatio = `${width} / ${height}`;
    style.width = `min(100%, 36rem, calc(70vh * ${width / height}))`;
  }

  clear() {
    this.clip = null;
    this.video?.pause();
    this.video?.remove();
    this.video = null;
    if (this.address) URL.revokeObjectURL(this.address);
    this.address = null;
  }

  /** Move to a time of the readings. */
  seek(time) {
    if (this.video) this.video.currentTime = time + this.clip.start + 1e-4;
  }

  setOpacity(share) {
    this.canvas.style.opacity = share;
  }

  show(isShown) {
    this.isShown = isShown;
    if (this.video) this.draw(this.video.currentTime);
  }

  draw(mediaTime) {
    const { canvas, clip } = this;
    if (!clip) return;
    const time = mediaTime - clip.start;
    const reading = findReading(clip.readings, time);
    const context = canvas.getContext("2d");
    context.clearRect(0, 0, canvas.width, canvas.height);
    const space = clip.spaces.find(({ number }) => number === reading.shot);
    if (this.isShown && reading.texture && space) {
      const image = context.createImageData(canvas.width, canvas.height);
      const scale = canvas.width / clip.size[0];
      const landmarks = unpackLandmarks(reading.landmarks, scale);
      drawOverlay(image, space, landmarks, unpackTexture(reading.texture));
      context.putImageData(image, 0, 0);
    }
    this.onTime(time, reading);
  }
}

/** The last reading that is not after a time; half a millisecond is rounding. */
function findReading(readings, time) {
  let [low, high] = [0, readings.length];
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (readings[middle].time <= time + 5e-4) low = middle;
    else high = middle;
  }
  return readings[low];
}
