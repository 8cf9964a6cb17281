"""Pictures without colour: grey, or toned in sepia, cyanotype, duotone and the like.

In a toned picture chroma is a function of luma, apart from the noise of JPEG, the stains of an old
print and small coloured objects. In a photograph of a face it is not: hair, eyes, lips, blood and
the background have colours of their own.
"""

from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from skinnet.errors import InputError
from skinnet.images._skin_colours import measure_usual_squares
from skinnet.images.box import Box
from skinnet.images.faces._largest import choose_largest
from skinnet.images.faces.finder import find_faces
from skinnet.images.faces.framing import frame_head
from skinnet.images.skin_segmentation import SKIN_AREAS
from skinnet.images.srgb import srgb_to_linear

_PIXELS, _CELLS, _KNOTS = 128, 12, 7
"""Pixels and cells along the longer side of a region; knots of the curve of chroma over luma."""

_LUMA_CHROMA = np.array(
    [[0.299, -0.168736, 0.5], [0.587, -0.331264, -0.418688], [0.114, 0.5, -0.081312]], np.float32
)
"""Y, Cb and Cr of R, G and B (JFIF)."""

_FACE_MARGIN = 1.25
"""Side of the region of the face alone, in sides of its box: a wall behind it may be coloured."""

_CLOSE_UP = 2.5
"""Least area of a head, in areas of its face: less has too little hair and background."""

_GREY = 0.1
"""Length of (log R/G, log B/G) below which skin is grey. The least of 1,245 portraits is 0.17."""

_HEAD = np.array([-3.45, 5.83, 1.69, 3.42, -2.87, 6.53, 2.85, -9.3, -10.99, -10.56, -4.33])
_FACE = np.array([0.6, 4.43, 2.82, -0.05, -3.68, 8.74, 3.2, -9.93, -13.64, -13.46, 5.06])
"""Logistic regression of `_measure` for the head and for the face alone: colour is positive. It was
fitted to 2,500 versions of 1,245 portraits (dark, bright, blurred, other white balances, sizes of
100 to 1350 pixels, JPEG quality 20 to 90) against the same portraits in random tones."""

_HEAD_LIMIT, _FACE_LIMIT, _ANYWHERE_LIMIT, _CLEAR = -1.6, -3.0, -8.0, 3.0
"""Scores below which head, face, and a picture without a face are toned, and the score of a picture
that is clearly a colour photograph. The least of the portraits' heads is -0.6, of faces -2.4."""

_ON_CURVE = -2.4
"""Log of residuals (90 %) over chroma (75 %) below which a region is toned, however strong its
tones; the least of the portraits is -1.8."""

_DARK = 50.0
"""Luma (75 %) of a face below which 8 bits may hide its colours: skin as dark as the darkest of the
portraits is below it, and taken for toned, at a quarter of the exposure."""

_BLACK = 8.0
"""Luma below which cells of a texture do not count."""

_EXACT, _ROUNDED, _SHARE = 0.6, 0.2, 0.45
"""Limits of the residuals (95 %) of exact tones: above the first none is exact, below the second
all are, and between them those are whose residuals are less than this share of the chroma's spread
(75 %). Dark or even skin has small residuals too, but its chroma varies no more than they do."""

_SKIN_DISTANCE, _LEAST_RED, _MUCH_RED, _MOST_BLUE = 12.0, 0.15, 0.85, 0.2
"""Squared distance of 99 % of the portraits from all skin, and limits of log R/G and log B/G:
tones are seldom as red as `_MUCH_RED`."""

_EVEN, _SHADED = 65.0, 125.0
"""Ranges of luma of bare patches of skin: of even ones, and the largest."""

_TINTS = (
    "red",
    "brown (sepia)",
    "yellow",
    "green",
    "blue-green",
    "blue (cyanotype)",
    "violet",
    "purple",
)
"""Tints by the angle of (Cr, -Cb), in eighths of a turn."""


_ALL_GREY = "it is grey"


class _Cells(NamedTuple):
    """Means over the cells of a region."""

    luma: NDArray[np.float32]
    chroma: NDArray[np.float32]
    terms: NDArray[np.float64]


def check_colour(photo: NDArray[np.uint8], box: Box, face: Box | None, name: str) -> None:
    """Raise `InputError` for a picture without colour, as `find_tone` finds it."""
    tone = find_tone(photo, box, face)
    if tone is not None:
        region = box if face is None else _frame_face(photo, face)
        is_dark = np.percentile(_average(photo[region.slices]).luma, 75) < _DARK
        raise InputError(
            f"There is no colour in {name}: {tone}. Melanin and hemoglobin cannot be read from it; "
            + ("it is too dark, give a brighter one." if is_dark else "give the colour photograph.")
        )


def refuse_grey(photo: NDArray[np.uint8], name: str) -> None:
    """Raise `InputError` for a grey picture in which no face was found."""
    whole = Box(0, 0, photo.shape[1], photo.shape[0])
    if find_tone(photo, whole, None) == _ALL_GREY:
        check_colour(photo, whole, None, name)


def find_tone(photo: NDArray[np.uint8], box: Box, face: Box | None) -> str | None:
    """Describe the one tone of a picture without colour; None for a colour photograph.

    Args:
        photo: uint8 sRGB [H, W, 3].
        box: The part that is read.
        face: The face in it, from the brows to the chin; None if it was not looked for.
    """
    head = _average(photo[box.slices])
    if face is None:
        return _find_tone_anywhere(photo[box.slices], head)
    skin = _find_skin(photo, face)
    if np.hypot(*skin) < _GREY:
        return "the skin in it is grey"
    alone = _average(photo[_frame_face(photo, face).slices])
    tone = _fit_tone(alone, skin, _FACE, _FACE_LIMIT)
    if tone is None and box.width * box.height > _CLOSE_UP * face.width * face.height:
        tone = _fit_tone(head, skin, _HEAD, _HEAD_LIMIT)
    return tone


def _frame_face(photo: NDArray[np.uint8], face: Box) -> Box:
    """The face with a margin, inside the photograph."""
    height, width = photo.shape[:2]
    return frame_head(face, width, height, _FACE_MARGIN)


def find_tone_of_texture(texture: NDArray[np.uint8]) -> str | None:
    """Name the one tone of a texture without colour; None for others.

    A texture may show nothing but skin, so only exact tones are found, on cells that are not black.
    """
    cells = _average(texture)
    ratios = _log_ratios(srgb_to_linear(_divide(texture)[0]).mean(1))
    lit = cells.luma > _BLACK
    if not lit.any() or np.percentile(np.hypot(*ratios[lit].T), 98) < _GREY:
        return "grey"
    is_varied = lit.sum() >= _CELLS and np.ptp(cells.luma[lit]) > _BLACK
    if is_varied and np.percentile(_fit_curve(cells)[lit], 95) < _limit_exact(cells.chroma[lit]):
        return _name_tint(cells)
    return None


def _limit_exact(chroma: NDArray[np.float32]) -> float:
    """The largest residual of exact tones in cells of a chroma [n, 2]."""
    spread = np.percentile(np.hypot(*(chroma - np.median(chroma, 0)).T), 75)
    return float(np.clip(_SHARE * spread, _ROUNDED, _EXACT))


def _find_tone_anywhere(region: NDArray[np.uint8], cells: _Cells) -> str | None:
    """Find the tone of a whole picture. A face is searched for only where there is a doubt."""
    ratios = _log_ratios(srgb_to_linear(_divide(region)[0]).mean(1))
    if np.percentile(np.hypot(*ratios.T), 95) < _GREY:
        return _ALL_GREY
    if len(ratios) < _CELLS**2 / 4:
        return None
    skin = np.median(ratios, 0)
    darkest, brightest = np.percentile(cells.luma, [5, 95])
    is_even = brightest - darkest < _EVEN and skin[0] > _LEAST_RED and skin[1] < _MOST_BLUE
    if is_even or _fit_tone(cells, skin, _HEAD, _CLEAR) is None:
        return None
    found = choose_largest(find_faces(region))
    face = None if found is None else found.box
    if face is not None:
        return find_tone(region, frame_head(face, region.shape[1], region.shape[0]), face)
    if brightest - darkest < _SHADED and _has_colour_of_skin(skin):
        return None
    return _fit_tone(cells, skin, _HEAD, _ANYWHERE_LIMIT)


def _has_colour_of_skin(ratios: NDArray[np.float32]) -> bool:
    """Whether a colour may be that of a patch of skin, which lies on one curve as well."""
    is_red = ratios[0] > _MUCH_RED and ratios[1] < _MOST_BLUE
    return bool(is_red or measure_usual_squares(ratios[None])[0] < _SKIN_DISTANCE)


def _fit_tone(
    cells: _Cells, skin: NDArray[np.float32], weights: NDArray[np.float64], limit: float
) -> str | None:
    residuals = _fit_curve(cells)
    measured = _measure(cells, residuals, skin)
    if measured @ weights > limit and measured[1] - measured[2] > _ON_CURVE:
        return None
    distance = np.median(residuals)
    return (
        f"it has one tone of {_name_tint(cells)}; its pixels lie {distance:.1f} of 255 levels "
        "from it"
    )


def _name_tint(cells: _Cells) -> str:
    cb, cr = cells.chroma.mean(0)
    return _TINTS[round(float(np.arctan2(-cb, cr)) / (np.pi / 4)) % 8]


def _measure(
    cells: _Cells, residuals: NDArray[np.float64], skin: NDArray[np.float32]
) -> NDArray[np.float64]:
    """Sizes of the residuals and of the chroma, brightness, colour of the skin, and 1."""
    spread = np.hypot(*(cells.chroma - np.median(cells.chroma, 0)).T)
    sizes = np.concatenate([np.percentile(residuals, [50, 90]), np.percentile(spread, [75, 90])])
    u, v = skin
    colour = (np.log(cells.luma.mean() + 10), u, v, u * u, v * v, u * v, 1)
    return np.concatenate([np.log(sizes + 0.3), colour])


def _fit_curve(cells: _Cells) -> NDArray[np.float64]:
    """Distances of the cells' chroma from a curve over luma whose tint may change in space.

    Reweighted least squares with Cauchy's weights, so that small coloured objects do not count.
    """
    terms, chroma, weights = cells.terms, cells.chroma, np.ones((len(cells.luma), 1))
    for _ in range(5):
        weighted = weights * terms
        normal = weighted.T @ terms + 1e-3 * np.eye(terms.shape[1])
        residuals = np.hypot(*(chroma - terms @ np.linalg.solve(normal, weighted.T @ chroma)).T)
        scale = 2.5 * (np.median(residuals) / 0.8 + 0.3)
        weights = 1 / (1 + (residuals[:, None] / scale) ** 2)
    leverage = np.einsum("nk,kn->n", weighted, np.linalg.solve(normal, terms.T))
    distances: NDArray[np.float64] = residuals / np.sqrt(np.clip(1 - leverage, 0.2, 1))
    return distances


def _average(region: NDArray[np.uint8]) -> _Cells:
    """Average over cells. The terms of the curve are averaged, since it is not linear in luma."""
    pixels, rows, columns = _divide(region)
    count = rows * columns
    averaged = pixels.mean(1, dtype=np.float32) @ _LUMA_CHROMA
    levels = (pixels @ _LUMA_CHROMA[:, 0]).round().astype(np.intp)
    bins = (levels + 256 * np.arange(count)[:, None]).ravel()
    shares = np.bincount(bins, minlength=256 * count).reshape(count, 256) / pixels.shape[1]
    luma = averaged[:, :1]
    place = np.indices((rows, columns)).reshape(2, -1).T / (rows, columns) - 0.5
    terms = np.concatenate([shares @ _curve_table(), place, place * luma / 128], 1)
    return _Cells(luma[:, 0], averaged[:, 1:], terms)


def _divide(region: NDArray[np.uint8]) -> tuple[NDArray[np.uint8], int, int]:
    """Divide a region into cells: every n-th pixel [cells, pixels, 3], rows, columns of cells."""
    step = max(1, round(max(region.shape[:2]) / _PIXELS))
    pixels = region[::step, ::step]
    side = max(1, round(max(pixels.shape[:2]) / _CELLS))
    rows, columns = (max(1, size // side) for size in pixels.shape[:2])
    height, width = pixels.shape[0] // rows, pixels.shape[1] // columns
    whole = pixels[: rows * height, : columns * width].reshape(rows, height, columns, width, 3)
    return whole.swapaxes(1, 2).reshape(rows * columns, height * width, 3), rows, columns


@cache
def _curve_table() -> NDArray[np.float32]:
    """Linear splines over luma, [256, knots]."""
    knots, levels = np.linspace(0, 255, _KNOTS), np.arange(256)
    return np.array([np.interp(levels, knots, unit) for unit in np.eye(_KNOTS)], np.float32).T


def _find_skin(photo: NDArray[np.uint8], face: Box) -> NDArray[np.float32]:
    """Colour of the area that is most like skin: cloth or hair may cover the others."""
    step = max(1, face.width // 100)
    areas = [photo[_place_area(face, area).slices][::step, ::step] for area in SKIN_AREAS]
    means = [srgb_to_linear(area).mean((0, 1)) for area in areas if area.size]
    ratios = _log_ratios(np.array(means))
    skin: NDArray[np.float32] = ratios[measure_usual_squares(ratios).argmin()]
    return skin


def _place_area(face: Box, area: tuple[float, float, float, float]) -> Box:
    left, top, right, bottom = area
    return Box(
        max(0, face.left + int(left * face.width)),
        max(0, face.top + int(top * face.height)),
        face.left + int(right * face.width) + 1,
        face.top + int(bottom * face.height) + 1,
    )


def _log_ratios(linear: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return log R/G and log B/G of linear RGB [..., 3]."""
    logs = np.log(linear + np.float32(1e-3))
    ratios: NDArray[np.float32] = logs[..., ::2] - logs[..., 1:2]
    return ratios
