"""A drawn eye and a drawn mouth in landmarks of the face mesh, without a face around them."""

import numpy as np
from PIL import Image, ImageDraw

from skinnet.images.faces._eyes import _EYES
from skinnet.images.faces._mesh_outlines import INNER_LIPS

SKIN, WHITE, IRIS, RED = (200, 140, 120), (215, 205, 200), (60, 40, 30), (190, 80, 80)


def place_landmarks() -> np.ndarray:
    """Landmarks with open eyes at (150, 100) and (350, 100), 100 pixels wide, and a mouth."""
    landmarks = np.full((478, 2), 250, np.float32)
    angles = np.arange(16) * 2 * np.pi / 16
    for eye, x, outwards in zip(_EYES, (150, 350), (-1, 1), strict=True):
        ellipse = [x + outwards * 50 * np.cos(angles), 100 + 18 * np.sin(angles)]
        landmarks[list(eye.contour)] = np.stack(ellipse, -1)
        ends = np.array([[0, 0], [-17, 0], [0, -17], [17, 0], [0, 17]])
        landmarks[list(eye.iris)] = ends + (x, 100)
    angles = np.pi - np.arange(20) * 2 * np.pi / 20
    lips = np.stack([250 + 60 * np.cos(angles), 300 + 25 * np.sin(angles)], -1)
    landmarks[list(INNER_LIPS)] = lips
    return landmarks


def draw_eyes(landmarks: np.ndarray, white: tuple[int, ...] = WHITE) -> np.ndarray:
    """Eyes with irises, and with highlights in their corners, uint8 [400, 500, 3]."""
    image = Image.new("RGB", (500, 400), SKIN)
    draw = ImageDraw.Draw(image)
    for eye in _EYES:
        draw.polygon([tuple(point) for point in landmarks[list(eye.contour)].tolist()], white)
        x, y = landmarks[eye.iris[0]].tolist()
        draw.ellipse((x - 17, y - 17, x + 17, y + 17), IRIS)
        draw.ellipse((x + 26, y - 4, x + 32, y + 2), (255, 255, 255))
    return np.array(image)


def draw_mouth(landmarks: np.ndarray, teeth: tuple[int, ...] = WHITE) -> np.ndarray:
    """An open mouth with upper teeth above a tongue, uint8 [400, 500, 3]."""
    image = Image.new("RGB", (500, 400), SKIN)
    draw = ImageDraw.Draw(image)
    draw.polygon([tuple(point) for point in landmarks[list(INNER_LIPS)].tolist()], RED)
    draw.rectangle((215, 285, 285, 300), teeth)
    return np.array(image)
