"""Pictures of colour charts in perspective, with known light, camera and white."""

import math
from io import BytesIO
from typing import NamedTuple

import colour
import numpy as np
from numpy.typing import NDArray
from PIL import Image
from scipy import ndimage

from skinnet.images import linear_to_srgb, to_uint8
from skinnet.physics import load_cameras, load_observer, spectrum_to_srgb

LIGHTS = (
    *("A", "C", "D50", "D55", "D65", "D75", "E", "FL1", "FL2", "FL3.5"),
    *("FL4", "FL7", "FL8", "FL11", "HP4", "LED-B1", "LED-B3", "LED-B5", "LED-RGB1", "LED-V1"),
)
"""Lights of the pictures, as colour-science names them."""

_ROWS, _COLUMNS = 4, 6
_WIDTH, _HEIGHT = 1080, 810
_PATCH, _BORDER = 0.84, 0.3
"""Side of a patch, and width of the frame around all of them, in distances between patches."""

_FRAME = 0.035
_SUPERSAMPLED = 2
_SHAPE = colour.SpectralShape(400, 720, 10)

Array = NDArray[np.float64]


class View(NamedTuple):
    """How a chart is photographed.

    Attributes:
        light: Name of the light.
        sensor: Number of the measured camera.
        tilt: Angle between the chart's normal and the view, in degrees.
        axis: Direction in the chart about which it is tilted, in degrees.
        roll: Turn in the picture, in degrees.
        width: Width of the chart over that of the picture.
        balance: Log errors of R/G and B/G.
        exposure: Luminance of a white diffuser at the chart's middle.
        falloff: Change of the light over the chart's width, as a share.
        shade: Light in the shade over that outside of it; 1 for no shade.
        shaded: Share of the chart's width that lies in the shade.
        contrast: Log contrast of the tone curve.
        bend: Bend of the tone curve.
        noise: Standard deviation of the noise in display sRGB.
        quality: Quality of JPEG.
        seed: Seed of the background and the noise.
    """

    light: str
    sensor: int = 0
    tilt: float = 0.0
    axis: float = 0.0
    roll: float = 0.0
    width: float = 0.5
    balance: tuple[float, float] = (0.0, 0.0)
    exposure: float = 0.75
    falloff: float = 0.0
    shade: float = 1.0
    shaded: float = 0.0
    contrast: float = 0.0
    bend: float = 0.0
    noise: float = 0.004
    quality: int = 92
    seed: int = 0


def load_patches() -> Array:
    """Load the reflectance [24, 33] of the patches of a classic chart.

    It is another copy than those whose mean the reading takes as the truth.
    """
    spectra = colour.SDS_COLOURCHECKERS["ColorChecker N Ohta"].values()
    return np.array([each.copy().align(_SHAPE).values for each in spectra])


def load_light(name: str) -> Array:
    """Load the power [33] of a light, averaged over the bands."""
    fine = colour.SDS_ILLUMINANTS[name].copy().align(colour.SpectralShape(380, 780, 5))
    five = np.interp(np.arange(390, 731), fine.wavelengths, fine.values)
    return np.array([five[at - 395 : at - 385 + 1].mean() for at in range(400, 721, 10)])


def make_matrix(view: View) -> Array:
    """Make the matrix [33, 3] from a spectrum to the linear sRGB of the view's camera."""
    import torch

    curves = list(load_cameras().values())[view.sensor]
    red, blue = view.balance
    gain = torch.tensor((red, 0.0, blue), dtype=torch.float64).exp()
    power = torch.from_numpy(load_light(view.light))
    return np.asarray(spectrum_to_srgb(power, curves, load_observer(), gain))


def find_white(view: View) -> Array:
    """Find the linear sRGB [3] of a white diffuser at the chart's middle, before the tone curve."""
    white = make_matrix(view).sum(0)
    return np.asarray(view.exposure * white / (white @ (0.2126, 0.7152, 0.0722)))


def photograph(view: View, patches: Array | None = None) -> NDArray[np.uint8]:
    """Photograph a chart.

    Args:
        view: Light, camera, place, shade and noise.
        patches: Reflectance [rows, columns, 33]; None: those of the classic chart.

    Returns:
        uint8 sRGB [H, W, 3].
    """
    rng = np.random.default_rng(view.seed)
    grid = load_patches().reshape(_ROWS, _COLUMNS, -1) if patches is None else patches
    place = _trace(view, grid.shape[:2])
    colours = grid @ make_matrix(view)
    linear = _paint(place, colours, _paint_wall(rng)) * _light(place, view, grid.shape[1])
    white = make_matrix(view).sum(0)
    linear = linear * view.exposure / (white @ (0.2126, 0.7152, 0.0722))
    small = linear.reshape(_HEIGHT, _SUPERSAMPLED, _WIDTH, _SUPERSAMPLED, 3).mean((1, 3))
    return _develop(small, view, rng)


def place_corners(view: View, shape: tuple[int, int] = (_ROWS, _COLUMNS)) -> Array:
    """Find the columns and rows [4, 2] of the corners of the grid of patches."""
    rows, columns = shape
    corners = np.array([(0, 0), (columns, 0), (columns, rows), (0, rows)], float)
    return _project(view, corners, shape)


def _project(view: View, points: Array, shape: tuple[int, int]) -> Array:
    homogeneous = np.c_[points, np.ones(len(points))] @ _make_homography(view, shape).T
    return np.asarray(homogeneous[:, :2] / homogeneous[:, 2:])


def _make_homography(view: View, shape: tuple[int, int]) -> Array:
    """From columns and rows of patches to pixels: a pinhole camera before a tilted plane."""
    rows, columns = shape
    scale = view.width * _WIDTH / columns
    tilt, axis, roll = (math.radians(each) for each in (view.tilt, view.axis, view.roll))
    centre = np.array([[1, 0, -columns / 2], [0, 1, -rows / 2], [0, 0, 1.0]])
    c, s = math.cos(axis), math.sin(axis)
    along = np.array([[c, s], [-s, c]])
    squeeze = along.T @ np.diag((1, math.cos(tilt))) @ along
    depth = math.sin(tilt) * along[1] / (3 * columns)
    plane = np.array([[*squeeze[0], 0], [*squeeze[1], 0], [*depth, 1]])
    c, s = scale * math.cos(roll), scale * math.sin(roll)
    turn = np.array([[c, -s, _WIDTH / 2], [s, c, _HEIGHT / 2], [0, 0, 1]])
    return np.asarray(turn @ plane @ centre)


def _trace(view: View, shape: tuple[int, int]) -> Array:
    """Column and row of the chart [H, W, 2] that each supersampled pixel sees."""
    step = 1 / _SUPERSAMPLED
    x = (np.arange(_WIDTH * _SUPERSAMPLED) + 0.5) * step
    y = (np.arange(_HEIGHT * _SUPERSAMPLED) + 0.5) * step
    grid = np.stack(np.broadcast_arrays(x, y[:, None], np.ones(1)), -1)
    seen = grid @ np.linalg.inv(_make_homography(view, shape)).T
    return np.asarray(seen[..., :2] / seen[..., 2:])


def _paint(place: Array, colours: Array, wall: Array) -> Array:
    rows, columns = colours.shape[:2]
    column, row = np.moveaxis(place, -1, 0)
    i, j = np.floor(row).astype(int), np.floor(column).astype(int)
    inside = (i >= 0) & (i < rows) & (j >= 0) & (j < columns)
    patch = inside & (np.maximum(np.abs(row - i - 0.5), np.abs(column - j - 0.5)) < _PATCH / 2)
    beyond = np.maximum(np.maximum(-row, row - rows), np.maximum(-column, column - columns))
    frame = beyond < _BORDER
    picture = np.where(frame[..., None], _FRAME, wall)
    picture[patch] = colours[i[patch], j[patch]]
    return picture


def _paint_wall(rng: np.random.Generator) -> Array:
    """A wall of any colour, with rectangles of other colours on it."""
    shape = _HEIGHT * _SUPERSAMPLED, _WIDTH * _SUPERSAMPLED
    wall = np.full((*shape, 3), rng.uniform(0.1, 0.7) * rng.uniform(0.8, 1.2, 3))
    for _ in range(rng.integers(3, 9)):
        height, width = (rng.integers(20, side // 3) for side in shape)
        top, left = (rng.integers(0, side) for side in shape)
        wall[top : top + height, left : left + width] = rng.uniform(0.02, 0.9, 3)
    return wall


def _light(place: Array, view: View, columns: int) -> Array:
    across = place[..., :1] / columns
    light = 1 + view.falloff * (across - 0.5)
    shade = ndimage.gaussian_filter((across[..., 0] < view.shaded).astype(float), 4)[..., None]
    return np.asarray(light.clip(0.3, 1.7) * (1 - (1 - view.shade) * shade * (view.shaded > 0)))


def _develop(linear: Array, view: View, rng: np.random.Generator) -> NDArray[np.uint8]:
    blurred = ndimage.gaussian_filter(linear.clip(0), (0.7, 0.7, 0))
    display = bend_tones(blurred, view.contrast, view.bend)
    noisy = display + rng.normal(0, view.noise, display.shape)
    data = BytesIO()
    Image.fromarray(to_uint8(noisy)).save(data, "JPEG", quality=view.quality)
    return np.array(Image.open(data))


def bend_tones(linear: Array, contrast: float, bend: float) -> Array:
    """Turn linear light into display sRGB by the tone curve of the synthetic renderer."""
    display = linear_to_srgb(0.18 * (linear / 0.18 + 1e-6) ** math.exp(contrast)).astype(float)
    return np.asarray((display + bend * display * (1 - display) * (2 * display - 1)).clip(0, 1))


def sample_view(light: str, rng: np.random.Generator, shaded: bool, seed: int) -> View:
    """Sample a view under a light, tilted by up to 30 degrees."""
    return View(
        light,
        sensor=int(rng.integers(len(load_cameras()))),
        tilt=rng.uniform(0, 30),
        axis=rng.uniform(0, 360),
        roll=rng.uniform(-20, 20) + rng.choice([0, 90, 180, 270], p=(0.7, 0.1, 0.1, 0.1)),
        width=rng.uniform(0.3, 0.6),
        balance=tuple(rng.normal(0, 0.1, 2)),
        exposure=rng.uniform(0.5, 0.85),
        falloff=rng.uniform(-0.2, 0.2),
        shade=rng.uniform(0.4, 0.75) if shaded else 1.0,
        shaded=rng.uniform(0.08, 0.3) if shaded else 0.0,
        noise=rng.uniform(0.002, 0.01),
        quality=int(rng.integers(80, 98)),
        seed=seed,
    )
