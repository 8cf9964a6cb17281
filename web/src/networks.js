/** The networks, run by ONNX Runtime Web in WebAssembly; the files are those of the Python package. */

import * as ort from "../runtime/ort.wasm.bundle.min.mjs";
import { readMetadata, requireInputs } from "./onnx_file.js";

const FILES = {
  face_detector: "models/face_detector.onnx",
  face_mesh: "models/face_mesh.onnx",
  encoder: "models/skin.onnx",
  decoder: "models/skin.decoder.onnx",
};

const FORMAT = "2"; // of the inputs, outputs and metadata that this page knows

const MOST_THREADS = 4;

/** What may be known of a capture, and the number of values; NaN is what is not known. */
const KNOWN = {
  light: 9, temperature: 0, camera: 6, white_balance: 2, linear: 0, exposure: 0,
};

export const MAP_NAMES = ["melanin", "hemoglobin", "shading", "specular", "offset"];
export const CAPTURE_NAMES = ["light", "temperature", "camera", "white_balance"];
const SD_NAMES = ["melanin_sd", "hemoglobin_sd"];

/** Open all networks of a page whose address is `root`. */
export async function openNetworks(root) {
  const fetched = Object.entries(FILES).map(async ([name, file]) => [
    name,
    await fetchBytes(new URL(file, root)),
  ]);
  const isolated = globalThis.crossOriginIsolated;
  ort.env.wasm.numThreads = isolated ? Math.min(MOST_THREADS, navigator.hardwareConcurrency) : 1;
  ort.env.wasm.wasmBinary = await fetchRuntime(root);
  ort.env.logLevel = "error";
  const sessions = {};
  let metadata = {};
  for (const each of fetched) {
    const [name, bytes] = await each;
    if (name === "encoder") metadata = readMetadata(bytes);
    sessions[name] = await openSession(name, bytes);
  }
  return new Networks(sessions, metadata);
}

/** The WebAssembly, which is kept compressed. */
async function fetchRuntime(root) {
  const { body } = await fetchFile(new URL("runtime/ort-wasm-simd-threaded.wasm.gz", root));
  return new Response(body.pipeThrough(new DecompressionStream("gzip"))).arrayBuffer();
}

async function fetchBytes(address) {
  return new Uint8Array(await (await fetchFile(address)).arrayBuffer());
}

async function fetchFile(address) {
  const response = await fetch(address);
  if (!response.ok) {
    throw new Error(`${address.pathname} is missing (${response.status}); start the page again.`);
  }
  return response;
}

function openSession(name, bytes) {
  const content = name === "encoder" ? requireInputs(bytes, "known_") : bytes;
  // Optimising the mesh takes longer than it saves; Python leaves it as it is, too.
  const graphOptimizationLevel = name === "face_mesh" ? "disabled" : "all";
  return ort.InferenceSession.create(content, {
    executionProviders: ["wasm"],
    graphOptimizationLevel,
  });
}

class Networks {
  constructor(sessions, metadata) {
    if (metadata["skinnet.format"] !== FORMAT) {
      throw new Error("The model files are of another version than this page; install both anew.");
    }
    this.sessions = sessions;
    this.workingSize = Number(metadata["skinnet.working_size"]);
    this.version = metadata["skinnet.version"];
    this.trainedOn = metadata["skinnet.trained_on"];
    this.optics = metadata["skinnet.optics"];
    this.outputs = JSON.parse(metadata["skinnet.outputs"]);
    this.regionShare = JSON.parse(metadata["skinnet.region_share"]);
  }

  /** Outputs of a network, by name, for inputs [values, shape]. */
  async run(name, inputs) {
    const feeds = {};
    for (const [input, [values, shape]] of Object.entries(inputs)) {
      const type = values instanceof Uint8Array ? "uint8" : "float32";
      feeds[input] = new ort.Tensor(type, values, shape);
    }
    const results = await this.sessions[name].run(feeds);
    return Object.fromEntries(Object.entries(results).map(([key, tensor]) => [key, tensor.data]));
  }

  /** Maps and capture of a cut, red, green and blue; `known` is what is known of the capture. */
  async encode(cut, known = {}) {
    const inputs = { image: [cut.data, [1, cut.height, cut.width, 3]] };
    for (const [name, count] of Object.entries(KNOWN)) {
      const values = known[name] ?? Array(count || 1).fill(NaN);
      inputs[`known_${name}`] = [Float32Array.from(values), count ? [1, count] : [1]];
    }
    const outputs = await this.run("encoder", inputs);
    const select = (names) => Object.fromEntries(names.map((name) => [name, outputs[name]]));
    return {
      planes: { ...select(["melanin", "hemoglobin", "shading", "specular", "mask", ...SD_NAMES]),
        ...splitOffset(outputs.offset) },
      capture: select(CAPTURE_NAMES),
      faceSd: Array.from(outputs.face_sd),
    };
  }

  /** The photograph that planes [height, width] make, display sRGB in [0, 1], [height, width, 3]. */
  async decode(planes, capture, width, height) {
    const inputs = {};
    const shape = [1, height, width];
    for (const name of ["melanin", "hemoglobin", "shading", "specular"]) {
      inputs[name] = [planes[name], shape];
    }
    inputs.offset = [joinOffset(planes), [...shape, 3]];
    const shapes = { light: [1, 9], temperature: [1], camera: [1, 6], white_balance: [1, 2] };
    for (const name of CAPTURE_NAMES) inputs[name] = [capture[name], shapes[name]];
    return (await this.run("decoder", inputs)).image;
  }
}

const OFFSETS = ["offset_r", "offset_g", "offset_b"];

function splitOffset(offset) {
  const split = (channel) =>
    Float32Array.from({ length: offset.length / 3 }, (_, at) => offset[3 * at + channel]);
  return Object.fromEntries(OFFSETS.map((name, channel) => [name, split(channel)]));
}

function joinOffset(planes) {
  const offset = new Float32Array(3 * planes.melanin.length);
  OFFSETS.forEach((name, channel) => {
    planes[name]?.forEach((value, at) => {
      offset[3 * at + channel] = value;
    });
  });
  return offset;
}
