/**
 * Reads and changes ONNX files.
 *
 * The encoder takes what is known of the capture as optional inputs: inputs with an initial value.
 * onnxruntime-web can only feed inputs without one, so these values are taken out of the file.
 */

const GRAPH = 7; // fields of ModelProto
const METADATA = 14;
const INITIALIZER = 5; // of GraphProto
const TENSOR_NAME = 8; // of TensorProto

/** Metadata of a model file, by key. */
export function readMetadata(bytes) {
  const entries = {};
  for (const field of listFields(bytes)) {
    if (field.number !== METADATA) continue;
    const [key, value] = [1, 2].map((number) => readText(field.content, number));
    entries[key] = value;
  }
  return entries;
}

/** The file without the initial values whose names begin with a prefix. */
export function requireInputs(bytes, prefix) {
  const parts = [];
  for (const field of listFields(bytes)) {
    if (field.number !== GRAPH) {
      parts.push(bytes.subarray(field.start, field.end));
      continue;
    }
    const kept = [...listFields(field.content)].filter(
      (part) =>
        part.number !== INITIALIZER || !readText(part.content, TENSOR_NAME).startsWith(prefix),
    );
    const graph = kept.map((part) => field.content.subarray(part.start, part.end));
    parts.push(new Uint8Array([(GRAPH << 3) | 2, ...makeVarint(sumLengths(graph))]), ...graph);
  }
  return join(parts);
}

/** The fields of a message: number, place, and the content of those with a length. */
function* listFields(bytes) {
  let place = 0;
  while (place < bytes.length) {
    const start = place;
    const tag = readVarint(bytes, place);
    place = tag.end;
    const kind = tag.value & 7;
    let content = null;
    if (kind === 0) place = readVarint(bytes, place).end;
    else if (kind === 1) place += 8;
    else if (kind === 5) place += 4;
    else {
      const length = readVarint(bytes, place);
      place = length.end + length.value;
      content = bytes.subarray(length.end, place);
    }
    yield { number: Math.floor(tag.value / 8), start, end: place, content };
  }
}

function readText(bytes, number) {
  for (const field of listFields(bytes)) {
    if (field.number === number) return new TextDecoder().decode(field.content);
  }
  return "";
}

function readVarint(bytes, place) {
  let value = 0;
  let scale = 1;
  for (;;) {
    const byte = bytes[place++];
    value += (byte & 127) * scale;
    if (byte < 128) return { value, end: place };
    scale *= 128;
  }
}

function makeVarint(value) {
  const bytes = [];
  for (; value > 127; value = Math.floor(value / 128)) bytes.push((value % 128) | 128);
  return [...bytes, value];
}

function sumLengths(parts) {
  return parts.reduce((sum, part) => sum + part.length, 0);
}

function join(parts) {
  const joined = new Uint8Array(sumLengths(parts));
  let place = 0;
  for (const part of parts) {
    joined.set(part, place);
    place += part.length;
  }
  return joined;
}
