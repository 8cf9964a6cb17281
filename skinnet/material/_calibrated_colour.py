"""Light, camera and calibration of a texture, as the command states them."""

import argparse
import json
from pathlib import Path

import numpy as np
from jaxtyping import Float

from skinnet.calibration._exposure import fit_exposure
from skinnet.calibration._model_colours import tabulate_model_colours
from skinnet.calibration.colour_transform import calibrate
from skinnet.errors import InputError
from skinnet.files._reading import MOST_TEXT, read_file
from skinnet.inference._messages import log
from skinnet.material._encoding import Encoding
from skinnet.material._texture_file import TextureFile
from skinnet.material.albedo import AlbedoColour
from skinnet.physics.inversion import F_BLOOD_RANGE, F_MEL_RANGE
from skinnet.physics.sources import load_spectrum_to_srgb

_COLOURS, _DARK = 100_000, 0.003
_UNCERTAIN = 0.03


def make_colour(options: argparse.Namespace, textures: list[TextureFile]) -> AlbedoColour:
    """Make the colour of a texture, from the flags of its verb.

    Raises:
        InputError: A light, a camera or a calibration cannot be used.
    """
    matrix = load_spectrum_to_srgb(options.light, options.camera).numpy()
    way = options.calibration
    if way in ("exposure", "full"):
        colours = np.concatenate([sample_colours(one) for one in textures])
        return AlbedoColour(options.light, options.camera, _fit(way, matrix, colours))
    transform = None if way == "none" else _read_transform(Path(way))
    return AlbedoColour(options.light, options.camera, transform)


def sample_colours(texture: TextureFile) -> Float[np.ndarray, "colours 3"]:
    """Sample linear RGB of opaque texels that are not black."""
    encoding = Encoding(texture.type, texture.linear)
    step = max(texture.spec.width * texture.spec.height // _COLOURS, 1)
    parts = []
    for strip in texture.read_strips():
        flat = strip.reshape(-1, strip.shape[-1])[::step]
        colours = encoding.decode(flat[:, list(texture.rgb)])
        usable = colours.max(1) > _DARK
        if texture.alpha is not None:
            usable &= flat[:, texture.alpha] > 0
        parts.append(colours[usable])
    return np.concatenate(parts).astype(np.float64)


def _fit(
    way: str, matrix: Float[np.ndarray, "wavelength 3"], colours: Float[np.ndarray, "colours 3"]
) -> Float[np.ndarray, "3 3"]:
    model = tabulate_model_colours(matrix, "measured", F_MEL_RANGE, F_BLOOD_RANGE)
    if way == "exposure":
        factor = fit_exposure(colours, model.reshape(-1, 3))
        log(f"calibration: the colours of the texture times {factor:.3g} are those of skin")
        return np.eye(3) / factor
    found = calibrate(colours, model)
    rows = "; ".join(" ".join(f"{value:.3f}" for value in row) for row in found.transform)
    log(f"calibration: transform [{rows}]")
    if found.uncertainty > _UNCERTAIN:
        log(
            f"one texture determines the transform only to {found.uncertainty:.0%}, however well "
            "it fits; one factor is safer (--calibration exposure)."
        )
    return found.transform


def _read_transform(path: Path) -> Float[np.ndarray, "3 3"]:
    try:
        return np.array(json.loads(read_file(path, MOST_TEXT))["transform"], float).reshape(3, 3)
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise InputError(
            f"--calibration is none, exposure, full, or a .json that skinnet wrote; got {path}."
        ) from error
