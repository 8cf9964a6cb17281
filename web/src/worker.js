/** The worker: reads photographs while the page stays alive. Calls are answered one by one. */

import { openNetworks } from "./networks.js";
import { PhotoSession, makeFace } from "./photo_session.js";
import { readPicture } from "./picture_file.js";
import { ClipSession } from "./video/clip_session.js";

const opening = openNetworks(new URL("..", self.location.href));
opening.catch(() => {}); // the first call reports it

let session = null;
let lastCancelled = -1; // clips that were asked for up to this call are cancelled

const CALLS = {
  async open() {
    await opening;
  },

  async readPhoto({ blob, name }) {
    const photo = await readPicture(blob, name);
    session = new PhotoSession(await opening, photo, name);
    return session.describePhoto();
  },

  async readClip({ blob, name, choice, baseline }, id) {
    session = null;
    const report = (progress) => self.postMessage({ id, progress });
    const clip = new ClipSession(await opening, report, () => id <= lastCancelled);
    return clip.read(blob, name, choice, baseline);
  },

  findFaces({ isQuick }) {
    return session.findFaces(isQuick);
  },

  readFace({ face, white }) {
    return session.read(face, white);
  },

  readBox({ box, white }) {
    return session.read(makeFace(box), white);
  },

  edit({ factors }) {
    return session.editView(factors);
  },

  writePhoto({ factors }) {
    return session.writePhoto(factors);
  },

  writeMaps() {
    return session.writeMaps();
  },
};

let queue = Promise.resolve();

self.onmessage = ({ data: { id, name, options } }) => {
  if (name === "cancel") {
    lastCancelled = id;
    return;
  }
  queue = queue.then(() => answer(id, name, options));
  if (name.startsWith("read")) queue = queue.then(prepare);
};

/** Prepare the edits of what was read; an edit itself reports what goes wrong. */
async function prepare() {
  await session?.reading?.prepareEdits().catch(() => {});
}

async function answer(id, name, options) {
  try {
    self.postMessage({ id, result: await CALLS[name](options ?? {}, id) });
  } catch (error) {
    self.postMessage({ id, error: error.message });
  }
}
