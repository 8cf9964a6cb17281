/** Fixed, labelled colour scales of maps, the same as in the pictures of the Python package. */

const BROWN = [
  [254, 249, 234], [239, 213, 155], [223, 176, 91], [205, 138, 47], [180, 102, 31], [149, 70, 25],
  [114, 42, 19], [75, 21, 14], [30, 7, 11],
];
const RED = [
  [252, 248, 251], [248, 205, 222], [248, 159, 181], [243, 111, 133], [227, 61, 79], [184, 34, 49],
  [139, 13, 31], [93, 0, 25], [48, 0, 20],
];
const BLUE = [
  [13, 16, 30], [12, 42, 78], [3, 70, 121], [1, 100, 160], [7, 132, 198], [83, 163, 218],
  [139, 195, 233], [195, 225, 245], [255, 255, 255],
];
const GREEN = [
  [233, 255, 237], [179, 228, 190], [133, 199, 150], [93, 168, 115], [60, 138, 86], [35, 107, 61],
  [21, 76, 41], [16, 47, 26], [11, 19, 12],
];
const GREY = [
  [0, 0, 0], [255, 255, 255],
];

/**
 * Scales from 0 to the last tick, in percent. They are linear up to the knee, if there is one, and
 * above it equal distances are equal ratios.
 */
export const SCALES = {
  melanin: {
    title: "Melanin",
    measure: "melanosomes in the epidermis, by volume",
    colours: BROWN,
    ticks: [0, 1, 2, 5, 10, 20, 50],
    knee: 1,
  },
  hemoglobin: {
    title: "Hemoglobin",
    measure: "blood in the dermis, by volume",
    colours: RED,
    ticks: [0, 1, 2, 5, 10, 20],
    knee: 2,
  },
  melanin_sd: {
    title: "Uncertainty of melanin",
    measure: "standard deviation, of the value",
    colours: GREEN,
    ticks: [0, 20, 50, 100, 200],
    knee: 50,
  },
  hemoglobin_sd: {
    title: "Uncertainty of hemoglobin",
    measure: "standard deviation, of the value",
    colours: GREEN,
    ticks: [0, 20, 50, 100, 200],
    knee: 50,
  },
  shading: {
    title: "Shading",
    measure: "relative to the light",
    colours: GREY,
    ticks: [0, 20, 50, 100, 200],
    knee: 50,
  },
  specular: {
    title: "Specular reflection",
    measure: "relative to the light",
    colours: BLUE,
    ticks: [0, 1, 2, 5, 10, 20, 50],
    knee: 1,
  },
};

const PERCENT = 100;

/** The place of a value along a scale; 0 is its begin, 1 its end. */
export function placeValue({ ticks, knee }, value) {
  const number = value * PERCENT;
  const top = ticks[ticks.length - 1];
  if (knee === null) return number / top;
  const ratio = number / knee;
  return (ratio < 1 ? ratio : 1 + Math.log(ratio)) / (1 + Math.log(top / knee));
}

/** The colour of a place along a scale; beyond an end it is that of the end. */
export function colourPlace({ colours }, place) {
  const at = Math.min(1, Math.max(0, place)) * (colours.length - 1);
  const first = Math.min(Math.floor(at), colours.length - 2);
  return colours[first].map((low, channel) =>
    Math.round(low + (at - first) * (colours[first + 1][channel] - low)),
  );
}

/** Colour a plane, transparent where the mask is below .1: red, green, blue and alpha. */
export function colourPlane(scale, plane, mask) {
  const table = Array.from({ length: 1025 }, (_, step) => colourPlace(scale, step / 1024));
  const data = new Uint8ClampedArray(4 * plane.length);
  plane.forEach((value, at) => {
    const step = Math.round(1024 * Math.min(1, Math.max(0, placeValue(scale, value))));
    data.set(table[step], 4 * at);
    data[4 * at + 3] = 255 * Math.min(1, Math.max(0, (mask[at] - 0.1) / 0.8));
  });
  return data;
}
