/** How the colour of a region answers to a change of its hemoglobin (`_blood_response.py`). */

import { RESPONSE } from "../python_data.js";
import { clamp } from "../rounding.js";
import { add, dot, solve, square } from "./matrices.js";

const { RANGE, NODES, LEAST_COLOUR, ROUNDS, ANSWER, GAIN_SD } = RESPONSE;

const CENTRE = Math.floor(NODES / 2);
const WIDTH = (2 * RANGE) / (NODES - 1); // between nodes
const CHANGES = Array.from({ length: NODES }, (_, node) => -RANGE + node * WIDTH);

/** Log colours of one region as functions of the log change of hemoglobin. */
export class BloodResponse {
  /**
   * @param table colours of bare skin under the clip's light and camera
   * @param rest the resting maps
   * @param texels of the region, Uint8Array
   * @param factors on the resting melanin and hemoglobin
   */
  constructor(table, rest, texels, factors = [1, 1]) {
    const chosen = chooseTexels(rest, texels);
    const colours = trace(table, rest, chosen, factors);
    const middle = colours[CENTRE];
    const answer = ANSWER[0] + ANSWER[1] * Math.log(averageMelanin(rest, chosen));
    this.curve = colours.map((colour) =>
      colour.map((value, channel) => answer * (Math.log(value) - Math.log(middle[channel]))),
    );
    this.extend(table, rest, chosen);
    this.white = middle.map((value) => middle[1] / value);
  }

  /** Go on in a straight line beyond the most blood that the table has. */
  extend(table, rest, chosen) {
    const blood = chosen.reduce((most, at) => Math.max(most, rest.hemoglobin[at]), 0);
    const most = Math.log(table.top[1] / blood);
    const above = CHANGES.findIndex((change) => change >= most);
    const last = clamp((above < 0 ? NODES : above) - 1, CENTRE + 2, NODES - 1);
    const slope = [0, 1, 2].map((at) => this.curve[last][at] - this.curve[last - 1][at]);
    for (let node = last + 1; node < NODES; node++) {
      this.curve[node] = slope.map((one, at) => this.curve[last][at] + (node - last) * one);
    }
  }

  /** The change, its standard deviation, and the log gain, by log ratios and their covariance. */
  solve(ratios, noise, glossSd) {
    let change = 0;
    let { weights, variance } = this.weigh(change, noise, glossSd);
    for (let round = 0; round < ROUNDS; round++) {
      const { value } = this.evaluate(change);
      const rest = ratios.map((ratio, at) => ratio - value[at]);
      change = clamp(change + dot(weights, rest) * variance, -RANGE, RANGE);
      ({ weights, variance } = this.weigh(change, noise, glossSd));
    }
    const { value } = this.evaluate(change);
    const gain = ratios.reduce((sum, ratio, at) => sum + ratio - value[at], 0) / 3;
    return { change, sd: Math.sqrt(variance), gain };
  }

  /** How much the chroma answers to log hemoglobin at rest. */
  measureChroma() {
    const [red, green, blue] = this.evaluate(0).slope;
    return Math.max(Math.hypot(red - green, blue - green), 1e-4);
  }

  /** The row of generalised least squares, and the posterior variance. */
  weigh(change, noise, glossSd) {
    const { slope } = this.evaluate(change);
    const white = this.white.map((one) => one * glossSd);
    const weights = solve(add(noise, GAIN_SD ** 2, square(white)), slope);
    return { weights, variance: 1 / Math.max(dot(weights, slope), 1e-9) };
  }

  /** The log colour and its derivative at a change. */
  evaluate(change) {
    const place = clamp((change + RANGE) / WIDTH, 0, NODES - 1.001);
    const node = Math.floor(place);
    const wide = clamp(node, 1, NODES - 3);
    const { curve } = this;
    return {
      value: curve[node].map((low, at) => low + (place - node) * (curve[node + 1][at] - low)),
      slope: curve[wide + 2].map((high, at) => (high - curve[wide - 1][at]) / (3 * WIDTH)),
    };
  }
}

/** The skin of a region; that of the face for a region without any. */
function chooseTexels({ skin }, texels) {
  const list = (isChosen) => [...texels.keys()].filter(isChosen);
  const both = list((at) => texels[at] && skin[at]);
  if (both.length) return both;
  const all = list((at) => texels[at]);
  return all.length ? all : list((at) => skin[at]);
}

function averageMelanin({ melanin }, chosen) {
  return clamp(chosen.reduce((sum, at) => sum + melanin[at], 0) / chosen.length, 0.01, 0.4);
}

/** Mean colour of texels at log changes of hemoglobin, for each node. */
function trace(table, rest, chosen, factors) {
  const bare = [0, 0, 0];
  return CHANGES.map((change) => {
    const factor = factors[1] * Math.exp(change);
    const sums = [0, 0, 0];
    for (const at of chosen) {
      const blood = Math.min(rest.hemoglobin[at] * factor, table.top[1]);
      table.read(Math.min(factors[0] * rest.melanin[at], table.top[0]), blood, bare);
      for (let channel = 0; channel < 3; channel++) {
        sums[channel] += rest.shading[at] * (Math.max(bare[channel], LEAST_COLOUR) + rest.gloss[at]);
      }
    }
    return sums.map((sum) => sum / chosen.length);
  });
}
