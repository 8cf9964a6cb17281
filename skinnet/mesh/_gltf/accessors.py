"""Accessors of glTF: typed arrays in buffers, dense or sparse."""

from typing import Any

import numpy as np
from jaxtyping import Shaped

from skinnet.mesh._gltf.container import GltfFile

_COMPONENTS = {5120: "i1", 5121: "u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}

_MOST = 1 << 28

# Integers stay integers unless they are normalised to fractions.
Values = Shaped[np.ndarray, "count width"]


def read_accessor(file: GltfFile, index: Any, normalise: bool = False) -> Values:
    """Read an accessor, a row for each element; normalised integers become float64.

    Args:
        file: The file.
        index: Number of the accessor.
        normalise: Take integers as normalised even if the accessor does not say so.

    Raises:
        InputError: If the accessor is not as glTF says, or goes beyond its buffer.
    """
    accessor = file.get("accessors", index)
    kind = _COMPONENTS.get(accessor["componentType"])
    width = _WIDTHS.get(accessor["type"])
    if kind is None or width is None:
        raise file.damage(
            f"its accessor {index} has the unknown type {accessor['componentType']} "
            f"{accessor['type']}"
        )
    shape = accessor["count"], width
    if not 0 <= shape[0] <= _MOST:
        raise file.damage(f"its accessor {index} states {shape[0]:,} elements")
    if "bufferView" in accessor:
        values = _read_view(file, accessor, np.dtype(kind), shape)
    else:
        values = np.zeros(shape, kind)
    if "sparse" in accessor:
        values = _replace(file, index, values, accessor["sparse"])
    return _normalise(values) if normalise or accessor.get("normalized") else values


def _read_view(
    file: GltfFile, where: dict[str, Any], dtype: np.dtype[Any], shape: tuple[int, int]
) -> Values:
    view = file.get("bufferViews", where["bufferView"])
    data = file.read_view(where["bufferView"])
    start, row = where.get("byteOffset", 0), dtype.itemsize * shape[1]
    stride = view.get("byteStride", row)
    end = start + stride * (shape[0] - 1) + row if shape[0] else start
    if start < 0 or stride < row or shape[0] < 0 or end > len(data):
        raise file.damage(
            f"{shape[0]:,} elements of {row} bytes, one every {stride}, do not fit into the "
            f"{len(data):,} bytes of buffer view {where['bufferView']}"
        )
    return np.ndarray(shape, dtype, data, start, (stride, dtype.itemsize))


def _replace(file: GltfFile, index: Any, values: Values, sparse: dict[str, Any]) -> Values:
    """Replace the rows that a sparse accessor lists."""
    count, where = sparse["count"], sparse["indices"]
    kind = _COMPONENTS.get(where["componentType"])
    if kind is None:
        raise file.damage(f"its accessor {index} has sparse indices of an unknown type")
    rows = _read_view(file, where, np.dtype(kind), (count, 1))[:, 0]
    if len(rows) and rows.max() >= len(values):
        raise file.damage(f"its accessor {index} replaces element {rows.max()} of {len(values)}")
    replaced = values.copy()
    replaced[rows] = _read_view(file, sparse["values"], values.dtype, (count, values.shape[1]))
    return replaced


def _normalise(values: Values) -> Values:
    if values.dtype.kind == "f":
        return values
    return np.maximum(values / np.iinfo(values.dtype).max, -1)
