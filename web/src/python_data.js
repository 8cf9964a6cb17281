/** Written by `python -m tools.page_data`; do not change it by hand. */

export const SENTENCES = {
  "melaninDoubt": "Melanin cannot be told well from this photograph: that of {who} may be {melanin} times higher or lower than what is read.",
  "hemoglobinDoubt": "Hemoglobin cannot be told from this photograph: what is read of {who} is near that of people at large.",
  "lightDoubt": "The light on {who} is strongly coloured, or the camera's white balance is wrong; the pigments are only as right as the guess of it.",
  "daylight": "Give a photograph in daylight, without coloured light, filters or retouching.",
  "whiteDoubt": "The white balance that was given for {who} is far from what is seen without it: log R/G and log B/G are {told}, and not {blind}. Is the reference white or grey, and lit as the face is?",
  "darkSkin": "Dark skin is often read as paler than it is, the more so in dark photographs: the melanin of {who} may be above its interval. A photograph with a brighter exposure helps.",
  "clipped": "{share} of the skin of {who} is overexposed: its colour is lost, and its pigments are read too low. Give a photograph with a shorter exposure.",
  "small": "{who} is {width} pixels wide, and {_LEAST_WIDTH} are needed; give the picture at its full size.",
  "outside": "{who} is only {inside} inside the picture, and half of it is needed; give a picture of the whole face.",
  "partlyOutside": "{who} is only {inside} inside the picture; its means are those of this part.",
  "drawn": "{who} seems to be drawn: {share} of it has one and the same colour. Give a photograph.",
  "noColour": "There is no colour in {name}: {tone}. Melanin and hemoglobin cannot be read from it; ",
  "tooDark": "it is too dark, give a brighter one.",
  "giveColour": "give the colour photograph.",
  "greySkin": "the skin in it is grey",
  "tone": "it has one tone of {cells}; its pixels lie {distance} of 255 levels from it",
  "grey": "it is grey"
};

export const DOUBTS = {
  "MELANIN_SPAN": 3.0,
  "HEMOGLOBIN_SPAN": 5.0,
  "COLOURED": 0.35,
  "CLIPPED_SHARE": 0.1,
  "DARK_SKIN": 0.12
};

export const BALANCES = {
  "MOST_BLIND": 0.3
};

export const FACES = {
  "LEAST_WIDTH": 24,
  "LEAST_INSIDE": 0.5,
  "MOST_INSIDE": 0.9,
  "COLOUR_SIZE": 512,
  "FLAT_SIZE": 96,
  "STEPS": 32,
  "FLAT_SHARE": 0.25,
  "COLOUR_WIDTH": 5,
  "MIDDLE": 160.0,
  "DARK": 24,
  "WHITE": 250
};

export const COLOUR = {
  "PIXELS": 128,
  "CELLS": 12,
  "KNOTS": 7,
  "LUMA_CHROMA": [
    [
      0.299,
      -0.168736,
      0.5
    ],
    [
      0.587,
      -0.331264,
      -0.418688
    ],
    [
      0.114,
      0.5,
      -0.081312
    ]
  ],
  "FACE_MARGIN": 1.25,
  "CLOSE_UP": 2.5,
  "GREY": 0.1,
  "HEAD": [
    -3.45,
    5.83,
    1.69,
    3.42,
    -2.87,
    6.53,
    2.85,
    -9.3,
    -10.99,
    -10.56,
    -4.33
  ],
  "FACE": [
    0.6,
    4.43,
    2.82,
    -0.05,
    -3.68,
    8.74,
    3.2,
    -9.93,
    -13.64,
    -13.46,
    5.06
  ],
  "HEAD_LIMIT": -1.6,
  "FACE_LIMIT": -3.0,
  "ON_CURVE": -2.4,
  "DARK": 50.0,
  "TINTS": [
    "red",
    "brown (sepia)",
    "yellow",
    "green",
    "blue-green",
    "blue (cyanotype)",
    "violet",
    "purple"
  ]
};

export const SKIN = {
  "SKIN": [
    0.757,
    -0.296
  ],
  "SKIN_PRECISION": [
    [
      37.1,
      13.6
    ],
    [
      13.6,
      33.4
    ]
  ],
  "AREAS": [
    [
      0.18,
      0.5,
      0.38,
      0.7
    ],
    [
      0.62,
      0.5,
      0.82,
      0.7
    ],
    [
      0.42,
      0.4,
      0.58,
      0.62
    ],
    [
      0.35,
      0.1,
      0.65,
      0.22
    ]
  ]
};
