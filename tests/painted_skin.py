"""A patch of skin with painted freckles, spots of blood, wrinkles and pores, and its photograph."""

import io

import numpy as np
import torch
from PIL import Image
from scipy import ndimage

from skinnet import SkinDecoder
from skinnet.images import linear_to_srgb, resize, to_uint8

SIZE, SMALL, TOP = 480, 40, (0.43, 0.15)
Maps = dict[str, np.ndarray]


def paint_maps() -> Maps:
    rng = np.random.default_rng(0)
    flat = np.ones((SIZE, SIZE), np.float32)
    rows = np.arange(SIZE)[:, None] + 12 * np.sin(np.arange(SIZE) / 40)
    lines = sum(0.3 * np.exp(-((rows - y) ** 2) / 12) for y in (60, 170, 300, 390))
    return {
        "melanin": 0.035 * flat * (1 + paint_spots(rng, 120, (2, 5), 0.9)),
        "hemoglobin": 0.045 * flat * (1 + paint_spots(rng, 60, (3, 6), 0.7)),
        "shading": 0.7 * flat * np.exp(-lines - paint_spots(rng, 1500, (1, 1.5), 0.12)),
        "specular": 0.01 * flat,
    }


def paint_spots(
    rng: np.random.Generator, count: int, radii: tuple[float, float], height: float
) -> np.ndarray:
    spots = np.zeros((SIZE, SIZE), np.float32)
    for radius in np.linspace(*radii, 4):
        one = np.zeros((SIZE, SIZE))
        one[tuple(rng.integers(0, SIZE, (2, count // 4)))] = 2 * np.pi * radius**2 * height
        spots += ndimage.gaussian_filter(one, radius).astype(np.float32)
    return spots


def reduce_maps(maps: Maps) -> Maps:
    """The best maps that a network could give."""
    small = {name: resize(value.astype(np.float32), SMALL, SMALL) for name, value in maps.items()}
    shape = small["melanin"].shape
    return small | {"mask": np.ones(shape, np.float32), "offset": np.zeros((*shape, 3), np.float32)}


def photograph_maps(skin: SkinDecoder, maps: Maps, noise: float = 0.7) -> np.ndarray:
    with torch.no_grad():
        tensors = [torch.from_numpy(np.float32(value))[None] for value in maps.values()]
        linear = skin(*tensors)[0].permute(1, 2, 0).numpy()
    grain = np.random.default_rng(1).standard_normal(linear.shape) * noise / 255
    return to_uint8(linear_to_srgb(linear) + grain)


def compress_jpeg(photo: np.ndarray, quality: int) -> np.ndarray:
    file = io.BytesIO()
    Image.fromarray(photo).save(file, "JPEG", quality=quality)
    return np.array(Image.open(file))


def keep_detail(values: np.ndarray) -> np.ndarray:
    """What maps of the network's size cannot hold."""
    values = np.float32(values)
    return values - resize(resize(values, SMALL, SMALL), SIZE, SIZE)


def correlate(a: np.ndarray, b: np.ndarray) -> float:
    return float(np.corrcoef(a.ravel(), b.ravel())[0, 1])
