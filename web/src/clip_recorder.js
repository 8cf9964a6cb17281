/** Records a clip of what the camera sees. */

const MOST_SECONDS = 60;
const BITS = 16e6; // a second: strong compression hides blood

/** Records a stream until it is stopped, or a minute has passed. */
export class ClipRecorder {
  static get isPossible() {
    return Boolean(globalThis.MediaRecorder);
  }

  /** Calls `onEnd(blob, name)` with the clip. */
  constructor(stream, onEnd) {
    const parts = [];
    this.recorder = new MediaRecorder(stream, { videoBitsPerSecond: BITS });
    this.recorder.addEventListener("dataavailable", ({ data }) => parts.push(data));
    this.recorder.addEventListener("stop", () => {
      clearTimeout(this.timer);
      const [type] = this.recorder.mimeType.split(";");
      if (!this.isDropped) onEnd(new Blob(parts, { type }), `camera.${type.split("/")[1]}`);
    });
    this.recorder.start(1000);
    this.timer = setTimeout(() => this.stop(), 1000 * MOST_SECONDS);
  }

  stop() {
    if (this.recorder.state !== "inactive") this.recorder.stop();
  }

  /** Stop, and forget what was recorded. */
  drop() {
    this.isDropped = true;
    this.stop();
  }
}
