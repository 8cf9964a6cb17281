"""Colours of skin as a table over both pigments, which shaders look up."""

from typing import NamedTuple

import numpy as np
import torch
from jaxtyping import Float32, Float64

from skinnet.errors import InputError
from skinnet.physics import SkinLookup, SkinReflectance, load_spectrum_to_srgb
from skinnet.physics._pigment_axis import PigmentAxis

_SIZES = (16, 2048)
"""Least and largest number of nodes of an axis; with fewer the error would be above 2e-3."""


class SkinTable(NamedTuple):
    """Linear sRGB of skin at nodes of both pigments.

    Args:
        colours: The colours at the nodes, not clipped.
        melanin: Axis of the columns.
        hemoglobin: Axis of the rows.
    """

    colours: Float32[np.ndarray, "blood mel 3"]
    melanin: PigmentAxis
    hemoglobin: PigmentAxis


def tabulate_skin(
    light: str = "D65",
    camera: str = "observer",
    size: tuple[int, int] = (256, 128),
    transform: Float64[np.ndarray, "3 3"] | None = None,
) -> SkinTable:
    """Compute the colours of skin under a light and a camera.

    Nodes are at equal steps of log(1 + f / spacing) from f = 0 to f = 1, as those of `SkinLookup`,
    so that a bilinear look-up of 256 x 128 nodes is within 2e-5 of the closed form.

    Args:
        light: Name or file, as of `load_light`.
        camera: Name or file, as of `load_camera`.
        size: Nodes of melanin and of hemoglobin, 16 to 2,048.
        transform: Colour transform that multiplies the model's RGB from the left; None: none.

    Returns:
        The table.

    Raises:
        InputError: Light or camera are unknown, or the size is out of range.

    Source:
        Alotaibi & Smith 2017, section 4.4, precomputes such a table.
    """
    low, high = _SIZES
    if not all(low <= nodes <= high for nodes in size):
        raise InputError(
            f"The size of the table is {low} to {high} nodes in melanin and in hemoglobin, such as "
            f"256x128; got {size[0]}x{size[1]}."
        )
    matrix = load_spectrum_to_srgb(light, camera)
    skin = SkinReflectance(dtype=matrix.dtype)
    spacings = SkinLookup(skin, (3, 3)).spacing
    axes = [PigmentAxis(0.0, 1.0, nodes, each) for nodes, each in zip(size, spacings, strict=True)]
    f_mel, f_blood = (
        torch.from_numpy(axis.fractions(np.arange(axis.nodes) * 1.0)) for axis in axes
    )
    with torch.no_grad():
        colours = skin(f_mel[None, :], f_blood[:, None]) @ matrix
        if transform is not None:
            colours = colours @ torch.from_numpy(transform.T.copy())
    return SkinTable(colours.numpy().astype(np.float32), *axes)
