/** sRGB and linear sRGB (IEC 61966-2-1). */

export function toLinear(value) {
  return value <= 0.04045 ? value / 12.92 : ((value + 0.055) / 1.055) ** 2.4;
}

export function toSrgb(linear) {
  const value = Math.min(1, Math.max(0, linear));
  return value <= 0.0031308 ? value * 12.92 : 1.055 * value ** (1 / 2.4) - 0.055;
}

/** Linear values of the 256 levels. */
export const LINEAR = Float32Array.from({ length: 256 }, (_, level) => toLinear(level / 255));

const STEPS = 1 << 14;

const LEVELS = Uint8Array.from({ length: STEPS + 1 }, (_, index) =>
  Math.round(255 * toSrgb((index / STEPS) ** 2)),
);

/** The level of a linear value; looked up by its root, in which dark values lie apart. */
export function toLevel(linear) {
  if (linear <= 0) return 0;
  return linear >= 1 ? 255 : LEVELS[Math.round(Math.sqrt(linear) * STEPS)];
}

const FINE = Float64Array.from({ length: 4098 }, (_, step) => toLinear(step / 4096));

/** Convert sRGB in [0, 1] to linear sRGB by a table between whose entries it interpolates. */
export function toLinearFast(value) {
  const place = Math.min(1, Math.max(0, value)) * 4096;
  const step = Math.floor(place);
  return FINE[step] + (place - step) * (FINE[step + 1] - FINE[step]);
}
