/** The skin of one face, as `skinnet.images._face_skin` segments it: the edges are found later. */

import { placeFace } from "./face_place.js";
import { markZones } from "./face_zones.js";
import { Grid, countPixels, intersect, select, subtract, unite } from "./grid.js";
import { filterGuided } from "./guided_filter.js";
import { COVER, MASK } from "./python_data.js";
import { ResizedPlane, resize } from "./resizing.js";
import { clamp, roundHalfEven } from "./rounding.js";
import {
  computeFeatures, computeLogDensity, estimateLogDensity, fitNormal,
} from "./skin_colours.js";
import { fillGaps } from "./skin_gaps.js";
import { LINEAR } from "./srgb.js";
import { findMedian, findPercentile } from "./statistics.js";

const LEAST = 1e-3; // linear sRGB that is added before the logarithm

/**
 * Segment the skin of a face, its ears and its neck.
 * @param photo raster of the whole head
 * @param landmarks [x, y] in pixels of it
 * @param prior coarse probability of skin {plane, width, height}
 * @returns {{plane: Float32Array, width: number, height: number, radius: number}} the probability
 *   at the size at which it is found, and the radius of the filter that finds its edge
 */
export function segmentFaceSkin(photo, landmarks, prior) {
  const { side } = placeFace(landmarks);
  const scale = Math.min(1, MASK.FACE_SIZE / Math.max(side, 1));
  const [width, height] = [photo.width, photo.height].map((length) =>
    Math.max(1, roundHalfEven(length * scale)));
  const small = resize(photo, width, height);
  const points = landmarks.map((point) => point.map((place) => place * scale));
  const rows = new ResizedPlane(prior.plane, prior.width, prior.height, width, height);
  const grid = new Grid(width, height);
  const plane = segment(small, grid, points, rows.readRows(0, height), side * scale);
  const radius = Math.max(1, roundHalfEven(MASK.EDGE_RADIUS * side * scale));
  return { plane, width, height, radius };
}

function segment(photo, grid, points, prior, side) {
  const zones = markZones(points, grid);
  const linear = smoothColours(photo, grid);
  const features = linear.map((pixel) => computeFeatures(...pixel));
  const log = Float32Array.from(features, (feature) => feature[2]);
  const cover = findCover(log, zones, grid, side);
  const seeds = chooseSeeds(zones, prior.map((value, at) => value * (1 - cover[at])), grid, side);
  if (!countPixels(seeds)) return prior;
  const { mean, covariance } = fitNormal(features.filter((_, at) => seeds[at]));
  const wide = covariance.map((row, i) => row.map((value, j) => value + MASK.SHADING[i][j]));
  const around = grid.grow(unite(zones.face, zones.neck), 0.05 * side);
  const hiddenSurely = grid.grow(cover, -0.05 * side);
  const known = prior.map((value, at) => Number((value < 0.1 && !around[at]) || hiddenSurely[at]));
  const own = computeLogDensity(linear, features, mean, wide);
  const others = estimateLogDensity(features, known);
  const difference = features.map((feature) => feature.map((value, axis) => value - mean[axis]));
  const hidden = unite(cover, findBeard(log, zones, seeds, grid, side));
  const place = judgePlace(zones, prior, grid, side);
  const soft = grid.soften(hidden, 0.01 * side);
  const hair = judgeHair(compareNearby(log, seeds, grid, side), zones, grid, side);
  const score = place.map((value, at) => value - 12 * soft[at] - hair[at]);
  const evidence = Float32Array.from(own, (value, at) => value - others[at]);
  const limited = limit(evidence, difference, score, zones, grid);
  const closed = unite(zones.eyes, zones.mouth);
  const probability = score.map((value, at) =>
    1 / (1 + Math.exp(-(closed[at] ? -8 : value + limited[at]))));
  return joinParts(photo, probability, { zones, prior, difference, hidden, closed }, grid, side);
}

/** Keep the face's own parts, and fill their gaps. */
function joinParts(photo, probability, { zones, prior, difference, hidden, closed }, grid, side) {
  const filtered = filterGuided(photo, probability, 2, 1e-3).map((value) => clamp(value, 0, 1));
  const own = findOwn(filtered.map((value) => Number(value > 0.5)), zones, prior, grid, side);
  const filled = fillGaps(Uint8Array.from(own), zones, difference, hidden, grid, side);
  const inside = grid.soften(intersect(unite(own, filled), grid.grow(filled, 2)), 0.7);
  const near = grid.grow(own, 2);
  return filtered.map((value, at) =>
    closed[at] ? 0 : clamp(Math.max(value * near[at], inside[at]), 0, 1));
}

/** Linear red, green and blue of each pixel, smoothed a little. */
function smoothColours(photo, grid) {
  const { data, channels } = photo;
  const planes = [0, 1, 2].map((channel) =>
    grid.blur(Float32Array.from({ length: grid.size }, (_, at) =>
      LINEAR[data[at * channels + channel]] + LEAST), 0.7));
  return Array.from({ length: grid.size }, (_, at) => planes.map((plane) => plane[at]));
}

/** What a face mask hides; nothing if the mouth is seen (`_face_cover.py`). */
function findCover(log, zones, grid, side) {
  const blurred = grid.blur(log, 0.06 * side);
  const darkness = blurred.map((value, at) => value - log[at]);
  const measure = (area) =>
    countPixels(area) ? findPercentile(select(darkness, area), 95) : Infinity;
  const eyes = measure(unite(zones.eyes, zones.brows));
  const lips = measure(grid.grow(zones.lips, 1));
  if (!(COVER.LEAST_EYES < eyes && eyes < Infinity) || lips > COVER.LEAST_SHARE * eyes) {
    return new Uint8Array(grid.size);
  }
  const isOnNose = measure(zones.nostrils) < COVER.LEAST_SHARE * eyes;
  return grid.grow(isOnNose ? zones.cloth : unite(zones.beard, zones.lips), 0.02 * side);
}

/** Pixels that give the colours of this person's skin. */
function chooseSeeds(zones, prior, grid, side) {
  const parts = unite(zones.eyes, zones.brows, zones.lips, zones.nostrils);
  const bare = subtract(grid.grow(zones.face, -0.04 * side), grid.grow(parts, 0.03 * side));
  const seeds = bare.map((value, at) => Number(value && prior[at] > 0.5));
  return countPixels(seeds) > 0.2 * countPixels(bare) ? seeds : bare;
}

/** Log odds of skin by place: from the coarse mask and the parts of the face. */
function judgePlace(zones, prior, grid, side) {
  const soft = grid.blur(prior, 0.02 * side);
  const [face, neck] = [zones.face, zones.neck].map((zone) => grid.soften(zone, 0.02 * side));
  return soft.map((value, at) => {
    if (zones.lips[at]) return MASK.LIPS_ODDS;
    const share = clamp(value, MASK.LEAST_PRIOR, 1 - MASK.LEAST_PRIOR);
    const odds = zones.beard[at] ? MASK.BEARD_ODDS : MASK.FACE_ODDS;
    return Math.log(share / (1 - share)) + MASK.NECK_ODDS * neck[at] + face[at] * odds;
  });
}

/** Limit the log odds of colours, and judge lips by their own. */
function limit(evidence, difference, place, zones, grid) {
  const limited = evidence.map((value) => clamp(value, MASK.LEAST_EVIDENCE, MASK.MOST_EVIDENCE));
  const least = grid.findLeast(limited);
  const [low, high] = MASK.LIPS;
  return limited.map((value, at) => {
    if (!zones.lips[at]) return place[at] > 0 ? value : least[at];
    const beyond = difference[at].reduce((sum, each, axis) => sum +
      (Math.max(each - high[axis], 0) + Math.max(low[axis] - each, 0)) / MASK.LIPS_WIDTH[axis], 0);
    return 2 - 2 * Math.min(beyond, 3);
  });
}

/** Log luminance of the skin nearby, less that of each pixel. */
function compareNearby(log, seeds, grid, side) {
  const weight = grid.soften(seeds, 0.06 * side);
  const total = grid.blur(log.map((value, at) => value * seeds[at]), 0.06 * side);
  const values = select(log, seeds);
  const mean = values.reduce((sum, value) => sum + value, 0) / values.length;
  return log.map((value, at) => (weight[at] > 0.01 ? total[at] / weight[at] : mean) - value);
}

/** Log odds against skin in brows and nostrils, which are darker than the skin nearby. */
function judgeHair(darkness, zones, grid, side) {
  const brows = grid.soften(grid.grow(zones.brows, 0.01 * side), 0.01 * side);
  return darkness.map((value, at) =>
    brows[at] * (1.5 + 12 * clamp(value - 0.15, 0, 0.5)) +
    zones.nostrils[at] * 8 * clamp(value - 0.8, 0, 1));
}

/** A beard so dense that hardly any skin is seen: it is dark, and rough. */
function findBeard(log, zones, seeds, grid, side) {
  const none = new Uint8Array(grid.size);
  const upper = subtract(seeds, zones.beard);
  if (!countPixels(upper)) return none;
  const [fine, coarse] = [0.7, 2.5].map((sigma) => grid.blur(log, sigma));
  const squares = grid.blur(fine.map((value, at) => (value - coarse[at]) ** 2), 0.03 * side);
  const rough = squares.map((value) => Math.sqrt(Math.max(value, 0)));
  const middle = findMedian(select(log, upper));
  const smooth = grid.blur(log, 0.015 * side);
  const leastRough = MASK.BEARD_ROUGHNESS * findMedian(select(rough, upper));
  const aroundLips = grid.grow(zones.lips, 0.03 * side);
  let area = Uint8Array.from(log, (_, at) => Number(
    middle - smooth[at] > MASK.BEARD_DARKNESS && rough[at] > leastRough &&
    (zones.beard[at] || zones.neck[at]) && !aroundLips[at]));
  area = grid.open(area, Math.max(1, roundHalfEven(0.02 * side)));
  area = subtract(area, grid.keepSmall(area, 0.5 * MASK.LEAST_BEARD * side ** 2));
  const inside = intersect(area, grid.grow(zones.face, -0.06 * side));
  const right = countPixels(intersect(inside, zones.right));
  const bothSides = Math.min(right, countPixels(inside) - right);
  const isOnChin = countPixels(intersect(area, zones.chin)) > 0.5 * countPixels(zones.chin);
  if (!isOnChin || bothSides < (MASK.LEAST_BEARD * side ** 2) / 3) return none;
  return grid.grow(area, 0.01 * side);
}

/** The parts that belong to the face, and large ones that the coarse mask shows as well. */
function findOwn(skin, zones, prior, grid, side) {
  const opened = grid.open(Uint8Array.from(skin), Math.max(1, roundHalfEven(0.01 * side)));
  const { labels, sizes } = grid.label(opened);
  const inside = sizes.map(() => 0);
  const sums = sizes.map(() => 0);
  const face = grid.grow(zones.face, -0.02 * side);
  labels.forEach((label, at) => {
    inside[label] += face[at];
    sums[label] += prior[at];
  });
  const isOwn = sizes.map((size, label) => label > 0 && (inside[label] > 0.002 * side ** 2 ||
    (sums[label] > 0.5 * size && size > 0.003 * side ** 2)));
  return opened.map((_, at) => Number(isOwn[labels[at]]));
}
