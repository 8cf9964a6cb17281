/** The page's side of the worker: calls by name, which answer later. */

export class Reader {
  constructor() {
    this.worker = new Worker(new URL("worker.js", import.meta.url), { type: "module" });
    this.waiting = new Map();
    this.count = 0;
    this.worker.onmessage = ({ data: { id, result, error, progress } }) => {
      const { resolve, reject, onProgress } = this.waiting.get(id);
      if (progress) {
        onProgress(progress);
        return;
      }
      this.waiting.delete(id);
      if (error === undefined) resolve(result);
      else reject(new Error(error));
    };
    this.worker.onerror = () => {
      const error = new Error("The networks cannot run in this browser; use a newer one.");
      this.waiting.forEach(({ reject }) => reject(error));
      this.waiting.clear();
    };
  }

  /** Call by name; `onProgress` hears of it meanwhile, if the call reports any. */
  call(name, options, onProgress = () => {}) {
    const id = this.count++;
    return new Promise((resolve, reject) => {
      this.waiting.set(id, { resolve, reject, onProgress });
      this.worker.postMessage({ id, name, options });
    });
  }

  /** End the clips that are being read; what was read of them is kept. */
  cancel() {
    this.worker.postMessage({ id: this.count - 1, name: "cancel" });
  }
}

/**
 * Runs one action at a time, and then the latest of those that were asked for meanwhile. An element
 * is marked as busy until then.
 */
export class Latest {
  constructor(action, element) {
    this.action = action;
    this.element = element;
    this.isBusy = false;
    this.next = null;
  }

  async run(...values) {
    if (this.isBusy) {
      this.next = values;
      return;
    }
    this.isBusy = true;
    this.element.setAttribute("aria-busy", "true");
    try {
      await this.action(...values);
      while (this.next) {
        const later = this.next;
        this.next = null;
        await this.action(...later);
      }
    } finally {
      this.isBusy = false;
      this.next = null;
      this.element.removeAttribute("aria-busy");
    }
  }
}
