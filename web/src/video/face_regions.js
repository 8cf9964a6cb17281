/** The regions of a face that are followed, as masks in its texture (`_regions.py`). */

import { Grid } from "../grid.js";
import { REGIONS, REGION_OUTLINES } from "../python_data.js";

/** Masks of `REGIONS.NAMES`, Uint8Array [size * size] each, by landmarks in texels. */
export function markRegions(landmarks, size) {
  const grid = new Grid(size, size);
  const masks = REGIONS.REGIONS.map((name) => markRegion(grid, landmarks, name));
  const parts = masks.filter((_, at) => REGIONS.REGIONS[at] !== "lips");
  const face = parts[0].map((_, at) => Number(parts.some((mask) => mask[at])));
  return [face, ...masks];
}

function markRegion(grid, landmarks, name) {
  const part = findPart(landmarks, name);
  if (!part) return new Uint8Array(grid.size);
  const [outline, hole] = part.map((points) => points.map((point) => landmarks[point]));
  const inside = grid.fill(outline);
  if (!hole.length) return inside;
  const outside = grid.fill(hole);
  return inside.map((value, at) => value & (1 - outside[at]));
}

/** The outline of a region, and of a hole in it; null if it is turned away. */
function findPart(landmarks, name) {
  const { WHOLE, CHEEKS, LEAST_AREA } = REGION_OUTLINES;
  if (WHOLE[name]) return WHOLE[name];
  const [right, left] = CHEEKS.map(([outline]) =>
    measureArea(outline.map((point) => landmarks[point])),
  );
  const least = LEAST_AREA * Math.max(right, -left);
  if (name === "right_cheek") return right > least ? CHEEKS[0] : null;
  return -left > least ? CHEEKS[1] : null;
}

/** Area of an outline; negative if its corners run anticlockwise in the picture. */
function measureArea(outline) {
  return outline.reduce((sum, [x, y], at) => {
    const [nextX, nextY] = outline[(at + 1) % outline.length];
    return sum + (x * nextY - nextX * y) / 2;
  }, 0);
}
