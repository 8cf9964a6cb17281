"""Arrays of models of fractions and offsets in .npz files."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Bool

from skinnet.appearance._array_file import (
    ARCHIVE_ERRORS,
    Array,
    make_damage_error,
    read_arrays,
    write_arrays,
)
from skinnet.appearance._principal import PrincipalComponents
from skinnet.appearance.colour import SkinColour

STATISTICS = ("mean", "basis", "variances", "scales")
"""Arrays of a `PrincipalComponents`."""


def save_model(
    path: Path,
    kind: str,
    statistics: PrincipalComponents,
    mask: Bool[np.ndarray, "size size"],
    colour: SkinColour,
    origin: Mapping[str, Any],
) -> None:
    """Write a model of the given kind, which is the name of its class."""
    header = {
        "colour": colour.to_record(),
        "total": statistics.total,
        "subjects": statistics.subjects,
        **origin,
    }
    arrays = {name: getattr(statistics, name) for name in STATISTICS}
    write_arrays(path, kind, header, arrays | {"mask": mask})


def load_model(
    path: Path, kind: str
) -> tuple[PrincipalComponents, Bool[np.ndarray, "size size"], SkinColour]:
    """Read a model of the given kind; anything else is an `InputError`."""
    header, arrays = read_arrays(path, kind, (*STATISTICS, "mask"))
    mask = arrays.pop("mask")
    try:
        colour = SkinColour.from_record(header["colour"])
    except ARCHIVE_ERRORS as error:
        raise make_damage_error(path) from error
    statistics = build_statistics(path, header, arrays)
    if mask.dtype != bool or mask.shape != (len(mask),) * 2 or mask.sum() != len(statistics.mean.T):
        raise make_damage_error(path)
    return statistics, mask, colour


def build_statistics(
    path: Path, header: Mapping[str, Any], arrays: Mapping[str, Array]
) -> PrincipalComponents:
    """Build the components from a file; arrays that do not fit together are an `InputError`."""
    mean, basis, variances, scales = (arrays[name] for name in STATISTICS)
    if basis.ndim != 3 or basis.shape != (*variances.shape, *scales.shape, basis.shape[2]):
        raise make_damage_error(path)
    if mean.shape != basis.shape[1:] or not mean.dtype == basis.dtype == np.float32:
        raise make_damage_error(path)
    if not variances.dtype.kind == scales.dtype.kind == "f":
        raise make_damage_error(path)
    try:
        if not all(np.isfinite(array).all() for array in (mean, variances, scales)):
            raise make_damage_error(path)
        total, subjects = float(header["total"]), int(header["subjects"])
        return PrincipalComponents(mean, basis, variances, scales, total, subjects)
    except ARCHIVE_ERRORS as error:
        raise make_damage_error(path) from error
