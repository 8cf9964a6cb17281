/** Where the parts of a face are in a picture, by its landmarks (`_face_zones.py`). */

import { subtract } from "./grid.js";
import { OUTLINES } from "./python_data.js";

/** Areas of the grid by the name of the part, and `down`, [x, y] from the brows to the chin. */
export function markZones(landmarks, grid) {
  const list = (outline) => outline.map((point) => landmarks[point]);
  const mark = (...outlines) => grid.fill(...outlines.map(list));
  const [x, y] = landmarks[OUTLINES.CHIN];
  const [browX, browY] = landmarks[OUTLINES.BROW];
  const down = [x - browX, y - browY];
  const jaw = list(OUTLINES.JAW);
  const below = jaw.map((point) => point.map((place, axis) => place + OUTLINES.NECK * down[axis]));
  const face = mark(OUTLINES.OVAL);
  const right = Uint8Array.from({ length: grid.size }, (_, at) => {
    const [column, row] = [(at % grid.width) + 0.5, Math.floor(at / grid.width) + 0.5];
    return Number((column - x) * down[1] - (row - y) * down[0] < 0);
  });
  return {
    face, right, down,
    eyes: mark(OUTLINES.RIGHT_EYE, OUTLINES.LEFT_EYE),
    brows: mark(...OUTLINES.BROWS),
    lips: mark(OUTLINES.LIPS),
    mouth: mark(OUTLINES.INNER_LIPS),
    nostrils: mark(OUTLINES.NOSTRILS),
    neck: subtract(grid.fill([...jaw, ...below.reverse()]), face),
    beard: mark(OUTLINES.BEARD),
    chin: mark(OUTLINES.CHIN_PAD),
    cloth: mark(OUTLINES.CLOTH),
  };
}
