/** The part of the page that reads a clip, plays it with its map, and saves what was read. */

import { format, formatInterval } from "../value_table.js";
import { drawScale } from "./change_scale.js";
import { ClipPlayer } from "./clip_player.js";
import { CourseView } from "./course_view.js";
import { FaceQuestion } from "./face_question.js";
import { RegionTable } from "./region_table.js";
import { writeSummary, writeTable } from "./track_table.js";

const find = (id) => document.getElementById(id);

const NAMES = /\.(mp4|m4v|mov|webm|mkv|avi|mpe?g|3gp|ogv|ts|wmv)$/i;

const CANNOT_PLAY =
  "This browser cannot play the file, so that its map is not shown; course, table and files are whole.";

export function isClip(blob, name) {
  return blob.type.startsWith("video/") || (!blob.type && NAMES.test(name));
}

export class ClipPanel {
  /** `page` has `call`, `say`, `attempt`, `cancel` and `save`. */
  constructor(page) {
    Object.assign(this, { page, clip: null });
    const showTime = (time, reading) => {
      this.course.setTime(time);
      this.table.setReading(reading);
    };
    const note = () => find("clip-notes").append(makeItem(CANNOT_PLAY));
    this.player = new ClipPlayer(find("clip-player"), showTime, note);
    this.course = new CourseView(find("clip-course"), (time) => this.player.seek(time));
    this.table = new RegionTable(find("clip-regions").tBodies[0], (name, isShown) =>
      this.course.show(name, isShown),
    );
    this.question = new FaceQuestion(find("clip-faces"), (choice) => this.read({ choice }));
    this.listen();
    labelScale(find("clip-scale"));
  }

  listen() {
    find("clip-cancel").addEventListener("click", () => this.page.cancel());
    find("clip-shown").addEventListener("change", ({ target }) => this.player.show(target.checked));
    const opacity = find("clip-opacity");
    const setOpacity = () => this.player.setOpacity(opacity.value / 100);
    opacity.addEventListener("input", setOpacity);
    setOpacity();
    find("clip-again").addEventListener("submit", (event) => {
      event.preventDefault();
      this.read({});
    });
    find("save-table").addEventListener("click", () => this.save("csv", "text/csv", writeTable));
    find("save-summary").addEventListener("click", () =>
      this.save("json", "application/json", writeSummary),
    );
  }

  /** Open a video file. */
  open(blob, name) {
    Object.assign(this, { blob, name, choice: null });
    this.hide();
    find("clip").hidden = false;
    return this.track();
  }

  /** Read the clip again, with another face or baseline. */
  read({ choice = this.choice }) {
    this.choice = choice;
    return this.page.restart(() => this.track());
  }

  async track() {
    const { page, blob, name, choice } = this;
    this.showWork();
    page.say(`Reading ${name}…`);
    try {
      const baseline = [0, Number(find("clip-baseline").value)];
      const options = { blob, name, choice, baseline };
      const clip = await page.call("readClip", options, (progress) => this.showProgress(progress));
      if (clip.question) {
        page.say(clip.question);
        this.question.ask(clip);
      } else this.show(clip);
    } finally {
      if (blob === this.blob) find("clip-work").hidden = true;
    }
  }

  showWork() {
    this.question.hide();
    this.player.clear();
    find("clip-result").hidden = true;
    find("clip-progress").removeAttribute("value");
    find("clip-done").textContent = "";
    find("clip-work").hidden = false;
    this.begun = performance.now();
  }

  showProgress({ time, seconds, frames }) {
    const isKnown = seconds > 0;
    if (isKnown) find("clip-progress").value = Math.min(1, time / seconds);
    const spent = (performance.now() - this.begun) / 1000;
    const left = isKnown && time > 0.5 ? Math.ceil((spent * (seconds - time)) / time) : null;
    const rest = left === null ? "" : `, about ${Math.max(left, 0)} s left`;
    find("clip-done").textContent = `${time.toFixed(1)} s read, ${frames} frames${rest}`;
  }

  show(clip) {
    this.clip = clip;
    find("clip-result").hidden = false;
    this.player.setClip(this.blob, clip);
    this.course.setReadings(clip.readings);
    this.table.setReadings(clip.readings);
    this.table.setReading(clip.readings[0]);
    find("clip-notes").replaceChildren(...clip.notes.map(makeItem));
    const said = describe(clip);
    find("clip-summary").textContent = said;
    this.page.say(`Read ${clip.name}: ${said}`);
  }

  hide() {
    this.clip = null;
    this.question.hide();
    this.player.clear();
    find("clip").hidden = true;
    find("clip-work").hidden = true;
    find("clip-result").hidden = true;
  }

  save(suffix, type, write) {
    if (!this.clip) return;
    const stem = this.clip.name.replace(/\.[^.]*$/, "") || "clip";
    const content = suffix === "csv" ? write(this.clip.readings) : write(this.clip);
    this.page.save(new Blob([content], { type }), `${stem}_track.${suffix}`);
  }
}

function describe({ readings, summary }) {
  const seconds = (readings.at(-1).time - readings[0].time).toFixed(1);
  const means = [["melanin", summary.melanin], ["hemoglobin at rest", summary.resting_hemoglobin]]
    .filter(([, { face }]) => face.mean !== null)
    .map(([title, { face }]) => `${title} ${format(face.mean)} (${formatInterval(face.interval)})`);
  return `${[`${seconds} s`, `${readings.length} frames`, ...means].join(", ")}.`;
}

function makeItem(note) {
  const item = document.createElement("li");
  item.textContent = note;
  return item;
}

function labelScale(element) {
  const ticks = drawScale(element.querySelector("canvas")).map(([place, text]) => {
    const label = document.createElement("span");
    label.textContent = text;
    label.style.left = `${100 * place}%`;
    return label;
  });
  element.querySelector(".ticks").append(...ticks);
}
