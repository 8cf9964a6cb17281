/** Sliders of an edit and its paint, with undo. */

import { UNCHANGED, isUnchanged } from "./editing.js";

const FACTOR = 5; // largest factor of a pigment; the smallest is its inverse

const times = (value) => `${value.toFixed(2)} ×`;
const percent = (value) => `${Math.round(100 * value)} %`;
const power = { read: (place) => FACTOR ** (place / 100), place: (value) =>
  (100 * Math.log(value)) / Math.log(FACTOR), range: [-100, 100], format: times };
const linear = (end) => ({ read: (place) => place / 100, place: (value) => 100 * value,
  range: [0, 100 * end], format: percent });

const SLIDERS = {
  melanin: { label: "Melanin", ...power },
  hemoglobin: { label: "Hemoglobin", ...power },
  shading: { label: "Shading contrast", ...linear(2) },
  shine: { label: "Shine", ...linear(3) },
};

export class EditPanel {
  /** Calls `onChange(factors)` while a slider moves. */
  constructor(container, undo, reset, onChange) {
    Object.assign(this, { undo, reset, onChange, history: [{ ...UNCHANGED }], sliders: {} });
    for (const [name, slider] of Object.entries(SLIDERS)) {
      container.append(this.build(name, slider));
    }
    undo.addEventListener("click", () => this.goBack());
    reset.addEventListener("click", () => this.restore({ ...UNCHANGED }));
    this.show({ ...UNCHANGED });
  }

  /** The history of edits of one face; an empty one begins anew. */
  setHistory(history) {
    if (!history.length) history.push({ ...UNCHANGED });
    this.history = history;
    this.show({ ...history[history.length - 1] });
  }

  goBack() {
    if (this.history.length < 2) return;
    this.history.pop();
    this.show({ ...this.history[this.history.length - 1] });
    this.onChange(this.factors);
  }

  restore(factors) {
    this.history.push(factors);
    this.show({ ...factors });
    this.onChange(this.factors);
  }

  /** Change where the edit is; `isDone` at the end of a stroke. */
  setPaint(paint, isDone) {
    this.factors = { ...this.factors, paint };
    if (isDone) this.history.push({ ...this.factors });
    this.enable();
    this.onChange(this.factors);
  }

  build(name, { label, read, range }) {
    const row = document.createElement("label");
    row.className = "slider";
    const text = document.createElement("span");
    const output = document.createElement("output");
    const input = document.createElement("input");
    Object.assign(input, { type: "range", id: name, min: range[0], max: range[1], step: 1 });
    text.append(label, output);
    row.append(text, input);
    input.addEventListener("input", () => {
      this.factors = { ...this.factors, [name]: read(Number(input.value)) };
      this.label(name);
      this.onChange(this.factors);
    });
    input.addEventListener("change", () => {
      this.history.push({ ...this.factors });
      this.enable();
    });
    this.sliders[name] = { input, output };
    return row;
  }

  show(factors) {
    this.factors = factors;
    for (const [name, { place }] of Object.entries(SLIDERS)) {
      this.sliders[name].input.value = place(factors[name]);
      this.label(name);
    }
    this.enable();
  }

  label(name) {
    const text = SLIDERS[name].format(this.factors[name]);
    this.sliders[name].output.textContent = text;
    this.sliders[name].input.setAttribute("aria-valuetext", text);
    this.enable();
  }

  enable() {
    this.undo.disabled = this.history.length < 2;
    this.reset.disabled = isUnchanged(this.factors) && !this.factors.paint;
  }
}
