/** Finds all faces of a photograph, as `skinnet.images.find_faces` does. */

import { detectFaces } from "./face_detector.js";
import { findLandmarks } from "./face_mesh.js";
import { placeFace, toBox } from "./face_place.js";
import { reduce, resize } from "./resizing.js";
import { roundHalfEven } from "./rounding.js";
import { measureOverlap } from "./turned_square.js";

const LEAST_DETECTION = 0.4; // least probability of a face, and in parts of a photograph
const LEAST_IN_PARTS = 0.5;

const WEIGHT = 25; // of the detector's probability beside the mesh's log odds
const LEAST_EVIDENCE = 25; // from which on something is a face
const CLEAR = 35; // from which on the mesh is not read again
const MOVE = 60; // evidence that is lost if all landmarks move by a side of the face

const SURE = 13.8; // log odds from which on no other orientation is tried
const TURN_ODDS = 5; // log odds that another orientation must win
const TURNS = [Math.PI, Math.PI / 2, -Math.PI / 2];

const MESH_MARGIN = 1.5; // side of the mesh's square in sides of the detector's
const VIEW_MARGIN = 2.5; // side of the view in which a detected face is looked for again
const SAME_FACE = 0.3; // overlap of two finds of one face
const LARGE_PHOTO = 512; // longer side from which on parts are searched for small faces
const FAR = 1.6; // side of a view from afar, for faces that fill the photograph

const COARSE = 75; // longer side, in pixels, to which small photographs without a face are averaged

/** Parts in a row, their sides, and the side of the smallest face below which they are searched. */
const PARTS = [[2, 0.6, 0.25], [3, 0.36, 0.1]];

/**
 * Find faces [{box, tilt, landmarks}], tilt in degrees, from left to right. A quick search leaves out the parts
 * of the photograph, in which only smaller faces are found.
 */
export async function findFaces(networks, photo, isQuick = false) {
  const found = [];
  await searchWhole(networks, photo, found);
  if (!isQuick) await searchParts(networks, photo, found);
  const isSmall = Math.max(photo.width, photo.height) < LARGE_PHOTO;
  if (!isQuick && !found.length && isSmall) await searchWhole(networks, smooth(photo), found);
  return found
    .map(({ square, landmarks }) => ({
      box: toBox(square), tilt: (square.tilt * 180) / Math.PI, landmarks,
    }))
    .sort((a, b) => a.box.left + a.box.right - b.box.left - b.box.right);
}

async function searchWhole(networks, photo, found) {
  await search(networks, photo, frame(photo, 1), LEAST_DETECTION, found);
  if (!found.length) await search(networks, photo, frame(photo, FAR), LEAST_DETECTION, found);
}

/** Average over small squares; strong noise hides faces from the networks. */
function smooth(photo) {
  const part = Math.max(2, roundHalfEven(Math.max(photo.width, photo.height) / COARSE));
  return resize(reduce(photo, part, part), photo.width, photo.height);
}

function frame({ width, height }, margin) {
  return { x: width / 2, y: height / 2, side: margin * Math.max(width, height), tilt: 0 };
}

async function search(networks, photo, view, leastScore, found) {
  for (const detection of await detectFaces(networks, photo, view, leastScore)) {
    if (isKnown(detection.square, found)) continue;
    const face = await confirmFace(networks, photo, detection);
    if (face && !isKnown(face.square, found)) found.push(face);
  }
}

function isKnown(square, found) {
  return found.some((other) => measureOverlap(square, other.square) > SAME_FACE);
}

/** Search parts of a large photograph, and smaller ones if there may be smaller faces. */
async function searchParts(networks, photo, found) {
  const longer = Math.max(photo.width, photo.height);
  for (const [count, part, largest] of PARTS) {
    const smallest = found.length ? Math.min(...found.map(({ square }) => square.side)) : 0;
    if (longer < LARGE_PHOTO || smallest > largest * longer) return;
    for (const view of listParts(photo, count, part * longer)) {
      await search(networks, photo, view, LEAST_IN_PARTS, found);
    }
  }
}

function listParts({ width, height }, count, side) {
  const place = (length) => {
    const end = Math.max(side / 2, length - side / 2);
    const step = (end - side / 2) / (count - 1);
    const places = Array.from({ length: count }, (_, index) => side / 2 + index * step);
    return [...new Set(places)];
  };
  return place(height).flatMap((y) => place(width).map((x) => ({ x, y, side, tilt: 0 })));
}

/** The square of a detected face, and its landmarks; null if the two networks together see none. */
async function confirmFace(networks, photo, detection) {
  const { landmarks, odds, score } = await chooseTurn(networks, photo, detection);
  const place = placeFace(landmarks);
  let evidence = odds + WEIGHT * score;
  if (evidence < CLEAR) {
    const again = await readSquare(networks, photo, place);
    const moves = again.landmarks.map(([x, y], at) =>
      Math.hypot(x - landmarks[at][0], y - landmarks[at][1]),
    );
    const moved = moves.reduce((sum, move) => sum + move, 0) / moves.length / place.side;
    evidence += (again.odds - odds) / 2 - MOVE * moved;
  }
  return evidence < LEAST_EVIDENCE ? null : { square: place, landmarks };
}

/** Landmarks and odds in the orientation in which the face is clearest. */
async function chooseTurn(networks, photo, detection) {
  const mesh = await readMesh(networks, photo, detection);
  if (mesh.odds >= SURE) return mesh;
  let best = mesh;
  for (const turn of TURNS) {
    const turned = await turnDetection(networks, photo, detection, turn);
    const other = turned && (await readMesh(networks, photo, turned));
    if (other && other.odds > best.odds) best = other;
  }
  return best.odds > mesh.odds + TURN_ODDS ? best : mesh;
}

async function readMesh(networks, photo, { square, score }) {
  return { ...(await readSquare(networks, photo, square)), score };
}

function readSquare(networks, photo, square) {
  return findLandmarks(networks, photo, { ...square, side: MESH_MARGIN * square.side });
}

/** Detect a face again in a view that is turned; undefined if it is not seen there. */
async function turnDetection(networks, photo, { square }, turn) {
  const view = { ...square, side: VIEW_MARGIN * square.side, tilt: square.tilt + turn };
  const again = await detectFaces(networks, photo, view, LEAST_DETECTION);
  return again
    .filter((each) => measureOverlap(each.square, square) > SAME_FACE)
    .sort((a, b) => b.score - a.score)[0];
}
