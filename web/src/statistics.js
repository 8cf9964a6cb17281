/** Quantiles, and linear equations. */

/** The percentile of values, interpolated linearly between two of them as NumPy does. */
export function findPercentile(values, percent) {
  const sorted = Float64Array.from(values).sort();
  const place = (percent / 100) * (sorted.length - 1);
  const low = Math.floor(place);
  const high = Math.min(low + 1, sorted.length - 1);
  return sorted[low] + (place - low) * (sorted[high] - sorted[low]);
}

export function findMedian(values) {
  return findPercentile(values, 50);
}

/** The inverse of a square matrix of rows, by Gauss and Jordan with pivots. */
export function invert(matrix) {
  const size = matrix.length;
  const rows = matrix.map((row, at) => [...row, ...matrix.map((_, column) => Number(column === at))]);
  for (let at = 0; at < size; at++) {
    let best = at;
    for (let row = at + 1; row < size; row++) {
      if (Math.abs(rows[row][at]) > Math.abs(rows[best][at])) best = row;
    }
    [rows[at], rows[best]] = [rows[best], rows[at]];
    const pivot = rows[at][at];
    rows[at] = rows[at].map((value) => value / pivot);
    rows.forEach((row, other) => {
      if (other === at || row[at] === 0) return;
      const factor = row[at];
      rows[other] = row.map((value, column) => value - factor * rows[at][column]);
    });
  }
  return rows.map((row) => row.slice(size));
}
