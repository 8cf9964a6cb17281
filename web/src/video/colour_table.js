/** Colours of bare skin under one light and camera, tabulated by the decoder (`_colour_table.py`). */

import { COLOUR_TABLE } from "../python_data.js";
import { toLinear } from "../srgb.js";

const { NODES, SHADING } = COLOUR_TABLE;

/** Linear RGB as a function of melanin and hemoglobin, bilinear between nodes. */
export class ColourTable {
  /** Tabulate the colours of a capture, up to the fractions `top`. */
  static async make(networks, capture, top) {
    const [rows, columns] = NODES;
    const count = rows * columns;
    const place = (node, axis) => top[axis] * (node / (NODES[axis] - 1)) ** 2;
    const planes = {
      melanin: Float32Array.from({ length: count }, (_, at) => place(Math.floor(at / columns), 0)),
      hemoglobin: Float32Array.from({ length: count }, (_, at) => place(at % columns, 1)),
      shading: new Float32Array(count).fill(SHADING),
      specular: new Float32Array(count),
    };
    const image = await networks.decode(planes, capture, columns, rows);
    return new ColourTable(Float32Array.from(image, (value) => toLinear(value) / SHADING), top);
  }

  constructor(colours, top) {
    Object.assign(this, { colours, top });
  }

  /** Write the colour of two fractions to the first three places of an array. */
  read(melanin, hemoglobin, to) {
    const columns = NODES[1];
    const [row, down] = this.locate(melanin, 0);
    const [column, right] = this.locate(hemoglobin, 1);
    const first = 3 * (row * columns + column);
    const { colours } = this;
    for (let channel = 0; channel < 3; channel++) {
      const at = first + channel;
      const left = colours[at] + down * (colours[at + 3 * columns] - colours[at]);
      const next = at + 3;
      const other = colours[next] + down * (colours[next + 3 * columns] - colours[next]);
      to[channel] = left + right * (other - left);
    }
  }

  /** The node below a fraction, and the share of the way to the next one. */
  locate(fraction, axis) {
    const last = NODES[axis] - 1;
    const place = Math.sqrt((Math.max(fraction, 0) * last ** 2) / this.top[axis]);
    const node = Math.floor(Math.min(place, last - 1));
    return [node, Math.min(place - node, 1)];
  }
}
