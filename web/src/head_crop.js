/** The part of a photograph that the encoder sees: a square around a head, cut upright. */

import { clamp, roundHalfEven } from "./rounding.js";
import { cropRaster, dropAlpha, padMirrored } from "./raster.js";
import { resize } from "./resizing.js";
import { cutSquare, listCorners, makeMatrix } from "./turned_square.js";

const HEAD_CENTRE = 0.45; // distance from the top of the face's box to the head's centre, in heights
const UPRIGHT = 8; // largest tilt, in degrees, of heads that are read as they are
const OUTSIDE = 0.02; // largest part of a face's side outside the photograph for the same
const MARGIN = 2; // side of the square around the head in sides of the face's box
const LEAST_SIDE = 16; // of the encoder's input, in pixels
const FADE = 0.08; // share of the box over which an edit fades out towards an edge inside

/** @returns {{box: object, square: object|null}} the rectangle, and the turned square in it */
export function cropHead(face, photo) {
  if (Math.abs(face.tilt) <= UPRIGHT && isInside(face.box, photo)) {
    return { box: frameHead(face.box, photo), square: null };
  }
  const square = turnSquare(face);
  return { box: bound(square, photo), square };
}

/** The encoder's input: red, green and blue, upright, with a longer side of `size` pixels. */
export function cutHead(crop, photo, size) {
  if (crop.square) return cutSmoothly(crop.square, photo, size);
  const part = dropAlpha(cropRaster(photo, crop.box));
  const scale = size / Math.max(part.height, part.width);
  const [width, height] = [part.width, part.height].map((side) =>
    Math.max(LEAST_SIDE, roundHalfEven(side * scale)),
  );
  return resize(part, width, height);
}

/** Turn planes of a cut of `size` pixels back onto the rectangle; the mask is 0 outside the cut. */
export function turnBack(crop, planes, width, height, size) {
  if (!crop.square) return { planes, width, height };
  const scale = size / crop.square.side;
  const newWidth = Math.max(1, roundHalfEven((crop.box.right - crop.box.left) * scale));
  const newHeight = Math.max(1, roundHalfEven((crop.box.bottom - crop.box.top) * scale));
  const places = placeGrid(crop, newWidth, newHeight, size);
  const turned = {};
  for (const [name, plane] of Object.entries(planes)) {
    turned[name] = places.map(([x, y]) => readBetween(plane, width, height, x - 0.5, y - 0.5));
    turned[name] = Float32Array.from(turned[name]);
  }
  turned.mask = turned.mask.map((value, at) => value * coverSquare(places[at], size));
  return { planes: turned, width: newWidth, height: newHeight };
}

/** Weights of the rectangle's pixels that fall to 0 at sides inside the photograph. */
export function fadeEdges(crop, width, height, photo) {
  const sides = crop.square ? listTurnedSides(crop.square, photo) : listSides(crop.box, photo);
  const places = crop.square ? placeGrid(crop, width, height, 1) : placeUpright(width, height);
  return Float32Array.from(places, ([u, v]) => {
    const distances = [v, 1 - u, 1 - v, u].map((far, side) => (sides[side] ? far / FADE : 1));
    const weights = distances.map((far) => clamp(far, 0, 1));
    return crop.square
      ? Math.min(...weights)
      : Math.min(weights[0], weights[2]) * Math.min(weights[1], weights[3]);
  });
}

function isInside(face, { width, height }) {
  const least = -OUTSIDE * (face.right - face.left);
  return Math.min(face.left, face.top, width - face.right, height - face.bottom) >= least;
}

/** A square around the head of a face's box, clipped to the photograph. */
export function frameHead(face, { width, height }, margin = MARGIN) {
  const half = (margin * Math.max(face.right - face.left, face.bottom - face.top)) / 2;
  const x = (face.left + face.right) / 2;
  const y = face.top + HEAD_CENTRE * (face.bottom - face.top);
  return {
    left: Math.max(0, roundHalfEven(x - half)),
    top: Math.max(0, roundHalfEven(y - half)),
    right: Math.min(width, roundHalfEven(x + half)),
    bottom: Math.min(height, roundHalfEven(y + half)),
  };
}

/** The face's box in the cut of a turned head of `size` pixels. */
export function placeFaceInCut(size) {
  const side = size / MARGIN;
  const [left, top] = [(size - side) / 2, size / 2 - HEAD_CENTRE * side];
  const box = { left, top, right: left + side, bottom: top + side };
  return Object.fromEntries(Object.entries(box).map(([name, end]) => [name, roundHalfEven(end)]));
}

function turnSquare({ box, tilt }) {
  const angle = (tilt * Math.PI) / 180;
  const raised = (0.5 - HEAD_CENTRE) * (box.bottom - box.top);
  return {
    x: (box.left + box.right) / 2 + raised * Math.sin(angle),
    y: (box.top + box.bottom) / 2 - raised * Math.cos(angle),
    side: MARGIN * Math.max(box.right - box.left, box.bottom - box.top),
    tilt: angle,
  };
}

function findEnds(square) {
  const corners = listCorners(square);
  const [x, y] = [0, 1].map((axis) => corners.map((corner) => corner[axis]));
  return {
    left: roundHalfEven(Math.min(...x)),
    top: roundHalfEven(Math.min(...y)),
    right: roundHalfEven(Math.max(...x)),
    bottom: roundHalfEven(Math.max(...y)),
  };
}

function bound(square, { width, height }) {
  const { left, top, right, bottom } = findEnds(square);
  return {
    left: Math.max(0, left),
    top: Math.max(0, top),
    right: Math.min(right, width),
    bottom: Math.min(bottom, height),
  };
}

/** Cut a square at twice the size, and average; what is outside is the photograph's mirror image. */
function cutSmoothly(square, photo, size) {
  const ends = findEnds(square);
  const box = bound(square, photo);
  const [across, down] = [box.right - box.left, box.bottom - box.top];
  const scale = Math.min(1, (2 * size) / square.side);
  const [width, height] = [across, down].map((side) => Math.max(1, roundHalfEven(side * scale)));
  const lengthen = (length) => Math.ceil(length * scale) + 1;
  const columns = [box.left - ends.left, ends.right - box.right].map(lengthen);
  const rows = [box.top - ends.top, ends.bottom - box.bottom].map(lengthen);
  const part = resize(dropAlpha(cropRaster(photo, box)), width, height);
  const moved = {
    x: ((square.x - box.left) * width) / across + columns[0],
    y: ((square.y - box.top) * height) / down + rows[0],
    side: square.side * scale,
    tilt: square.tilt,
  };
  return resize(cutSquare(moved, padMirrored(part, rows, columns), 2 * size), size, size);
}

/** Columns and rows, in a cut of `size` pixels, of the rectangle's pixels. */
function placeGrid({ box, square }, width, height, size) {
  const [a, b, c, d, e, f] = makeMatrix(square, size);
  const determinant = a * e - b * d;
  return placeUpright(width, height).map(([u, v]) => {
    const x = box.left + u * (box.right - box.left) - c;
    const y = box.top + v * (box.bottom - box.top) - f;
    return [(e * x - b * y) / determinant, (a * y - d * x) / determinant];
  });
}

function placeUpright(width, height) {
  return Array.from({ length: width * height }, (_, at) => [
    ((at % width) + 0.5) / width,
    (Math.floor(at / width) + 0.5) / height,
  ]);
}

function listSides(box, { width, height }) {
  return [box.top > 0, box.right < width, box.bottom < height, box.left > 0];
}

function listTurnedSides(square, { width, height }) {
  const [a, b, c, d, e, f] = makeMatrix(square, 1);
  return [[0.5, 0], [1, 0.5], [0.5, 1], [0, 0.5]].map(([u, v]) => {
    const [x, y] = [a * u + b * v + c, d * u + e * v + f];
    return x > 0 && y > 0 && x < width && y < height;
  });
}

/** Bilinear interpolation of a plane that continues its values at its sides. */
function readBetween(plane, width, height, x, y) {
  const left = clamp(x, 0, width - 1);
  const top = clamp(y, 0, height - 1);
  const [column, row] = [Math.floor(left), Math.floor(top)];
  const [dx, dy] = [left - column, top - row];
  const right = Math.min(column + 1, width - 1);
  const below = Math.min(row + 1, height - 1);
  const read = (line, at) => plane[line * width + at];
  const upper = read(row, column) * (1 - dx) + read(row, right) * dx;
  const lower = read(below, column) * (1 - dx) + read(below, right) * dx;
  return upper * (1 - dy) + lower * dy;
}

/** How much of a pixel is inside the cut, with a soft edge of one pixel. */
function coverSquare([x, y], size) {
  const inside = (place) => clamp(Math.min(place + 0.5, size + 0.5 - place), 0, 1);
  return inside(x) * inside(y);
}
