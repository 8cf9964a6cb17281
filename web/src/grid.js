/** Areas of pixels, Uint8Array of 0 and 1, and planes of floats on a grid, as scipy.ndimage has them. */

import { filterGaussian } from "./filters.js";
import { roundHalfEven } from "./rounding.js";

export class Grid {
  constructor(width, height) {
    Object.assign(this, { width, height, size: width * height });
  }

  blur(plane, sigma) {
    return filterGaussian(plane, this.width, this.height, sigma);
  }

  /** An area as a plane that falls from 1 to 0 over a width. */
  soften(area, sigma) {
    return this.blur(Float32Array.from(area), sigma);
  }

  /** Grow an area by a distance along rows and columns; a negative one shrinks it. */
  grow(area, distance) {
    const reach = Math.max(1, roundHalfEven(Math.abs(distance)));
    if (distance > 0) return this.spread(area, reach);
    return invertArea(this.spread(invertArea(area), reach));
  }

  spread(area, reach) {
    const { width, height } = this;
    const across = spreadLines(area, width, height, 1, width, reach);
    return spreadLines(across, height, width, width, 1, reach);
  }

  /** Remove what is thinner than twice a number of steps, along rows and columns. */
  open(area, steps) {
    let opened = area;
    for (let step = 0; step < steps; step++) opened = this.step(opened, 0);
    for (let step = 0; step < steps; step++) opened = this.step(opened, 1);
    return opened;
  }

  /** One step by four neighbours: pixels become `value` beside such; outside all is 0. */
  step(area, value) {
    const { width, height } = this;
    const changed = area.slice();
    for (let y = 0, at = 0; y < height; y++) {
      for (let x = 0; x < width; x++, at++) {
        if (area[at] === value) continue;
        const left = x > 0 ? area[at - 1] : 0;
        const right = x + 1 < width ? area[at + 1] : 0;
        const above = y > 0 ? area[at - width] : 0;
        const below = y + 1 < height ? area[at + width] : 0;
        const isNear = left === value || right === value || above === value || below === value;
        if (isNear) changed[at] = value;
      }
    }
    return changed;
  }

  /** Labels of connected parts, from 1, and the number of pixels of each; that of 0 is given as 0. */
  label(area) {
    const { width, size } = this;
    const labels = new Int32Array(size);
    const stack = new Int32Array(size);
    const sizes = [0];
    for (let start = 0; start < size; start++) {
      if (!area[start] || labels[start]) continue;
      const label = sizes.length;
      let count = 0;
      let top = 0;
      stack[top++] = start;
      labels[start] = label;
      const visit = (at, isThere) => {
        if (!isThere || !area[at] || labels[at]) return;
        labels[at] = label;
        stack[top++] = at;
      };
      while (top) {
        const at = stack[--top];
        count += 1;
        const column = at % width;
        visit(at - 1, column > 0);
        visit(at + 1, column + 1 < width);
        visit(at - width, at >= width);
        visit(at + width, at + width < size);
      }
      sizes.push(count);
    }
    return { labels, sizes };
  }

  /** The parts that are smaller than a number of pixels. */
  keepSmall(area, largest) {
    const { labels, sizes } = this.label(area);
    return area.map((value, at) => Number(value && sizes[labels[at]] < largest));
  }

  /** An area with its holes. */
  fillHoles(area) {
    const { width, height } = this;
    const { labels, sizes } = this.label(invertArea(area));
    const isOutside = sizes.map(() => false);
    for (let x = 0; x < width; x++) {
      isOutside[labels[x]] = isOutside[labels[(height - 1) * width + x]] = true;
    }
    for (let y = 0; y < height; y++) {
      isOutside[labels[y * width]] = isOutside[labels[y * width + width - 1]] = true;
    }
    return area.map((value, at) => Number(value || !isOutside[labels[at]]));
  }

  /** Set the values of an array to one where an area is that is moved by [x, y] pixels. */
  mark(values, value, area, x, y) {
    this.markPlaces(values, value, this.listPlaces(area), x, y);
  }

  /** Columns and places of the pixels of an area. */
  listPlaces(area) {
    const places = [];
    for (let at = 0; at < area.length; at++) if (area[at]) places.push(at);
    return { columns: Int32Array.from(places, (at) => at % this.width), places };
  }

  markPlaces(values, value, { columns, places }, x, y) {
    const { width, size } = this;
    const offset = y * width + x;
    for (let index = 0; index < places.length; index++) {
      const column = columns[index] + x;
      const place = places[index] + offset;
      if (column >= 0 && column < width && place >= 0 && place < size) values[place] = value;
    }
  }

  /** The smallest of each pixel and its eight neighbours. */
  findLeast(plane) {
    const { width, height } = this;
    return plane.map((_, at) => {
      const [x, y] = [at % width, Math.floor(at / width)];
      let least = Infinity;
      for (let row = Math.max(0, y - 1); row <= Math.min(height - 1, y + 1); row++) {
        for (let column = Math.max(0, x - 1); column <= Math.min(width - 1, x + 1); column++) {
          least = Math.min(least, plane[row * width + column]);
        }
      }
      return least;
    });
  }

  /** Pixels inside any outline of points [x, y], and those on its edges, as Pillow fills polygons. */
  fill(...outlines) {
    const area = new Uint8Array(this.size);
    for (const outline of outlines) this.fillOne(area, outline);
    return area;
  }

  fillOne(area, outline) {
    const first = [0, 1].map((axis) => Math.floor(Math.min(...outline.map((point) => point[axis]))));
    const corners = outline.map((point) =>
      point.map((place, axis) => first[axis] + Math.trunc(place - first[axis] - 0.5)));
    const rows = corners.map((corner) => corner[1]);
    for (let y = Math.min(...rows); y <= Math.max(...rows); y++) {
      const crossings = [];
      corners.forEach((corner, at) => {
        const [[x0, y0], [x1, y1]] = [corner, corners[(at + 1) % corners.length]];
        if (y0 === y && y1 === y) this.draw(area, y, Math.min(x0, x1), Math.max(x0, x1));
        if (y < Math.min(y0, y1) || y > Math.max(y0, y1) || y0 === y1) return;
        const x = x0 + ((y - y0) * (x1 - x0)) / (y1 - y0);
        this.draw(area, y, x, x);
        if (y < Math.max(y0, y1)) crossings.push(x);
      });
      crossings.sort((a, b) => a - b);
      for (let at = 0; at + 1 < crossings.length; at += 2) {
        this.draw(area, y, crossings[at], crossings[at + 1]);
      }
    }
  }

  draw(area, y, from, to) {
    if (y < 0 || y >= this.height) return;
    const [first, last] = [Math.max(0, Math.round(from)), Math.min(this.width - 1, Math.round(to))];
    if (last >= first) area.fill(1, y * this.width + first, y * this.width + last + 1);
  }
}

function spreadLines(area, length, lines, step, stride, reach) {
  const spread = new Uint8Array(area.length);
  for (let line = 0; line < lines; line++) {
    const start = line * stride;
    let end = -1; // last place that is reached from the pixels seen
    let seen = 0;
    for (let at = 0; at < length; at++) {
      for (; seen < length && seen <= at + reach; seen++) {
        if (area[start + seen * step]) end = seen + reach;
      }
      if (at <= end) spread[start + at * step] = 1;
    }
  }
  return spread;
}

export function invertArea(area) {
  return area.map((value) => 1 - value);
}

/** Where any of some areas is. */
export function unite(...areas) {
  const united = areas[0].slice();
  for (const area of areas) {
    for (let at = 0; at < united.length; at++) united[at] |= area[at];
  }
  return united;
}

/** Where all of some areas are. */
export function intersect(...areas) {
  const common = areas[0].slice();
  for (const area of areas) {
    for (let at = 0; at < common.length; at++) common[at] &= area[at];
  }
  return common;
}

/** Where the first area is, and none of the others. */
export function subtract(area, ...others) {
  const rest = area.slice();
  for (const other of others) {
    for (let at = 0; at < rest.length; at++) rest[at] &= 1 - other[at];
  }
  return rest;
}

export function countPixels(area) {
  return area.reduce((sum, value) => sum + value, 0);
}

/** Values of a plane in an area. */
export function select(plane, area) {
  return plane.filter((_, at) => area[at]);
}
