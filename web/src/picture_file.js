/** Picture files: what they are, how large, and their pixels. Pixels are turned as EXIF says. */

import { makeRaster } from "./raster.js";

const MOST_BYTES = 200e6;
const MOST_PIXELS = 50e6; // of which the browser needs 4 bytes each, several times
const LEAST_SIDE = 32;

/** Decode a file to a raster of red, green, blue and alpha; throws a sentence if it cannot be. */
export async function readPicture(blob, name) {
  if (blob.size > MOST_BYTES) {
    throw new Error(
      `${name} has ${Math.round(blob.size / 1e6)} MB, and at most ${MOST_BYTES / 1e6} are read; ` +
        "give a smaller picture.",
    );
  }
  const head = new Uint8Array(await blob.slice(0, 1 << 18).arrayBuffer());
  if (!head.length) throw new Error(`${name} is empty; choose a photograph.`);
  const size = measure(head);
  if (size) checkSize(name, ...size);
  const bitmap = await decode(blob, name);
  checkSize(name, bitmap.width, bitmap.height);
  const canvas = new OffscreenCanvas(bitmap.width, bitmap.height);
  const context = canvas.getContext("2d", { willReadFrequently: true });
  context.fillStyle = "white"; // behind transparent pixels, as viewers have it
  context.fillRect(0, 0, canvas.width, canvas.height);
  context.drawImage(bitmap, 0, 0);
  bitmap.close();
  const { data } = context.getImageData(0, 0, canvas.width, canvas.height);
  return makeRaster(data, canvas.width, canvas.height, 4);
}

async function decode(blob, name) {
  try {
    return await createImageBitmap(blob);
  } catch {
    throw new Error(
      `${name} is not a picture that this browser can read; give a JPEG, PNG or WebP file.`,
    );
  }
}

function checkSize(name, width, height) {
  if (width * height > MOST_PIXELS) {
    throw new Error(
      `${name} has ${width} × ${height} pixels, and at most ${MOST_PIXELS / 1e6} million are ` +
        "read here; make it smaller, or use the skinnet command.",
    );
  }
  if (Math.min(width, height) < LEAST_SIDE) {
    throw new Error(`${name} has only ${width} × ${height} pixels; give a larger picture.`);
  }
}

/** Width and height by the beginning of a file, before its pixels take memory; null: not known. */
function measure(bytes) {
  const view = new DataView(bytes.buffer);
  const text = (start, length) => String.fromCharCode(...bytes.subarray(start, start + length));
  if (bytes.length < 30) return null;
  if (text(1, 3) === "PNG") return [view.getUint32(16), view.getUint32(20)];
  if (text(0, 3) === "GIF") return [view.getUint16(6, true), view.getUint16(8, true)];
  if (text(0, 2) === "BM") return [view.getInt32(18, true), Math.abs(view.getInt32(22, true))];
  if (text(0, 4) === "RIFF" && text(12, 4) === "VP8X") {
    const read = (at) => 1 + bytes[at] + 256 * bytes[at + 1] + 65536 * bytes[at + 2];
    return [read(24), read(27)];
  }
  return bytes[0] === 0xff && bytes[1] === 0xd8 ? measureJpeg(bytes, view) : null;
}

/** The size in the first start-of-frame segment. */
function measureJpeg(bytes, view) {
  let place = 2;
  while (place + 9 < bytes.length && bytes[place] === 0xff) {
    const kind = bytes[place + 1];
    const isFrame = kind >= 0xc0 && kind <= 0xcf && ![0xc4, 0xc8, 0xcc].includes(kind);
    if (isFrame) return [view.getUint16(place + 7), view.getUint16(place + 5)];
    place += 2 + view.getUint16(place + 2);
  }
  return null;
}
