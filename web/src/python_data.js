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
  noFace: "No face was found in the {_number} frames of the video.",
  framesWithoutFace: "{lost} of {value} frames show no face.",
  cut: "There is a cut at {time} s: what follows is a shot with a baseline of its own.",
  noSkinInVideo: "No skin was found in the face of the video; give a video that shows it uncovered.",
  compressed: "{name} has only {bits} bits a pixel: such compression leaves wrong colours for seconds, and hides the pulse. Intervals are wider; record with less compression.",
  shotRefused: "The shot from {start} s is not read: {refusal}",
  unclear: "In single frames, changes of blood below about {percent} % cannot be told from none in this face: {why}",
  unreadable: "Changes of blood cannot be read in this face: in single frames, only those above about {percent} % can be told from none. {value}{value}",
  whyUnclear: "its skin is dark, its light changes, or the video is compressed strongly.",
  disclaimer: "This is no medical device: it must not be used to diagnose, treat or monitor. It measures colour, not health.",
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

export const REGION_OUTLINES = {
  WHOLE: {"forehead": [[10, 109, 67, 103, 104, 105, 66, 107, 9, 336, 296, 334, 333, 332, 297, 338], []], "nose": [[6, 122, 174, 198, 49, 220, 45, 4, 275, 440, 279, 420, 399, 351], []], "lips": [[61, 146, 91, 181, 84, 17, 314, 405, 321, 375, 291, 409, 270, 269, 267, 0, 37, 39, 40, 185], [78, 95, 88, 178, 87, 14, 317, 402, 318, 324, 308, 415, 310, 311, 312, 13, 82, 81, 80, 191]], "chin": [[182, 83, 18, 313, 406, 418, 262, 369, 396, 175, 171, 140, 32, 194], []]},
  CHEEKS: [[[117, 118, 101, 36, 205, 187, 123], []], [[346, 347, 330, 266, 425, 411, 352], []]],
  LEAST_AREA: 0.3,
};

export const REGIONS = {
  NAMES: ["face", "forehead", "left_cheek", "right_cheek", "nose", "lips", "chin"],
  REGIONS: ["forehead", "left_cheek", "right_cheek", "nose", "lips", "chin"],
  FACE: "face",
};

export const STATES = {
  READ: "read",
  LOST: "lost",
  HIDDEN: "hidden",
};

export const INTERVAL = {
  QUANTILE: 1.645,
};

export const LEAST_CHANGE = {
  MUCH: 0.12,
  UNREADABLE: 0.5,
};

export const FOLLOWER = {
  LEAST_ODDS: 0.0,
  SEARCH: 0.25,
  MARGIN: 1.5,
  SMOOTH: 0.15,
  CUT: 0.35,
  THUMBNAIL: [32, 18],
};

export const TEXTURE = {
  SIZE: 96,
  MARGIN: 1.28,
};

export const FRAME_COLOURS = {
  BRIGHTEST: 0.94,
  DARKEST: 0.0025,
};

export const TONE_CURVE = {
  STEPS: 2048,
};

export const TONE_DOUBT = {
  BEND_SD: 0.15,
  STEP: 0.02,
  LEAST: 1e-06,
  USUAL_BEND: 0.12,
};

export const COLOUR_TABLE = {
  NODES: [192, 128],
  SHADING: 0.25,
};

export const RESTING = {
  MOST_GLOSS: 0.5,
  LEAST: 0.0001,
};

export const RESPONSE = {
  RANGE: 1.6,
  NODES: 65,
  LEAST_COLOUR: 0.0001,
  ROUNDS: 4,
  ANSWER: [0.64, -0.0765],
  GAIN_SD: 2.0,
};

export const NOISE = {
  SECONDS: 2.0,
  MOST: 16.0,
  FLOOR: 0.0003,
};

export const SLOW_ERRORS = {
  PATCH: 8,
  LEAST_FILLED: 0.25,
  SMOOTH: 0.5,
  SECONDS: 2.0,
};

export const LOOKS = {
  SPACING: 2.0,
  MOST: 16,
  LEAST: 0.0001,
  CUT: 1.5,
  LEAST_SPREAD: 0.01,
  ROUNDS: 3,
};

export const BASELINE = {
  LEAST_TEXELS: 12,
  LEAST_SHARE: 0.4,
  MOST_CHROMA: 0.5,
};

export const FRAME_NOISE = {
  CHROMA_BY_BEND: 0.05,
  MOST_FACTOR: 25.0,
};

export const CHANGE_SCALE = {
  SCALE_SD: 0.22,
  SCALE_BY_TONE: [0.1, 0.3],
  MOST_SCALE_SD: 0.45,
};

export const CHANGE_MAP = {
  BLUR: 2.5,
  LEAST_SEEN: 0.2,
  NOISE_SD: 0.012,
  GLOSS_SD: 0.006,
  LIGHT_SD: 2.0,
  STEP: 0.1,
  LEAST_COLOUR: 0.0001,
};

export const SHOT = {
  MOST_BUFFERED: 1200,
  GLOSS_SD: 0.006,
  GLOSS_BY_BEND: 0.5,
  GLOSS_BY_SHADING: 0.5,
};

export const TRACKER = {
  BASELINE: [0.0, 3.0],
  LOOKS: 5,
};

export const STILL = {
  BLOCK: 8,
  MOST_BLOCK: 4.0,
  MOST_MEAN: 1.2,
  LEAST_SECONDS: 1.0,
};

export const FILES = {
  LEAST_BITS: 0.05,
};

export const CHANGES = {
  LARGEST_CHANGE: 0.6,
  CHANGE: [[5, 48, 97], [33, 102, 172], [67, 147, 195], [146, 197, 222], [209, 229, 240], [247, 247, 247], [253, 219, 199], [244, 165, 130], [214, 96, 77], [178, 24, 43], [103, 0, 31]],
};

export const COURSE = {
  COLOURS: {"face": [38, 38, 40], "forehead": [0, 114, 178], "left_cheek": [213, 94, 0], "right_cheek": [204, 121, 167], "nose": [0, 158, 115], "lips": [200, 30, 45], "chin": [150, 120, 40]},
  SHOWN: 0.08,
};

export const TRACK_TABLE = {
  FIELDS: ["hemoglobin", "hemoglobin_low", "hemoglobin_high", "log_ratio", "log_ratio_sd"],
  LEVEL: 0.9,
};
