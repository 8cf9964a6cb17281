"""The face mesh: 478 landmarks of a face, and whether it is one."""

import numpy as np
from numpy.typing import NDArray

from skinnet.images.faces._face_models import run_face_model
from skinnet.images.faces._turned_square import TurnedSquare

_SIZE = 192
"""Side of the network's input, in pixels."""

MESH_POINTS, IRIS_POINTS = 468, 5
"""Landmarks of the mesh, which the irises follow: each its centre, then its right, upper, left and
lower end."""

_RIGHT_EYE = (
    *(33, 7, 163, 144, 145, 153, 154, 155, 133, 246, 161, 160, 159, 158, 157, 173),
    *(130, 25, 110, 24, 23, 22, 26, 112, 243, 247, 30, 29, 27, 28, 56, 190),
    *(226, 31, 228, 229, 230, 231, 232, 233, 244, 113, 225, 224, 223, 222, 221, 189),
    *(35, 124, 46, 53, 52, 65, 143, 111, 117, 118, 119, 120, 121, 128, 245),
    *(156, 70, 63, 105, 66, 107, 55, 193),
)
_LEFT_EYE = (
    *(263, 249, 390, 373, 374, 380, 381, 382, 362, 466, 388, 387, 386, 385, 384, 398),
    *(359, 255, 339, 254, 253, 252, 256, 341, 463, 467, 260, 259, 257, 258, 286, 414),
    *(446, 261, 448, 449, 450, 451, 452, 453, 464, 342, 445, 444, 443, 442, 441, 413),
    *(265, 353, 276, 283, 282, 295, 372, 340, 346, 347, 348, 349, 350, 357, 465),
    *(383, 300, 293, 334, 296, 336, 285, 417),
)
_LIPS = (
    *(61, 146, 91, 181, 84, 17, 314, 405, 321, 375, 291, 185, 40, 39, 37, 0, 267, 269, 270, 409),
    *(78, 95, 88, 178, 87, 14, 317, 402, 318, 324, 308, 191, 80, 81, 82, 13, 312, 311, 310, 415),
    *(76, 77, 90, 180, 85, 16, 315, 404, 320, 307, 306, 184, 74, 73, 72, 11, 302, 303, 304, 408),
    *(62, 96, 89, 179, 86, 15, 316, 403, 319, 325, 292, 183, 42, 41, 38, 12, 268, 271, 272, 407),
)
_REFINED = {
    "output_right_eye:0": _LEFT_EYE,
    "output_left_eye:0": _RIGHT_EYE,
    "output_lips": _LIPS,
}
"""Landmarks that an output of the network gives more precisely. The network names sides as the
picture shows them, and we name the person's."""


def find_landmarks(
    photo: NDArray[np.uint8], square: TurnedSquare
) -> tuple[NDArray[np.float32], float]:
    """Find the landmarks of the face in a square of a photograph.

    Args:
        photo: uint8 sRGB [H, W, 3].
        square: A square around the head, turned as it is.

    Returns:
        Columns and rows [478, 2] in the photograph, and the log odds of a face in [-30, 30].

    Source:
        Attention Mesh (Grishchenko et al. 2020), as MediaPipe publishes it.
    """
    image = square.cut(photo, _SIZE).astype(np.float32) / np.float32(255)
    outputs = run_face_model("face_mesh", image)
    points = np.empty((MESH_POINTS + 2 * IRIS_POINTS, 2))
    points[:MESH_POINTS] = outputs["output_mesh_identity"].reshape(-1, 3)[:, :2]
    for name, indices in _REFINED.items():
        points[list(indices)] = outputs[name].reshape(-1, 2)
    points[-10:-5] = outputs["output_left_iris:0"].reshape(-1, 2)
    points[-5:] = outputs["output_right_iris:0"].reshape(-1, 2)
    odds = float(np.clip(outputs["conv_faceflag"].item(), -30, 30))
    return square.place(points, _SIZE).astype(np.float32), odds
