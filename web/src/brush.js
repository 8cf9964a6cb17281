/** Paint on a face: where an edit is to be, and how much, from 0 to 1. */

let count = 0; // paints have numbers, by which the worker knows them

/**
 * @typedef {{id: number, values: Float32Array}} Paint values have the size of the reading's maps
 */

/** Add a line of round, soft marks to a paint; null begins a new one. */
export function paintLine(paint, { width, height, box }, from, to, radius) {
  const values = paint ? paint.values.slice() : new Float32Array(width * height);
  const across = width / (box.right - box.left);
  const down = height / (box.bottom - box.top);
  const length = Math.hypot(to[0] - from[0], to[1] - from[1]);
  const steps = Math.max(1, Math.ceil((3 * length) / radius));
  for (let step = 0; step <= steps; step++) {
    const [x, y] = [0, 1].map((axis) => from[axis] + ((to[axis] - from[axis]) * step) / steps);
    mark(values, width, height, (x - box.left) * across, (y - box.top) * down, radius * across);
  }
  return { id: ++count, values };
}

function mark(values, width, height, x, y, radius) {
  const [left, right] = [x - radius, x + radius].map(Math.floor);
  const [top, bottom] = [y - radius, y + radius].map(Math.floor);
  for (let row = Math.max(0, top); row <= Math.min(height - 1, bottom); row++) {
    for (let column = Math.max(0, left); column <= Math.min(width - 1, right); column++) {
      const distance = Math.hypot(column + 0.5 - x, row + 0.5 - y) / radius;
      const strength = Math.min(1, Math.max(0, 2 - 2 * distance));
      const at = row * width + column;
      values[at] = Math.max(values[at], strength);
    }
  }
}
