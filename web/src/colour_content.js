/** Pictures without colour: grey or of one tone, as `skinnet.images._colour_content` finds them. */

import { frameHead } from "./head_crop.js";
import { COLOUR, SENTENCES, SKIN } from "./python_data.js";
import { roundHalfEven } from "./rounding.js";
import { Refusal, fill } from "./sentences.js";
import { LINEAR } from "./srgb.js";
import { findMedian, findPercentile, invert } from "./statistics.js";

const LEAST = 1e-3; // linear sRGB that is added before the logarithm

const [ROUNDS, RIDGE] = [5, 1e-3]; // of the least squares that fit the curve of chroma over luma

/** Throw a sentence for a face in a box without colour; marked ones may be bare skin of one tone. */
export function checkColour(photo, box, face, name, isMarked = false) {
  const alone = cutRegion(photo, frameHead(face, photo, COLOUR.FACE_MARGIN));
  const tone = findTone(photo, box, face, alone, isMarked);
  if (tone !== null) refuse(name, tone, findPercentile(average(alone).luma, 75));
}

/** Throw a sentence for a grey picture in which no face was found. */
export function refuseGrey(photo, name) {
  const whole = cutRegion(photo, { left: 0, top: 0, right: photo.width, bottom: photo.height });
  const chroma = divide(whole).map((pixels) => Math.hypot(...measureRatios(photo, pixels)));
  if (findPercentile(chroma, 95) >= COLOUR.GREY) return;
  refuse(name, SENTENCES.grey, findPercentile(average(whole).luma, 75));
}

function refuse(name, tone, luma) {
  const remedy = luma < COLOUR.DARK ? SENTENCES.tooDark : SENTENCES.giveColour;
  throw new Refusal(fill(SENTENCES.noColour, { name, tone }) + remedy);
}

function findTone(photo, box, face, alone, isMarked) {
  const skin = findSkin(photo, face);
  if (Math.hypot(...skin) < COLOUR.GREY) return SENTENCES.greySkin;
  if (isMarked) return null;
  const tone = fitTone(average(alone), skin, COLOUR.FACE, COLOUR.FACE_LIMIT);
  const isCloseUp = measureArea(box) <= COLOUR.CLOSE_UP * measureArea(face);
  if (tone !== null || isCloseUp) return tone;
  return fitTone(average(cutRegion(photo, box)), skin, COLOUR.HEAD, COLOUR.HEAD_LIMIT);
}

function measureArea({ left, top, right, bottom }) {
  return (right - left) * (bottom - top);
}

/** A view of a part of a photograph, without a copy. */
function cutRegion(photo, { left, top, right, bottom }) {
  const [width, height] = [Math.min(right, photo.width) - left, Math.min(bottom, photo.height) - top];
  return { photo, left, top, width, height };
}

/** Places in the photograph's data of the pixels of each cell, and how many cells are in a row. */
function divide({ photo, left, top, width, height }) {
  const step = Math.max(1, roundHalfEven(Math.max(width, height) / COLOUR.PIXELS));
  const [across, down] = [width, height].map((side) => Math.ceil(side / step));
  const side = Math.max(1, roundHalfEven(Math.max(across, down) / COLOUR.CELLS));
  const [columns, rows] = [across, down].map((count) => Math.max(1, Math.floor(count / side)));
  const [wide, tall] = [Math.floor(across / columns), Math.floor(down / rows)];
  const cells = [];
  for (let row = 0; row < rows; row++) {
    for (let column = 0; column < columns; column++) {
      const places = [];
      for (let y = row * tall; y < (row + 1) * tall; y++) {
        const line = (top + y * step) * photo.width + left;
        for (let x = column * wide; x < (column + 1) * wide; x++) {
          places.push((line + x * step) * photo.channels);
        }
      }
      cells.push(Object.assign(places, { y: row / rows - 0.5, x: column / columns - 0.5 }));
    }
  }
  return cells;
}

/** Luma and chroma of the cells, and the terms of the curve, averaged over each of them. */
function average(region) {
  const { data } = region.photo;
  const cells = divide(region).map((places) => {
    const [luma, cb, cr] = [0, 1, 2].map((to) =>
      sum(places, (place) => convert(data, place, to)) / places.length,
    );
    const curve = new Float64Array(COLOUR.KNOTS);
    for (const place of places) {
      addKnots(curve, roundHalfEven(convert(data, place, 0)), 1 / places.length);
    }
    const { x, y } = places;
    return { luma, chroma: [cb, cr], terms: [...curve, y, x, (y * luma) / 128, (x * luma) / 128] };
  });
  const list = (name) => cells.map((cell) => cell[name]);
  return { luma: list("luma"), chroma: list("chroma"), terms: list("terms") };
}

function convert(data, place, to) {
  return sum([0, 1, 2], (channel) => data[place + channel] * COLOUR.LUMA_CHROMA[channel][to]);
}

/** Linear splines over luma. */
function addKnots(curve, level, weight) {
  const place = (level / 255) * (COLOUR.KNOTS - 1);
  const low = Math.min(Math.floor(place), COLOUR.KNOTS - 2);
  curve[low] += weight * (1 - place + low);
  curve[low + 1] += weight * (place - low);
}

function fitTone(cells, skin, weights, limit) {
  const residuals = fitCurve(cells);
  const measured = measure(cells, residuals, skin);
  const score = sum(measured, (value, at) => value * weights[at]);
  if (score > limit && measured[1] - measured[2] > COLOUR.ON_CURVE) return null;
  const distance = findMedian(residuals).toFixed(1);
  return fill(SENTENCES.tone, { cells: nameTint(cells), distance });
}

function nameTint({ chroma }) {
  const [cb, cr] = [0, 1].map((axis) => sum(chroma, (each) => each[axis]));
  return COLOUR.TINTS.at(roundHalfEven(Math.atan2(-cb, cr) / (Math.PI / 4)) % 8);
}

/** Sizes of the residuals and of the chroma, brightness, colour of the skin, and 1. */
function measure({ luma, chroma }, residuals, [u, v]) {
  const middle = [0, 1].map((axis) => findMedian(chroma.map((each) => each[axis])));
  const spread = chroma.map(([cb, cr]) => Math.hypot(cb - middle[0], cr - middle[1]));
  const sizes = [
    ...[50, 90].map((percent) => findPercentile(residuals, percent)),
    ...[75, 90].map((percent) => findPercentile(spread, percent)),
  ];
  const brightness = Math.log(sum(luma, (value) => value) / luma.length + 10);
  return [...sizes.map((size) => Math.log(size + 0.3)), brightness, u, v, u * u, v * v, u * v, 1];
}

/** Distances of the cells' chroma from a curve over luma, by reweighted least squares. */
function fitCurve({ terms, chroma }) {
  let weights = terms.map(() => 1);
  let residuals = [];
  let leverage = [];
  for (let round = 0; round < ROUNDS; round++) {
    const inverse = invert(makeNormal(terms, weights));
    const fitted = [0, 1].map((axis) =>
      multiply(inverse, terms[0].map((_, term) =>
        sum(terms, (row, at) => weights[at] * row[term] * chroma[at][axis]))),
    );
    residuals = terms.map((row, at) =>
      Math.hypot(...fitted.map((slopes, axis) => chroma[at][axis] - dot(slopes, row))),
    );
    leverage = terms.map((row, at) => weights[at] * dot(row, multiply(inverse, row)));
    const scale = 2.5 * (findMedian(residuals) / 0.8 + 0.3);
    weights = residuals.map((residual) => 1 / (1 + (residual / scale) ** 2));
  }
  return residuals.map((residual, at) =>
    residual / Math.sqrt(Math.min(Math.max(1 - leverage[at], 0.2), 1)),
  );
}

function makeNormal(terms, weights) {
  const count = terms[0].length;
  return Array.from({ length: count }, (_, i) =>
    Array.from({ length: count }, (_, j) =>
      sum(terms, (row, at) => weights[at] * row[i] * row[j]) + (i === j ? RIDGE : 0)),
  );
}

/** Log R/G and log B/G of the area of a face that is most like skin. */
function findSkin(photo, face) {
  const [width, height] = [face.right - face.left, face.bottom - face.top];
  const step = Math.max(1, Math.floor(width / 100));
  const colours = SKIN.AREAS.map(([left, top, right, bottom]) => {
    const [lastX, lastY] = [
      Math.min(photo.width, face.left + Math.trunc(right * width) + 1),
      Math.min(photo.height, face.top + Math.trunc(bottom * height) + 1),
    ];
    const places = [];
    for (let y = Math.max(0, face.top + Math.trunc(top * height)); y < lastY; y += step) {
      for (let x = Math.max(0, face.left + Math.trunc(left * width)); x < lastX; x += step) {
        places.push((y * photo.width + x) * photo.channels);
      }
    }
    return places;
  });
  const ratios = colours.filter(({ length }) => length).map((each) => measureRatios(photo, each));
  const squares = ratios.map(measureSquare);
  return ratios[squares.indexOf(Math.min(...squares))];
}

/** Squared Mahalanobis distance from all skin. */
export function measureSquare(ratios) {
  const difference = ratios.map((ratio, axis) => ratio - SKIN.USUAL_RATIOS[axis]);
  return dot(difference, multiply(SKIN.SKIN_PRECISION, difference));
}

/** Log R/G and log B/G of the mean of some pixels. */
function measureRatios({ data }, places) {
  const [red, green, blue] = [0, 1, 2].map((channel) =>
    Math.log(sum(places, (place) => LINEAR[data[place + channel]]) / places.length + LEAST),
  );
  return [red - green, blue - green];
}

function multiply(matrix, vector) {
  return matrix.map((row) => dot(row, vector));
}

function dot(a, b) {
  return sum(a, (value, at) => value * b[at]);
}

function sum(values, read) {
  let total = 0;
  for (let at = 0; at < values.length; at++) total += read(values[at], at);
  return total;
}
