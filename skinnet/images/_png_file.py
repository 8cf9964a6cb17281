"""Writer of plain PNG files (ISO/IEC 15948): pictures and 16-bit maps with texts."""

import struct
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from skinnet.files import write_atomically
from skinnet.images._chunks import SIGNATURE, make_text, pack_chunks

_HEADERS = {(np.dtype(np.uint8), (3,)): (8, 2), (np.dtype(np.uint16), ()): (16, 0)}
"""Bits of a channel and colour type of each kind of array."""


def write_png(path: Path, array: NDArray[Any], text: Mapping[str, str] | None = None) -> None:
    """Write a PNG file, completely or not at all.

    Args:
        path: The file to write.
        array: uint8 sRGB [H, W, 3], or uint16 grey [H, W].
        text: What to write into the file as tEXt chunks, by keyword.

    Raises:
        ValueError: The array is of another type or shape.

    Example:
        >>> from pathlib import Path
        >>> import numpy as np
        >>> from tempfile import mkdtemp
        >>> from skinnet.images import read_photo
        >>> from skinnet.images._png_file import write_png
        >>> path = Path(mkdtemp()) / "a.png"
        >>> write_png(path, np.full((2, 3, 3), 7, np.uint8))
        >>> read_photo(path).shape
        (2, 3, 3)
    """
    kind = (array.dtype, array.shape[2:])
    if kind not in _HEADERS:
        raise ValueError(f"PNG is written from uint8 [H, W, 3] or uint16 [H, W]; got {kind}.")
    _write(path, array, _HEADERS[kind], [], text or {})


def write_palette_png(
    path: Path,
    pixels: NDArray[np.uint8],
    palette: NDArray[np.uint8],
    text: Mapping[str, str] | None = None,
) -> None:
    """Write a PNG file of at most 256 colours, completely or not at all.

    Args:
        path: The file to write.
        pixels: Numbers of colours, uint8 [H, W].
        palette: The colours, uint8 sRGB [colours, 3].
        text: What to write into the file as tEXt chunks, by keyword.

    Example:
        >>> from tempfile import mkdtemp
        >>> path = Path(mkdtemp()) / "a.png"
        >>> write_palette_png(path, np.eye(4, dtype=np.uint8), np.full((2, 3), 9, np.uint8))
        >>> path.stat().st_size < 120
        True
    """
    _write(path, pixels, (8, 3), [(b"PLTE", palette.tobytes())], text or {})


def _write(
    path: Path,
    array: NDArray[Any],
    kind: tuple[int, int],
    palette: list[tuple[bytes, bytes]],
    text: Mapping[str, str],
) -> None:
    """Write rows of pixels with their bits of a channel and colour type."""
    from imagecodecs import deflate_encode

    height, width = array.shape[:2]
    header = struct.pack(">IIBBBBB", width, height, *kind, 0, 0, 0)
    # The fast level: the low bits of interpolated maps are noise that no level compresses.
    content: Any = deflate_encode(
        _filter_rows(array),  # type: ignore[arg-type]  # any buffer
        level=1,
    )
    texts = [make_text(key, value) for key, value in text.items()]
    chunks = [(b"IHDR", header), *palette, *texts, (b"IDAT", content), (b"IEND", b"")]
    with write_atomically(path) as part, part.open("wb") as file:
        file.write(SIGNATURE)
        file.writelines(pack_chunks(chunks))


def _filter_rows(array: NDArray[Any]) -> NDArray[np.uint8]:
    """Rows as differences from the row above (filter type 2), the first as it is (type 0).

    One filter for all rows takes a fraction of the time of a choice for each.
    """
    rows = array.astype(array.dtype.newbyteorder(">"), copy=False).reshape(len(array), -1)
    plain = np.ascontiguousarray(rows).view(np.uint8)
    filtered = np.empty((plain.shape[0], plain.shape[1] + 1), np.uint8)
    filtered[0, 0], filtered[0, 1:] = 0, plain[0]
    filtered[1:, 0] = 2
    np.subtract(plain[1:], plain[:-1], out=filtered[1:, 1:])
    return filtered
