/** How constant the readings of melanin are through a video (`_look_series.py`). */

/**
 * Describe the looks of shots [{number, times, means, weights}]: their spread about that of their
 * shot, the standard error of their mean, and the drift between both halves of the longest shot.
 */
export function describeConstancy(shots) {
  const looks = shots.flatMap(({ number, times, means }) =>
    times.map((time, at) => ({ time: round(time, 3), shot: number, mean: round(means[at], 5) })),
  );
  const spreads = shots.filter(({ times }) => times.length > 1).map(measureSpread);
  const squares = spreads.reduce((sum, spread) => sum + spread ** 2, 0);
  const spread = spreads.length ? Math.sqrt(squares / spreads.length) : null;
  const count = shots.reduce((sum, { weights }) => sum + 1 / sumSquares(weights), 0);
  const length = ({ times }) => times.at(-1) - times[0];
  const longest = shots.reduce((best, shot) => (length(shot) > length(best) ? shot : best));
  return {
    looks,
    spread: spread === null ? null : round(spread, 4),
    standard_error: spread === null ? null : round(spread / Math.sqrt(count), 4),
    drift: measureDrift(longest),
  };
}

function measureSpread({ means, weights }) {
  const logs = means.map(Math.log);
  const middle = average(logs, weights);
  const own = logs.reduce((sum, log, at) => sum + weights[at] * (log - middle) ** 2, 0);
  return Math.sqrt(own / Math.max(1 - sumSquares(weights), 1e-3));
}

function measureDrift({ times, means, weights }) {
  const middle = (times[0] + times.at(-1)) / 2;
  const halves = [false, true].map((isLater) =>
    [...times.keys()].filter((at) => times[at] >= middle === isLater),
  );
  if (halves.some((half) => half.length < 2)) return null;
  const [first, second] = halves.map((half) =>
    average(half.map((at) => Math.log(means[at])), half.map((at) => weights[at])),
  );
  return round(second - first, 4);
}

function average(values, weights) {
  const total = weights.reduce((sum, weight) => sum + weight, 0);
  return values.reduce((sum, value, at) => sum + weights[at] * value, 0) / total;
}

function sumSquares(weights) {
  return weights.reduce((sum, weight) => sum + weight ** 2, 0);
}

function round(value, digits) {
  return Number(value.toFixed(digits));
}
