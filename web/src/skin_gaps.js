/** Gaps in a mask of skin that are skin: highlights, moles, the shadow below the chin (`_skin_gaps.py`). */

import { intersect, subtract, unite } from "./grid.js";
import { GAPS } from "./python_data.js";
import { roundHalfEven } from "./rounding.js";

/** The gaps of `skin` that are skin; the difference is that of colours to the person's skin. */
export function fillGaps(skin, zones, difference, beard, grid, side) {
  const hidden = unite(zones.eyes, zones.mouth);
  let filled = findHoles(skin, zones, difference, grid, side);
  filled = unite(filled, findShadow(unite(skin, filled), zones, difference, grid, side));
  filled = unite(filled, findHighlight(unite(skin, filled), zones, difference, grid, side));
  const closed = grid.grow(grid.grow(unite(skin, filled), 0.03 * side), -0.03 * side);
  const lower = intersect(closed, unite(zones.neck, zones.beard));
  filled = unite(filled, subtract(lower, skin, zones.nostrils));
  return subtract(filled, grid.grow(hidden, 1), beard);
}

/** Small holes in skin; dark ones near the eyes are frames of glasses, lashes and brows. */
function findHoles(skin, zones, difference, grid, side) {
  const hidden = unite(zones.eyes, zones.mouth);
  const whole = grid.fillHoles(unite(skin, hidden, zones.brows, zones.lips));
  const parts = unite(zones.brows, zones.nostrils, zones.lips);
  const holes = subtract(whole, skin, grid.grow(hidden, 0.02 * side), parts);
  const nearEyes = grid.grow(zones.eyes, 0.2 * side);
  return grid.keepSmall(holes, (GAPS.LARGEST_HOLE * side) ** 2).map((value, at) =>
    Number(value && (difference[at][2] > -0.5 || !nearEyes[at])));
}

/** The shadow below the chin, between the face and the neck. */
function findShadow(skin, zones, difference, grid, side) {
  const rim = subtract(
    grid.grow(zones.face, 0.03 * side), grid.grow(zones.face, -GAPS.LOWER_FACE * side),
  );
  const jaw = grid.grow(unite(zones.neck, rim), 0.04 * side);
  const gap = findShortGaps(skin, zones.down, GAPS.SHADOW * side, grid).map((value, at) => {
    const [red, blue, brightness] = difference[at];
    return Number(value && jaw[at] && brightness < 0 && Math.hypot(red, blue) < GAPS.MOST_OFF);
  });
  const lips = grid.grow(zones.lips, 0.02 * side);
  const holes = subtract(unite(zones.face, gap), skin, lips, zones.brows, zones.eyes);
  const { labels, sizes } = grid.label(holes);
  const inner = grid.grow(zones.face, -0.07 * side);
  const deep = sizes.map(() => 0);
  labels.forEach((label, at) => {
    deep[label] += inner[at];
  });
  const isShadow = sizes.map((size, label) => label > 0 && deep[label] < 0.15 * size &&
    deep[label] < GAPS.LEAST_BEARD * side ** 2);
  return gap.map((value, at) => Number(value && isShadow[labels[at]]));
}

/** The highlight at the top of a forehead or a bald head, which no skin may be above. */
function findHighlight(skin, zones, difference, grid, side) {
  const [x, y] = zones.down;
  const above = new Uint8Array(grid.size);
  for (const share of GAPS.ABOVE) {
    grid.mark(above, 1, zones.face, roundHalfEven(-share * x), roundHalfEven(-share * y));
  }
  const gap = findShortGaps(skin, [-y, x], GAPS.HIGHLIGHT * side, grid);
  return gap.map((value, at) =>
    Number(value && above[at] && !zones.neck[at] && difference[at][2] > 0.4));
}

/** Gaps in an area that are at most so long in a direction [x, y]. */
function findShortGaps(area, [x, y], longest, grid) {
  const length = Math.max(1e-6, Math.hypot(x, y));
  const count = Math.max(1, roundHalfEven(longest));
  const places = grid.listPlaces(area);
  const [before, after] = [1, -1].map((sign) => {
    const distances = new Int32Array(grid.size).fill(count + 1);
    for (let distance = count; distance > 0; distance--) {
      const [dx, dy] = [x, y].map((axis) => roundHalfEven((sign * distance * axis) / length));
      grid.markPlaces(distances, distance, places, dx, dy);
    }
    return distances;
  });
  return area.map((value, at) => Number(!value && before[at] + after[at] <= count + 1));
}
