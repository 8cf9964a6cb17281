/** The page: opens a photograph or a clip, shows what is read of it, and edits a photograph. */

import { paintLine } from "./brush.js";
import { Camera } from "./camera.js";
import { SCALES } from "./colour_scales.js";
import { EditPanel } from "./edit_panel.js";
import { MapView } from "./map_view.js";
import { PictureView } from "./picture_view.js";
import { Latest, Reader } from "./reader.js";
import { ValueTable, describeReading, describeValues, readValues } from "./value_table.js";
import { ClipPanel, isClip } from "./video/clip_panel.js";

const find = (id) => document.getElementById(id);

const HELP = {
  probe: "Move over the photograph or a map to read values. With the keyboard: arrow keys, with " +
    "Shift in larger steps.",
  white: "Click on something white or grey that is lit as the face is, such as paper or a wall. " +
    "With the keyboard: arrow keys, then Enter.",
  paint: "Paint where the edit is to be; without paint it is all over the skin. With the keyboard: " +
    "arrow keys, then Enter.",
  box: "Draw a square around a face, from the brows to the chin. With the keyboard: arrow keys " +
    "move it, plus and minus resize it, Enter reads it.",
};

const SHOWN_MAPS = Object.keys(SCALES);

/** Another photograph or clip was opened before the worker answered. */
class Superseded extends Error {}

class Page {
  constructor() {
    this.reader = new Reader();
    this.generation = 0;
    this.picture = new PictureView(find("photo"), {
      onPoint: (point, isByKey) => this.setPoint(point, isByKey),
      onPick: (point) => this.pickWhite({ x: point[0], y: point[1] }),
      onMark: (box) => this.readBox(box),
      onDivide: (share) => this.divide(share),
      onPaint: (from, to, isDone) => this.paint(from, to, isDone),
    });
    this.maps = SHOWN_MAPS.map((name) => new MapView(name, (point) => this.setPoint(point, false)));
    find("map-grid").append(...this.maps.map((map) => map.element));
    this.table = new ValueTable(find("values").tBodies[0]);
    this.editing = new Latest((factors) => this.edit(factors), find("photo"));
    this.panel = new EditPanel(find("sliders"), find("undo"), find("reset"), (factors) =>
      this.attempt(() => this.editing.run(factors)),
    );
    this.clip = new ClipPanel(this);
    this.listen();
    this.setTool("probe");
    this.attempt(async () => {
      await this.reader.call("open", {});
      if (!this.generation) this.say("Ready: choose a photograph or a clip, or try the sample.");
    });
  }

  listen() {
    find("file").addEventListener("change", ({ target }) => {
      if (target.files[0]) this.open(target.files[0], target.files[0].name);
      target.value = "";
    });
    const camera = new Camera(find("camera"), (blob, name) => this.open(blob, name));
    find("use-camera").addEventListener("click", () => this.attempt(() => camera.open()));
    find("sample").addEventListener("click", () => this.openSample());
    find("faces").addEventListener("change", ({ target }) => this.readFace(Number(target.value)));
    find("brush").addEventListener("input", () => this.showPaint());
    find("clear-white").addEventListener("click", () => this.pickWhite(null));
    find("divider").addEventListener("input", ({ target }) =>
      this.picture.setShare(target.value / 100),
    );
    find("tools").addEventListener("change", ({ target }) => this.setTool(target.value));
    find("zoom").addEventListener("change", ({ target }) => this.zoom(target.checked));
    find("save-photo").addEventListener("click", () => this.savePhoto());
    find("save-maps").addEventListener("click", () => this.saveMaps());
    find("edit").addEventListener("submit", (event) => event.preventDefault());
    addEventListener("paste", ({ clipboardData }) => this.openFirst(clipboardData.files));
    addEventListener("keydown", (event) => {
      if ((event.ctrlKey || event.metaKey) && event.key === "z") this.panel.goBack();
    });
    this.listenToDrops();
  }

  listenToDrops() {
    const show = (isShown) => { find("drop").hidden = !isShown; };
    addEventListener("dragover", (event) => { event.preventDefault(); show(true); });
    addEventListener("dragleave", (event) => { if (!event.relatedTarget) show(false); });
    addEventListener("drop", (event) => {
      event.preventDefault();
      show(false);
      this.openFirst(event.dataTransfer.files);
    });
  }

  openFirst(files) {
    if (files.length) this.open(files[0], files[0].name);
  }

  openSample() {
    return this.attempt(async () => {
      const response = await fetch("samples/astronaut.png");
      if (!response.ok) throw new Error("The sample is missing; start the page again.");
      await this.open(await response.blob(), "astronaut.png");
    });
  }

  /** Open a photograph or a clip. */
  open(blob, name) {
    const isVideo = isClip(blob, name);
    return this.restart(() => (isVideo ? this.openClip(blob, name) : this.openPhoto(blob, name)));
  }

  /** Begin something else than what is read now. */
  restart(action) {
    this.generation += 1;
    this.cancel();
    return this.attempt(action);
  }

  cancel() {
    this.reader.cancel();
  }

  openClip(blob, name) {
    find("work").hidden = true;
    find("maps").hidden = true;
    Object.assign(this, { photo: null, reading: null, white: null, read: null, faces: [] });
    return this.clip.open(blob, name);
  }

  async openPhoto(blob, name) {
    this.clip.hide();
    this.say(`Reading ${name}…`);
    const photo = await this.call("readPhoto", { blob, name });
    Object.assign(this, { photo, reading: null, white: null, read: null, faces: [] });
    this.readByItself = null;
    find("face-choice").hidden = true;
    this.zoom(false);
    this.histories = new Map();
    this.panel.setHistory([]);
    this.picture.setPhoto(photo);
    find("work").hidden = false;
    find("maps").hidden = true;
    find("clear-white").hidden = true;
    this.say("Looking for faces…");
    await this.readLargest(true);
    await this.readLargest(false);
    if (!this.faces.length) {
      this.chooseTool("box");
      throw new Error(`No face was found in ${name}. Mark one by a square around it.`);
    }
  }

  /** Find faces, at a glance first, and read the largest unless it is read already. */
  async readLargest(isQuick) {
    const { faces, largest } = await this.call("findFaces", { isQuick });
    if (isQuick && !faces.length) return;
    const isRead = this.reading !== null;
    const isSame = faces.length === this.faces.length;
    const chosen = isRead ? findSame(faces, this.read[1].face ?? {}) : largest;
    this.faces = faces;
    this.listFaces(faces, chosen);
    const isLeft = this.read === this.readByItself;
    if (isRead) this.showNotes();
    if (!faces.length || (isRead && isSame) || (isRead && !isLeft)) return;
    this.zoom(true);
    await this.readFace(largest);
    this.readByItself = this.read;
  }

  listFaces(faces, largest) {
    this.picture.setFaces(faces, largest);
    const options = faces.map((_, index) => new Option(`${index + 1} of ${faces.length}`, index));
    find("faces").replaceChildren(...options);
    if (largest >= 0) find("faces").value = largest;
    find("face-choice").hidden = faces.length < 2;
  }

  readFace(index) {
    return this.readBy(() => {
      this.picture.setFaces(this.faces, index);
      return ["readFace", { face: this.faces[index] }];
    });
  }

  readBox(box) {
    return this.readBy(() => {
      this.chooseTool("probe");
      return ["readBox", { box }];
    });
  }

  pickWhite(white) {
    return this.attempt(async () => {
      const former = this.white;
      this.white = white;
      try {
        if (this.read) await this.readAgain();
      } catch (error) {
        this.white = former;
        throw error;
      }
      find("clear-white").hidden = !white;
      if (white) this.chooseTool("probe");
    });
  }

  readBy(choose) {
    return this.attempt(async () => {
      const former = this.read;
      this.read = choose();
      try {
        await this.readAgain();
      } catch (error) {
        this.read = former;
        throw error;
      }
    });
  }

  /** Read what was chosen last, with the white that was picked. */
  async readAgain() {
    this.say("Reading the skin…");
    const [call, options] = this.read;
    const reading = await this.call(call, { ...options, white: this.white });
    this.showReading(reading);
    await this.editing.run(this.panel.factors);
    this.say(describeReading(this.photo.name, reading, this.white !== null));
  }

  showReading(reading) {
    this.reading = reading;
    find("maps").hidden = false;
    this.maps.forEach((map) => map.setReading(reading));
    this.table.setReading(reading);
    this.picture.setReading(reading);
    if (!this.histories.has(reading.key)) this.histories.set(reading.key, []);
    this.panel.setHistory(this.histories.get(reading.key));
    this.showNotes();
  }

  showNotes() {
    const notes = [...this.reading.notes, ...noteOthers(this.faces.length, this.photo.name)];
    find("notes").replaceChildren(
      ...notes.map((note) => {
        const item = document.createElement("li");
        item.textContent = note;
        return item;
      }),
    );
  }

  setPoint(point, isByKey) {
    this.picture.setPoint(point);
    if (!this.reading) return;
    this.table.setPoint(point);
    this.maps.forEach((map) => map.setPoint(point));
    if (isByKey) this.say(describeValues(readValues(this.reading, point)));
  }

  paint(from, to, isDone) {
    if (!this.reading) return;
    const { paint } = this.panel.factors;
    this.panel.setPaint(paintLine(paint, this.reading, from, to, this.radius), isDone);
  }

  /** Radius of the brush in pixels of the photograph. */
  get radius() {
    const { left, right } = this.reading.box;
    return (find("brush").value / 200) * (right - left);
  }

  showPaint() {
    if (!this.reading) return;
    this.picture.setPaint(this.radius, this.panel.factors.paint?.values, this.reading.width);
  }

  async edit(factors) {
    if (!this.reading) return;
    this.showPaint();
    const { key } = this.reading;
    const head = await this.call("edit", { factors });
    if (key === this.reading.key) this.picture.setEdited(head);
  }

  zoom(isZoomed) {
    find("zoom").checked = isZoomed;
    this.picture.setZoom(isZoomed);
  }

  divide(share) {
    find("divider").value = 100 * share;
    this.picture.setShare(share);
  }

  setTool(tool) {
    this.picture.setTool(tool);
    find("brush-size").hidden = tool !== "paint";
    this.showPaint();
    find("tool-help").textContent = HELP[tool];
  }

  chooseTool(tool) {
    document.querySelector(`#tools [value=${tool}]`).checked = true;
    this.setTool(tool);
  }

  savePhoto() {
    return this.attempt(async () => {
      if (!this.reading) throw new Error("Nothing is read yet; mark a face first.");
      const blob = await this.call("writePhoto", { factors: this.panel.factors });
      save(blob, `${removeSuffix(this.photo.name)}_edited.png`);
    });
  }

  saveMaps() {
    return this.attempt(async () => {
      save(await this.call("writeMaps", {}), `${removeSuffix(this.photo.name)}_maps.zip`);
    });
  }

  /** Call the worker; what it answers is not for a photograph that was opened meanwhile. */
  async call(name, options, onProgress = () => {}) {
    const { generation } = this;
    const isCurrent = () => generation === this.generation;
    try {
      const result = await this.reader.call(name, options, (progress) => {
        if (isCurrent()) onProgress(progress);
      });
      if (isCurrent()) return result;
    } catch (error) {
      if (isCurrent()) throw error;
    }
    throw new Superseded();
  }

  save(blob, name) {
    save(blob, name);
  }

  say(sentence) {
    find("status").textContent = sentence;
  }

  /** Run an action, and show its error as a sentence. */
  async attempt(action) {
    find("error").hidden = true;
    try {
      await action();
    } catch (error) {
      if (error instanceof Superseded) return;
      this.say("");
      find("error").textContent = error.message;
      find("error").hidden = false;
    }
  }
}

/** The number of a face among others; -1 if it is none of them. */
function findSame(faces, { box }) {
  return faces.findIndex((face) => box && face.box.left === box.left && face.box.top === box.top);
}

/** Say that there are other faces, and how they are read. */
function noteOthers(count, name) {
  if (count < 2) return [];
  const [faces, it] = count === 2 ? ["face was", "it"] : ["faces were", "another"];
  return [`${count - 1} more ${faces} found in ${name}; choose ${it} at “Face”.`];
}

function save(blob, name) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

function removeSuffix(name) {
  return name.replace(/\.[^.]*$/, "") || "photograph";
}

new Page();
