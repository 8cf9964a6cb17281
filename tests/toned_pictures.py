"""The astronaut without colour: grey, toned, printed, framed, and with one coloured object."""

from collections.abc import Callable

import numpy as np
from PIL import Image
from scipy import ndimage
from skimage import data

Tone = Callable[[np.ndarray], np.ndarray]
SEPIA = np.array([[0.393, 0.349, 0.272], [0.769, 0.686, 0.534], [0.189, 0.168, 0.131]])


def make_colour() -> np.ndarray:
    """Half of the astronaut's picture, in which the face is 54 pixels wide."""
    return np.array(data.astronaut()[:300, 50:400])


def to_grey(photo: np.ndarray) -> np.ndarray:
    return np.repeat(to_luma(photo)[..., None], 3, 2).round().astype(np.uint8)


def to_luma(photo: np.ndarray) -> np.ndarray:
    return np.asarray(photo @ np.array([0.299, 0.587, 0.114]))


def by_curve(*stops: tuple[int, int, int]) -> Tone:
    """A tone of colours that are evenly spaced over luma."""
    levels = np.linspace(0, 255, len(stops))

    def tone(photo: np.ndarray) -> np.ndarray:
        luma = to_luma(photo)
        return to_uint8(np.stack([np.interp(luma, levels, c) for c in np.transpose(stops)], -1))

    return tone


def to_uint8(values: np.ndarray) -> np.ndarray:
    return np.asarray(values.round().clip(0, 255).astype(np.uint8))


def cast(red: float, green: float, blue: float) -> Tone:
    return lambda photo: to_uint8(to_luma(photo)[..., None] * (red, green, blue))


def print_on_yellowed_paper(photo: np.ndarray) -> np.ndarray:
    """A scan of a grey print on stained paper, with the scanner's noise in every channel."""
    rng = np.random.default_rng(0)
    stains = ndimage.gaussian_filter(rng.standard_normal(photo.shape[:2]), 40)
    paper = np.array([235, 220, 185]) - np.array([4, 8, 16]) * (stains / stains.std())[..., None]
    density = 1 - to_luma(photo)[..., None] / 255
    scan = paper * (1 - density) + 30 * density
    return to_uint8(scan + rng.normal(0, 2, scan.shape))


def posterise(photo: np.ndarray) -> np.ndarray:
    return to_uint8(to_uint8(to_luma(photo) / 64)[..., None] * (64, 58, 46))


def dither(photo: np.ndarray) -> np.ndarray:
    return np.array(Image.fromarray(photo).convert("1").convert("RGB"))


def paint_lips(tone: Tone) -> Tone:
    def paint(photo: np.ndarray) -> np.ndarray:
        painted = tone(photo)
        painted[145:158, 160:188] = (190, 40, 60)
        return painted

    return paint


def colour_wall(tone: Tone) -> Tone:
    """A toned person in front of a coloured wall."""

    def paint(photo: np.ndarray) -> np.ndarray:
        rows, columns = np.mgrid[: photo.shape[0], : photo.shape[1]]
        away = np.hypot((columns - 174) / 85, (rows - 110) / 105) > 1
        return np.where((away & (rows < 200))[..., None], np.uint8((30, 90, 180)), tone(photo))

    return paint


def add_frame(tone: Tone) -> Tone:
    """A coloured frame and a stamp."""

    def paint(photo: np.ndarray) -> np.ndarray:
        framed = np.pad(tone(photo), ((60, 90), (60, 60), (0, 0)))
        inside = np.zeros(framed.shape[:2], bool)
        inside[60:-90, 60:-60] = True
        framed[~inside] = (150, 30, 40)
        framed[-140:-100, -160:-80] = (30, 60, 200)
        return framed

    return paint


TONES: dict[str, Tone] = {
    "grey": to_grey,
    "red channel": lambda photo: photo[..., :1].repeat(3, 2),
    "infra-red": lambda photo: to_uint8(photo @ np.array([0.9, 0.3, -0.2]))[..., None].repeat(3, 2),
    "sepia": lambda photo: to_uint8(photo @ SEPIA),
    "half sepia": lambda photo: to_uint8(0.5 * (photo @ SEPIA) + 0.5 * to_luma(photo)[..., None]),
    "brown sepia": by_curve((20, 10, 0), (150, 115, 80), (255, 240, 210)),
    "reddish sepia": by_curve((30, 12, 6), (160, 116, 98), (255, 242, 232)),
    "tone of skin": by_curve((10, 4, 2), (100, 58, 44), (170, 118, 98), (255, 250, 248)),
    "cyanotype": by_curve((10, 25, 60), (60, 120, 170), (240, 248, 250)),
    "duotone": by_curve((40, 0, 80), (200, 60, 120), (255, 230, 150)),
    "orange and blue": by_curve((20, 20, 90), (255, 180, 80)),
    "split tone": by_curve((0, 10, 30), (50, 66, 80), (150, 140, 125), (255, 252, 240)),
    "selenium": by_curve((8, 4, 8), (132, 124, 130), (255, 253, 254)),
    "night vision": by_curve((0, 10, 0), (20, 160, 40), (200, 255, 200)),
    "warm cast": cast(1.02, 1.0, 0.97),
    "yellow cast": cast(1.06, 1.0, 0.9),
    "cold cast": cast(0.94, 1.0, 1.05),
    "magenta cast": cast(1.03, 0.97, 1.03),
    "strong cast": cast(1.1, 0.95, 0.75),
    "yellowed print": print_on_yellowed_paper,
    "posterised": posterise,
    "one bit": dither,
    "grey with red lips": paint_lips(to_grey),
    "sepia with red lips": paint_lips(lambda photo: to_uint8(photo @ SEPIA)),
    "grey before a blue wall": colour_wall(to_grey),
    "sepia before a blue wall": colour_wall(lambda photo: to_uint8(photo @ SEPIA)),
    "grey in a red frame": add_frame(to_grey),
    "sepia in a red frame": add_frame(lambda photo: to_uint8(photo @ SEPIA)),
}
