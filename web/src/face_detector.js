/** BlazeFace (Bazarevsky et al. 2019): where faces are, and how they are turned. */

import { cutSquare, placePoint } from "./turned_square.js";

const SIZE = 256; // side of the network's input, in pixels

const GRIDS = [[16, 2], [8, 6]]; // cells across each grid, and anchors in each cell

const SAME_FACE = 0.3; // overlap of detections of one face

const ANCHORS = GRIDS.flatMap(([cells, each]) =>
  Array.from({ length: cells * cells * each }, (_, index) => {
    const cell = Math.floor(index / each);
    return [((cell % cells) + 0.5) / cells, (Math.floor(cell / cells) + 0.5) / cells];
  }),
);

/** Detect faces in a square of a photograph: [{square, score}]. */
export async function detectFaces(networks, photo, view, leastScore) {
  const cut = cutSquare(view, photo, SIZE);
  const input = Float32Array.from(cut.data, (level) => Math.fround(level / 127.5) - 1);
  const outputs = await networks.run("face_detector", { input: [input, [1, SIZE, SIZE, 3]] });
  const found = [];
  outputs.classificators.forEach((odds, index) => {
    const score = 1 / (1 + Math.exp(-Math.min(80, Math.max(-80, odds))));
    if (score >= leastScore) found.push({ score, points: readPoints(outputs.regressors, index) });
  });
  return merge(found).map(({ points, score }) => ({ square: toSquare(points, view), score }));
}

/** Centre, size and landmarks of a detection, in pixels of the input. */
function readPoints(regressors, index) {
  return Array.from({ length: 8 }, (_, point) => {
    const shift = point === 1 ? [0, 0] : ANCHORS[index];
    return shift.map((anchor, axis) => regressors[index * 16 + 2 * point + axis] + SIZE * anchor);
  });
}

/** Merge the detections of each face to their mean, weighed by the scores. */
function merge(found) {
  let rest = [...found].sort((a, b) => b.score - a.score);
  const merged = [];
  while (rest.length) {
    const [best] = rest;
    const isSame = (each) => each === best || overlap(each.points, best.points) > SAME_FACE;
    const same = rest.filter(isSame);
    merged.push({ points: average(same), score: best.score });
    rest = rest.filter((each) => !isSame(each));
  }
  return merged;
}

function overlap([centre, size], [otherCentre, otherSize]) {
  let shared = 1;
  for (const axis of [0, 1]) {
    const low = Math.max(centre[axis] - size[axis] / 2, otherCentre[axis] - otherSize[axis] / 2);
    const high = Math.min(centre[axis] + size[axis] / 2, otherCentre[axis] + otherSize[axis] / 2);
    shared *= Math.max(0, high - low);
  }
  const area = size[0] * size[1] + otherSize[0] * otherSize[1];
  return shared / Math.max(area - shared, 1e-6);
}

function average(detections) {
  const total = detections.reduce((sum, { score }) => sum + score, 0);
  return detections[0].points.map((point, index) =>
    point.map(
      (_, axis) =>
        detections.reduce((sum, { score, points }) => sum + score * points[index][axis], 0) / total,
    ),
  );
}

function toSquare(points, view) {
  const [centre, rightEye, leftEye] = [0, 2, 3].map((at) => placePoint(view, SIZE, points[at]));
  return {
    x: centre[0],
    y: centre[1],
    side: (Math.max(...points[1]) * view.side) / SIZE,
    tilt: Math.atan2(leftEye[1] - rightEye[1], leftEye[0] - rightEye[0]),
  };
}
