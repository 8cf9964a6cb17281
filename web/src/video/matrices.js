/** Matrices of three rows, and vectors. */

import { invert } from "../statistics.js";

export function makeIdentity(scale = 1) {
  return [0, 1, 2].map((row) => [0, 1, 2].map((column) => (row === column ? scale : 0)));
}

/** The sum of matrices, or of numbers that are added to all their elements. */
export function add(...terms) {
  return [0, 1, 2].map((row) =>
    [0, 1, 2].map((column) =>
      terms.reduce((sum, term) => sum + (term[row]?.[column] ?? term), 0),
    ),
  );
}

export function scale(matrix, factor) {
  return matrix.map((row) => row.map((value) => value * factor));
}

/** The outer product of a vector with itself. */
export function square(vector) {
  return vector.map((one) => vector.map((other) => one * other));
}

export function dot(one, other) {
  return one[0] * other[0] + one[1] * other[1] + one[2] * other[2];
}

export function solve(matrix, vector) {
  return invert(matrix).map((row) => dot(row, vector));
}
