"""Writer of plain PNG files: pictures and 16-bit maps with texts."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image, PngImagePlugin

from skinnet.files import write_atomically


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
    if kind not in ((np.dtype(np.uint8), (3,)), (np.dtype(np.uint16), ())):
        raise ValueError(f"PNG is written from uint8 [H, W, 3] or uint16 [H, W]; got {kind}.")
    info = PngImagePlugin.PngInfo()
    for key, value in (text or {}).items():
        info.add_text(key, value)
    with write_atomically(path) as part:
        # The fast level: the low bits of interpolated maps are noise that no level compresses.
        Image.fromarray(array).save(part, "PNG", pnginfo=info, compress_level=1)
