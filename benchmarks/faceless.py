"""Pictures without a face: scikit-image's, patterns, and parts of portraits below the chin."""

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw
from scipy.ndimage import gaussian_filter
from skimage import data
from skimage.color import gray2rgb

from benchmarks.portrait_faces import KnownFace
from skinnet.images import to_uint8

Photo = NDArray[np.uint8]

PHOTOGRAPHS = (
    *("brick", "cat", "cell", "checkerboard", "clock", "coffee", "colorwheel", "grass", "gravel"),
    *("horse", "hubble_deep_field", "immunohistochemistry", "logo", "microaneurysms", "moon"),
    *("page", "retina", "rocket", "shepp_logan_phantom", "text"),
)
"""Pictures of scikit-image. Its coins show heads, and are left out."""


def make_faceless(portraits: Sequence[KnownFace], seed: int = 0) -> Iterator[tuple[str, Photo]]:
    """Yield names and pictures uint8 [H, W, 3] without a face."""
    for name in PHOTOGRAPHS:
        yield name, _to_photo(getattr(data, name)())
    yield "motorcycle", data.stereo_motorcycle()[0]
    rng = np.random.default_rng(seed)
    for grain in (1, 4, 16, 64):
        yield f"skin-coloured clouds of {grain} pixels", _make_clouds(rng, grain)
    for number in range(4):
        yield f"shapes {number}", _make_shapes(rng)
    for known in portraits:
        if (body := _cut_body(known)) is not None:
            yield f"{known.path.stem} below the chin", body


def _to_photo(picture: NDArray[np.generic]) -> Photo:
    """Turn a grey, boolean or real picture into sRGB."""
    picture = picture[..., :3] if picture.ndim == 3 else gray2rgb(picture)
    if picture.dtype == np.uint8:
        return picture
    return to_uint8(picture.astype(np.float32) / max(1.0, float(picture.max())))


def _make_clouds(rng: np.random.Generator, grain: float, size: int = 640) -> Photo:
    """Smooth noise between dark and pale skin."""
    noise = gaussian_filter(rng.standard_normal((size, size)), grain)
    share = (noise - noise.min()) / np.ptp(noise)
    dark, pale = np.array([60, 35, 25]), np.array([240, 200, 175])
    return np.rint(dark + share[..., None] * (pale - dark)).astype(np.uint8)


def _make_shapes(rng: np.random.Generator, size: int = 640, count: int = 120) -> Photo:
    """Ellipses of colours of skin, cloth and shade."""
    image = Image.new("RGB", (size, size), (120, 110, 100))
    draw = ImageDraw.Draw(image)
    for _ in range(count):
        x, y, wide, high = rng.uniform(0, size, 4) * (1, 1, 0.2, 0.2)
        colour = tuple(int(value) for value in rng.integers(20, 240, 3))
        draw.ellipse((x - wide, y - high, x + wide, y + high), fill=colour)
    return np.asarray(image)


def _cut_body(known: KnownFace) -> Photo | None:
    """What is well below the chin; None if it is less than a fifth of the box."""
    photo, box = known.read(), known.box
    body = photo[round(box.bottom + 0.25 * box.height) :]
    return body if len(body) >= 0.2 * box.height else None
