"""The unit of a mesh, guessed from its size."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from skinnet.errors import InputError

UNITS = {"metres": 1000.0, "centimetres": 10.0, "millimetres": 1.0, "micrometres": 0.001}
"""Units that a mesh may have, and their lengths in millimetres."""

FACE = (100.0, 600.0)
"""Longest side of the bounding box of a face, or of a head with shoulders, in millimetres."""


class LengthUnit(NamedTuple):
    """The unit of a mesh.

    Attributes:
        millimetres: Length of the unit.
        note: A sentence that names the unit and the mesh's size.
    """

    millimetres: float
    note: str


def guess_length_unit(
    vertices: Float[np.ndarray, "vertices 3"], name: str = "The mesh"
) -> LengthUnit:
    """Guess the unit of a mesh: that of `UNITS` in which it is as large as a face (`FACE`).

    Args:
        vertices: Positions of a face or head.
        name: What messages call the mesh.

    Returns:
        The unit, and a sentence about it.

    Raises:
        InputError: If the mesh has the size of a face in none of `UNITS`.

    Example:
        >>> import numpy as np
        >>> from skinnet.mesh._length_unit import guess_length_unit
        >>> guess_length_unit(np.array([[0.0, 0, 0], [0, 0.2, 0]]), "scan.obj")
        LengthUnit(millimetres=1000.0, note='scan.obj is taken to be in metres: it is 200 mm long.')
    """
    size = float(np.ptp(vertices, axis=0).max())
    for unit, millimetres in UNITS.items():
        length = size * millimetres
        if FACE[0] <= length <= FACE[1]:
            return LengthUnit(
                millimetres, f"{name} is taken to be in {unit}: it is {length:.0f} mm long."
            )
    raise InputError(
        f"{name} is {size:.3g} units long, which is no face or head of {FACE[0]:.0f} to "
        f"{FACE[1]:.0f} mm in {', '.join(UNITS)}; cut the face out, or give the length of a unit "
        "in millimetres."
    )
