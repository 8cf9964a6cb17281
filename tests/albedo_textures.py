"""Albedo textures of synthetic skin, with lips, paint and transparency, in files of any kind."""

from pathlib import Path
from typing import Any

import numpy as np
import OpenImageIO
import torch
from numpy.typing import NDArray

from skinnet.images.srgb import linear_to_srgb
from skinnet.physics import SkinReflectance, load_spectrum_to_srgb

TYPES = {"uint8": np.uint8, "uint16": np.uint16, "half": np.float16, "float": np.float32}


def paint_skin(size: int = 48, f_mel: float = 0.06, f_blood: float = 0.04) -> NDArray[np.float32]:
    """Linear RGB [size, size, 3] of skin, with a black, a white and a green line and some noise."""
    rng = np.random.default_rng(0)
    across = np.linspace(0.7, 1.4, size)
    mel, blood = np.meshgrid(f_mel * across, f_blood * across[::-1])
    skin = SkinReflectance(dtype=torch.float64)(torch.from_numpy(mel), torch.from_numpy(blood))
    rgb = (skin @ load_spectrum_to_srgb("D65", "observer")).numpy()
    rgb *= rng.normal(1, 0.01, rgb.shape)
    rgb[3], rgb[9], rgb[20] = (0.001, 0.001, 0.001), (0.95, 0.95, 0.95), (0.02, 0.6, 0.1)
    return np.asarray(rgb.clip(0, 1), np.float32)


def write_texture(path: Path, linear: NDArray[Any], kind: str, alpha: bool = False) -> NDArray[Any]:
    """Write linear RGB; EXR keeps it linear, and others hold sRGB. Returns what is stored."""
    values = linear if path.suffix == ".exr" else linear_to_srgb(linear)
    if kind in ("uint8", "uint16"):
        values = np.rint(values * np.iinfo(kind).max)
    stored = values.astype(TYPES[kind])
    if alpha:
        opacity = np.full(stored.shape[:2], np.iinfo(kind).max if "int" in kind else 1)
        opacity[:, :5] = 0
        stored = np.concatenate([stored, opacity[..., None].astype(stored.dtype)], -1)
    write_pixels(path, stored, kind, ("R", "G", "B", "A")[: stored.shape[2]])
    return stored


def write_pixels(
    path: Path, stored: NDArray[Any], kind: str, names: tuple[str, ...], tile: int = 0
) -> None:
    """Write pixels [height, width, channels] as they are."""
    height, width, count = stored.shape
    spec = OpenImageIO.ImageSpec(width, height, count, kind)
    spec.channelnames = names
    spec.tile_width = spec.tile_height = tile
    if path.suffix != ".exr":
        spec.attribute("oiio:UnassociatedAlpha", 1)
    output = OpenImageIO.ImageOutput.create(str(path))
    assert output.open(str(path), spec), output.geterror()
    assert output.write_image(stored), output.geterror()
    output.close()


def read_pixels(path: Path) -> NDArray[Any]:
    """Read pixels as they are stored."""
    settings = OpenImageIO.ImageSpec()
    settings.attribute("oiio:UnassociatedAlpha", 1)
    source = OpenImageIO.ImageInput.open(str(path), settings)
    spec = source.spec()
    values = source.read_image(0, 0, 0, spec.nchannels, str(spec.format))
    source.close()
    return np.asarray(values)
