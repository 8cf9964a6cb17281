/** Attention Mesh (Grishchenko et al. 2020): landmarks of a face, and whether it is one. */

import { clamp } from "./rounding.js";
import { cutSquare, placePoint } from "./turned_square.js";

const SIZE = 192; // side of the network's input, in pixels

const MESH_POINTS = 468;

const RIGHT_EYE = [
  33, 7, 163, 144, 145, 153, 154, 155, 133, 246, 161, 160, 159, 158, 157, 173, 130, 25, 110, 24,
  23, 22, 26, 112, 243, 247, 30, 29, 27, 28, 56, 190, 226, 31, 228, 229, 230, 231, 232, 233,
  244, 113, 225, 224, 223, 222, 221, 189, 35, 124, 46, 53, 52, 65, 143, 111, 117, 118, 119, 120,
  121, 128, 245, 156, 70, 63, 105, 66, 107, 55, 193,
];

const LEFT_EYE = [
  263, 249, 390, 373, 374, 380, 381, 382, 362, 466, 388, 387, 386, 385, 384, 398, 359, 255, 339,
  254, 253, 252, 256, 341, 463, 467, 260, 259, 257, 258, 286, 414, 446, 261, 448, 449, 450, 451,
  452, 453, 464, 342, 445, 444, 443, 442, 441, 413, 265, 353, 276, 283, 282, 295, 372, 340, 346,
  347, 348, 349, 350, 357, 465, 383, 300, 293, 334, 296, 336, 285, 417,
];

const LIPS = [
  61, 146, 91, 181, 84, 17, 314, 405, 321, 375, 291, 185, 40, 39, 37, 0, 267, 269, 270, 409, 78,
  95, 88, 178, 87, 14, 317, 402, 318, 324, 308, 191, 80, 81, 82, 13, 312, 311, 310, 415, 76, 77,
  90, 180, 85, 16, 315, 404, 320, 307, 306, 184, 74, 73, 72, 11, 302, 303, 304, 408, 62, 96, 89,
  179, 86, 15, 316, 403, 319, 325, 292, 183, 42, 41, 38, 12, 268, 271, 272, 407,
];

/** Landmarks that an output gives more precisely. The network names sides as the picture has them. */
const REFINED = {
  "output_right_eye:0": LEFT_EYE,
  "output_left_eye:0": RIGHT_EYE,
  output_lips: LIPS,
};

/** Landmarks [x, y] in the photograph, and the log odds of a face, in a square around a head. */
export async function findLandmarks(networks, photo, square) {
  const cut = cutSquare(square, photo, SIZE);
  const input = new Float32Array(cut.data.length); // filled by a loop, which is quicker than `from`
  for (let at = 0; at < input.length; at++) input[at] = cut.data[at] / 255;
  const outputs = await networks.run("face_mesh", { input_1: [input, [1, SIZE, SIZE, 3]] });
  const mesh = outputs.output_mesh_identity;
  const points = Array.from({ length: MESH_POINTS }, (_, at) => [mesh[3 * at], mesh[3 * at + 1]]);
  for (const [name, indices] of Object.entries(REFINED)) {
    indices.forEach((point, at) => {
      points[point] = [outputs[name][2 * at], outputs[name][2 * at + 1]];
    });
  }
  return {
    landmarks: points.map((point) => placePoint(square, SIZE, point).map(Math.fround)),
    odds: clamp(outputs.conv_faceflag[0], -30, 30),
  };
}
