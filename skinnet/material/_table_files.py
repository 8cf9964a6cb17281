"""The table of colours as EXR and as 16-bit PNG, with its axes in the files' texts."""

from pathlib import Path

import numpy as np

from skinnet.images._chunks import insert_chunks, make_text
from skinnet.images._mark import Mark
from skinnet.material._skin_table import SkinTable
from skinnet.material._texture_file import TextureWriter, import_openimageio
from skinnet.physics._pigment_axis import PigmentAxis

_LEVELS = 65535


def write_table_exr(path: Path, table: SkinTable) -> None:
    """Write a table as EXR of floats: linear sRGB, not clipped, the last row at hemoglobin 0.

    Args:
        path: The file to write.
        table: The table.

    Raises:
        InputError: OpenImageIO is not installed.
    """
    oiio = import_openimageio()
    rows, columns = table.colours.shape[:2]
    spec = oiio.ImageSpec(columns, rows, 3, oiio.FLOAT)
    texts = describe_axes(table) | {"compression": "zip", "oiio:ColorSpace": "lin_rec709_scene"}
    for key, value in texts.items():
        spec.attribute(key, value)
    with TextureWriter(path, spec) as writer:
        writer.write(table.colours[::-1])


def write_table_png(path: Path, table: SkinTable) -> None:
    """Write a table as PNG of 16 bits: linear sRGB = number / 65535, clipped to 0 to 1.

    Args:
        path: The file to write.
        table: The table.
    """
    from imagecodecs import png_encode

    pixels = np.rint(table.colours[::-1].clip(0, 1) * _LEVELS).astype(np.uint16)
    texts = describe_axes(table) | Mark("shader", "table").to_text()
    # Programs that convert colours are told that the numbers are linear.
    chunks = [(b"gAMA", (100000).to_bytes(4, "big"))]
    chunks += [make_text(key, value) for key, value in texts.items()]
    path.write_bytes(insert_chunks(bytes(png_encode(np.ascontiguousarray(pixels))), chunks))


def describe_axes(table: SkinTable) -> dict[str, str]:
    """Describe colours and axes in texts of ASCII."""
    columns, rows = table.melanin, table.hemoglobin
    return {
        "Description": "Linear sRGB (Rec. 709, D65) of skin by the volume fractions of melanin and "
        "hemoglobin, from 0 to 1",
        "melanin": f"column i from the left, at its centre: {_describe_axis(columns, 'i')}",
        "hemoglobin": f"row j from the bottom, at its centre: {_describe_axis(rows, 'j')}",
    }


def _describe_axis(axis: PigmentAxis, index: str) -> str:
    spacing, last = repr(axis.spacing), axis.nodes - 1
    return f"f = {spacing} * ((1 + 1 / {spacing}) ^ ({index} / {last}) - 1)"
