import numpy as np

from skinnet.images.faces._face_mesh import find_landmarks
from skinnet.images.faces._turned_square import TurnedSquare

ROUND_A_FACE = TurnedSquare(224, 112, 168, 0.05)

MEDIAPIPE = {
    **{1: (97.58, 116.70), 10: (97.68, 45.07), 152: (96.91, 171.84)},
    **{234: (44.68, 96.87), 454: (150.20, 97.45)},
    **{33: (62.10, 84.57), 133: (83.76, 86.87), 159: (70.90, 80.74), 145: (71.98, 88.32)},
    **{263: (132.02, 85.95), 362: (110.94, 87.63), 386: (123.34, 81.11), 374: (121.89, 88.59)},
    **{61: (72.51, 128.13), 291: (122.07, 127.78), 0: (97.19, 128.54)},
    **{17: (96.77, 145.82), 13: (97.20, 131.88), 14: (96.88, 139.94)},
    **{468: (72.07, 84.90), 469: (77.08, 84.95), 471: (66.99, 84.84)},
    **{473: (121.44, 85.00), 474: (126.34, 84.85), 476: (116.58, 85.12)},
}
"""Columns and rows that FaceLandmarkCpu of mediapipe 0.10.21, with attention, gives for the cut
square of 192 pixels."""


def test_landmarks_are_those_of_mediapipe(astronaut: np.ndarray) -> None:
    cut = ROUND_A_FACE.cut(astronaut, 192)
    landmarks, odds = find_landmarks(cut, TurnedSquare(96, 96, 192))
    assert np.allclose(landmarks[list(MEDIAPIPE)], list(MEDIAPIPE.values()), atol=0.05)
    assert odds > 20


def test_landmarks_are_placed_in_the_photograph(astronaut: np.ndarray) -> None:
    landmarks, _ = find_landmarks(astronaut, ROUND_A_FACE)
    expected = ROUND_A_FACE.place(np.array(list(MEDIAPIPE.values())), 192)
    assert np.allclose(landmarks[list(MEDIAPIPE)], expected, atol=0.05)
