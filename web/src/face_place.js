/** Where a face is and how it is turned, by its landmarks. */

import { roundHalfEven } from "./rounding.js";

const SIDE = 3.37; // of the face's box, in standard deviations of the mesh's points

const RAISE = 0.088; // height of the box's centre above their mean, in sides

const EYES = [[263, 362], [33, 133]]; // corners of the person's left eye, and of the right one

const BROW = 9;
const CHIN = 152;

/** The square from the brows to the chin, turned as the face is. */
export function placeFace(landmarks) {
  const tilt = measureTilt(landmarks);
  const mean = [0, 1].map((axis) => average(landmarks.map((point) => point[axis])));
  const variance = [0, 1].map((axis) =>
    average(landmarks.map((point) => (point[axis] - mean[axis]) ** 2)),
  );
  const side = SIDE * Math.sqrt(variance[0] + variance[1]);
  return {
    x: mean[0] + RAISE * side * Math.sin(tilt),
    y: mean[1] - RAISE * side * Math.cos(tilt),
    side,
    tilt,
  };
}

/** The upright square of the same place and size, in whole pixels. */
export function toBox(square) {
  const left = roundHalfEven(square.x - square.side / 2);
  const top = roundHalfEven(square.y - square.side / 2);
  const side = roundHalfEven(square.side);
  return { left, top, right: left + side, bottom: top + side };
}

/** Angle between the picture, and the eyes' line and the face's axis together. */
function measureTilt(mesh) {
  const [left, right] = EYES.map((corners) =>
    [0, 1].map((axis) => average(corners.map((corner) => mesh[corner][axis]))),
  );
  const across = [left[0] - right[0], left[1] - right[1]];
  const down = [mesh[CHIN][0] - mesh[BROW][0], mesh[CHIN][1] - mesh[BROW][1]];
  let x = 0;
  let y = 0;
  for (const [dx, dy] of [across, [down[1], -down[0]]]) {
    const length = Math.max(Math.hypot(dx, dy), 1e-9);
    x += dx / length;
    y += dy / length;
  }
  return Math.atan2(y, x);
}

function average(values) {
  return values.reduce((sum, value) => sum + value, 0) / values.length;
}
