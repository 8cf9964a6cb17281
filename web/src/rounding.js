/** Round to the nearest integer, halves to the even one, as Python does. */
export function roundHalfEven(value) {
  const low = Math.floor(value);
  const rest = value - low;
  if (rest !== 0.5) return Math.round(value);
  return low % 2 === 0 ? low : low + 1;
}

export function clamp(value, low, high) {
  return Math.min(Math.max(value, low), high);
}
