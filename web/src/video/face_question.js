/** Asks which of several faces of a frame is meant. */

export class FaceQuestion {
  /** Calls `onChoose(number)`, from 0, with the face that was chosen. */
  constructor(element, onChoose) {
    Object.assign(this, { element, onChoose });
  }

  ask({ view, faces, scale }) {
    const canvas = document.createElement("canvas");
    canvas.setAttribute("aria-hidden", "true");
    Object.assign(canvas, { width: view.width, height: view.height });
    const pixels = new ImageData(new Uint8ClampedArray(view.data), view.width, view.height);
    canvas.getContext("2d").putImageData(pixels, 0, 0);
    const buttons = faces.map((face, at) => this.buildButton(face, at, faces.length, view, scale));
    this.element.replaceChildren(canvas, ...buttons);
    this.element.hidden = false;
    buttons[0].focus();
  }

  hide() {
    this.element.replaceChildren();
    this.element.hidden = true;
  }

  buildButton({ left, top, right, bottom }, at, count, view, scale) {
    const button = document.createElement("button");
    button.type = "button";
    button.textContent = String(at + 1);
    button.setAttribute("aria-label", `Face ${at + 1} of ${count}, from left to right`);
    const percent = (length, whole) => `${(100 * length * scale) / whole}%`;
    button.style.left = percent(left, view.width);
    button.style.top = percent(top, view.height);
    button.style.width = percent(right - left, view.width);
    button.style.height = percent(bottom - top, view.height);
    button.addEventListener("click", () => {
      this.hide();
      this.onChoose(at);
    });
    return button;
  }
}
