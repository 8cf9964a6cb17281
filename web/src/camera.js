/** The camera, in a dialog: shows what it sees, and takes a photograph or a clip. */

import { ClipRecorder } from "./clip_recorder.js";

const MOST = { width: { ideal: 1920 }, height: { ideal: 1440 } };

export class Camera {
  /** Calls `onTake(blob, name)`. */
  constructor(dialog, onTake) {
    Object.assign(this, { dialog, onTake, video: dialog.querySelector("video"), stream: null });
    dialog.querySelector("[value=take]").addEventListener("click", () => this.take());
    this.button = dialog.querySelector("[value=record]");
    this.button.hidden = !ClipRecorder.isPossible;
    this.button.addEventListener("click", () => this.record());
    dialog.querySelector("[value=cancel]").addEventListener("click", () => dialog.close());
    dialog.addEventListener("close", () => this.stop());
  }

  /** Open the dialog; throws a sentence if there is no camera. */
  async open() {
    try {
      const video = { facingMode: "user", ...MOST };
      this.stream = await navigator.mediaDevices.getUserMedia({ video, audio: false });
    } catch {
      throw new Error("No camera can be used; allow it in the browser, or choose a file.");
    }
    this.video.srcObject = this.stream;
    this.dialog.showModal();
    await this.video.play();
  }

  async take() {
    const { videoWidth, videoHeight } = this.video;
    if (!videoWidth) return; // nothing is seen yet
    const canvas = new OffscreenCanvas(videoWidth, videoHeight);
    canvas.getContext("2d").drawImage(this.video, 0, 0);
    const blob = await canvas.convertToBlob({ type: "image/png" });
    this.dialog.close();
    this.onTake(blob, "camera.png");
  }

  /** Record a clip, or end it. */
  record() {
    if (this.recorder) {
      this.recorder.stop();
      return;
    }
    this.recorder = new ClipRecorder(this.stream, (blob, name) => {
      this.recorder = null;
      this.dialog.close();
      this.onTake(blob, name);
    });
    this.button.textContent = "Stop recording";
  }

  stop() {
    this.recorder?.drop();
    this.recorder = null;
    this.button.textContent = "Record a clip";
    this.stream?.getTracks().forEach((track) => track.stop());
    this.stream = null;
    this.video.srcObject = null;
  }
}
