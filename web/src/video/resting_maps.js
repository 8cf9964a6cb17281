/** Maps of a face at rest, pooled from several frames of a shot (`_resting_maps.py`). */

import { FaceReading } from "../face_reading.js";
import { CAPTURE_NAMES } from "../networks.js";
import { RESTING, SENTENCES } from "../python_data.js";
import { makeRaster } from "../raster.js";
import { findMedian } from "../statistics.js";
import { isSkin } from "../uncertainty.js";
import { sample } from "./texture_space.js";

const MAPS = ["melanin", "hemoglobin", "shading", "specular", "mask", "melanin_sd", "hemoglobin_sd"];
const PIGMENTS = ["melanin", "hemoglobin"];
const LEAST_SHADING = 0.02;

/** What the network reads of a frame, in a texture space; throws a sentence if it cannot. */
export async function readLook(networks, frame, face, space, name) {
  const subject = { face, who: "the face in the video", name, others: [], isMarked: false };
  const { planes, width, height, crop, capture, faceSd, checked } =
    await FaceReading.read(networks, frame, subject, null);
  const { left, top, right, bottom } = crop.box;
  const [across, down] = [width / (right - left), height / (bottom - top)];
  const points = space
    .place(face.landmarks)
    .map((place, at) => (at % 2 ? (place - top) * down : (place - left) * across));
  const maps = Object.fromEntries(
    MAPS.map((map) => [map, sample(makeRaster(planes[map], width, height), points)]),
  );
  return { maps, capture, faceSd, notes: checked };
}

/** Pool looks by their medians, so that a bad one does no harm. */
export function poolLooks(looks) {
  const pool = (map, change = (value) => value) =>
    looks[0].maps[map].map((_, at) => findMedian(looks.map((look) => change(look.maps[map][at], look, at))));
  const skin = Uint8Array.from(pool("mask"), (mask) => Number(isSkin(mask)));
  if (!skin.includes(1)) throw new Error(SENTENCES.noSkinInVideo);
  const takeLog = (value) => Math.log(Math.max(value, RESTING.LEAST));
  const [melanin, hemoglobin] = PIGMENTS.map((map) => pool(map, takeLog).map(Math.exp));
  return {
    melanin, hemoglobin, skin,
    gloss: pool("specular", (value, { maps }, at) =>
      Math.min(Math.max(value / Math.max(maps.shading[at], LEAST_SHADING), 0), RESTING.MOST_GLOSS),
    ),
    shading: pool("shading").map((value) => Math.max(value, LEAST_SHADING)),
    capture: poolCaptures(looks.map((look) => look.capture)),
    pixelSd: PIGMENTS.map((map) => pool(`${map}_sd`)),
    faceSd: [0, 1].map((at) => findMedian(looks.map((look) => look.faceSd[at]))),
    looks: looks.length,
  };
}

function poolCaptures(captures) {
  const pooled = Object.fromEntries(
    CAPTURE_NAMES.map((name) => [
      name,
      captures[0][name].map((_, at) => findMedian(captures.map((capture) => capture[name][at]))),
    ]),
  );
  const total = Math.max(pooled.light.reduce((sum, one) => sum + one, 0), 1e-6);
  pooled.light = pooled.light.map((one) => one / total);
  return pooled;
}
