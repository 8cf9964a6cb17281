/** Written by `python -m tools.page_data`; do not change it by hand. */

export const SENTENCES = {
  melaninDoubt: "Melanin cannot be told well from this photograph: that of {who} may be {melanin} times higher or lower than what is read.",
  hemoglobinDoubt: "Hemoglobin cannot be told from this photograph: what is read of {who} is near that of people at large.",
  lightDoubt: "The light on {who} is strongly coloured, or the camera's white balance is wrong; the pigments are only as right as the guess of it.",
  tinted: "The skin of {who} looks tinted {tint}, as by coloured light, a filter or a wrong white balance; the pigments are only as right as the guess of it.",
  noSkin: "No skin was found of {who}; give a picture in which nothing covers it.",
  littleSkin: "Nearly no skin of {who} was found: only {value} % of what was read. Its means are those of this part, which may be something else; the mask shows where it is.",
  daylight: "Give a photograph in daylight, without coloured light, filters or retouching.",
  whiteDoubt: "The white balance that was given for {who} is far from what is seen without it: log R/G and log B/G are {told}, and not {blind}. Is the reference white or grey, and lit as the face is?",
  darkSkin: "Dark skin is often read as paler than it is, the more so in dark photographs: the melanin of {who} may be above its interval. A photograph with a brighter exposure helps.",
  clipped: "{share} of the skin of {who} is overexposed: its colour is lost, and its pigments are read too low. Give a photograph with a shorter exposure.",
  small: "{who} is {width} pixels wide, and {_LEAST_WIDTH} are needed; give the picture at its full size.",
  outside: "{who} is only {inside} inside the picture, and half of it is needed; give a picture of the whole face.",
  partlyOutside: "{who} is only {inside} inside the picture; its means are those of this part.",
  drawn: "{who} seems to be drawn: {share} of it has one and the same colour. Give a photograph.",
  noColour: "There is no colour in {name}: {tone}. Melanin and hemoglobin cannot be read from it; ",
  tooDark: "it is too dark, give a brighter one.",
  giveColour: "give the colour photograph.",
  greySkin: "the skin in it is grey",
  tone: "it has one tone of {cells}; its pixels lie {distance} of 255 levels from it",
  grey: "it is grey",
};

export const DOUBTS = {
  MELANIN_SPAN: 3.0,
  HEMOGLOBIN_SPAN: 5.0,
  COLOURED: 0.35,
  CLIPPED_SHARE: 0.1,
  DARK_SKIN: 0.12,
  TINTED: 10.0,
  CASTS: ["red", "orange", "yellow", "green", "blue-green", "blue", "violet", "purple"],
  LITTLE_SKIN: 0.1,
};

export const BALANCES = {
  MOST_BLIND: 0.3,
};

export const FACES = {
  LEAST_WIDTH: 24,
  LEAST_INSIDE: 0.5,
  MOST_INSIDE: 0.9,
  COLOUR_SIZE: 512,
  FLAT_SIZE: 96,
  STEPS: 32,
  FLAT_SHARE: 0.25,
  COLOUR_WIDTH: 5,
  MIDDLE: 160.0,
  DARK: 24,
  WHITE: 250,
};

export const COLOUR = {
  PIXELS: 128,
  CELLS: 12,
  KNOTS: 7,
  LUMA_CHROMA: [[0.299, -0.168736, 0.5], [0.587, -0.331264, -0.418688], [0.114, 0.5, -0.081312]],
  FACE_MARGIN: 1.25,
  CLOSE_UP: 2.5,
  GREY: 0.1,
  HEAD: [-3.45, 5.83, 1.69, 3.42, -2.87, 6.53, 2.85, -9.3, -10.99, -10.56, -4.33],
  FACE: [0.6, 4.43, 2.82, -0.05, -3.68, 8.74, 3.2, -9.93, -13.64, -13.46, 5.06],
  HEAD_LIMIT: -1.6,
  FACE_LIMIT: -3.0,
  ON_CURVE: -2.4,
  DARK: 50.0,
  TINTS: ["red", "brown (sepia)", "yellow", "green", "blue-green", "blue (cyanotype)", "violet", "purple"],
};

export const SKIN = {
  USUAL_RATIOS: [0.757, -0.296],
  SKIN_PRECISION: [[37.1, 13.6], [13.6, 33.4]],
  MIN_COVARIANCE: [[0.0036, 0.0, 0.0], [0.0, 0.004900000000000001, 0.0], [0.0, 0.0, 0.1024]],
  SPECULAR_SHARES: [0.15, 0.3, 0.45, 0.6, 0.75, 0.9],
  LOWEST: [-1.2, -3.0, -7.2],
  BIN: [0.1, 0.1, 0.3],
  BINS: [34, 42, 26],
  UNSEEN: 0.2,
  AREAS: [[0.18, 0.5, 0.38, 0.7], [0.62, 0.5, 0.82, 0.7], [0.42, 0.4, 0.58, 0.62], [0.35, 0.1, 0.65, 0.22]],
};

export const MASK = {
  FACE_SIZE: 192,
  SHADING: [[0.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.09]],
  LEAST_EVIDENCE: -5.5,
  MOST_EVIDENCE: 4.0,
  LEAST_PRIOR: 0.03,
  FACE_ODDS: 2.0,
  BEARD_ODDS: 1.0,
  NECK_ODDS: 1.5,
  LIPS_ODDS: 2.0,
  LIPS: [[-0.3, -0.1, -1.5], [0.75, 0.65, 1.3]],
  LIPS_WIDTH: [0.1, 0.1, 0.3],
  BEARD_DARKNESS: 0.4,
  BEARD_ROUGHNESS: 1.4,
  LEAST_BEARD: 0.02,
  EDGE_RADIUS: 0.016,
  EDGE_VARIANCE: 0.0003,
};

export const GAPS = {
  LARGEST_HOLE: 0.15,
  SHADOW: 0.35,
  HIGHLIGHT: 0.4,
  LOWER_FACE: 0.1,
  MOST_OFF: 0.8,
  LEAST_BEARD: 0.01,
  ABOVE: [0.2, 0.35, 0.5],
};

export const COVER = {
  LEAST_EYES: 0.6,
  LEAST_SHARE: 0.06,
};

export const OUTLINES = {
  OVAL: [10, 338, 297, 332, 284, 251, 389, 356, 454, 323, 361, 288, 397, 365, 379, 378, 400, 377, 152, 148, 176, 149, 150, 136, 172, 58, 132, 93, 234, 127, 162, 21, 54, 103, 67, 109],
  BROWS: [[70, 63, 105, 66, 107, 55, 65, 52, 53, 46], [300, 293, 334, 296, 336, 285, 295, 282, 283, 276]],
  NOSTRILS: [98, 240, 64, 48, 115, 220, 45, 4, 275, 440, 344, 278, 294, 460, 327, 326, 2, 97],
  JAW: [132, 58, 172, 136, 150, 149, 176, 148, 152, 377, 400, 378, 379, 365, 397, 288, 361],
  BEARD: [234, 132, 58, 172, 136, 150, 149, 176, 148, 152, 377, 400, 378, 379, 365, 397, 288, 361, 454, 425, 327, 2, 98, 205],
  CHIN_PAD: [200, 201, 208, 171, 152, 396, 428, 421],
  CLOTH: [6, 117, 123, 132, 58, 172, 136, 150, 149, 176, 148, 152, 377, 400, 378, 379, 365, 397, 288, 361, 352, 346],
  NECK: 0.45,
  RIGHT_EYE: [33, 7, 163, 144, 145, 153, 154, 155, 133, 173, 157, 158, 159, 160, 161, 246],
  LEFT_EYE: [263, 249, 390, 373, 374, 380, 381, 382, 362, 398, 384, 385, 386, 387, 388, 466],
  LIPS: [61, 146, 91, 181, 84, 17, 314, 405, 321, 375, 291, 409, 270, 269, 267, 0, 37, 39, 40, 185],
  INNER_LIPS: [78, 95, 88, 178, 87, 14, 317, 402, 318, 324, 308, 415, 310, 311, 312, 13, 82, 81, 80, 191],
  BROW: 9,
  CHIN: 152,
};
