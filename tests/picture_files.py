"""Small photographs, and picture files of them with profiles."""

import struct
import zlib
from pathlib import Path

import numpy as np
from PIL import Image, ImageCms


def make_photo(height: int = 5, width: int = 7) -> np.ndarray:
    rows, columns = np.mgrid[:height, :width]
    return np.stack([rows * 40, columns * 30, 255 - rows * 20], -1).astype(np.uint8)


def save_image(image: Image.Image, path: Path, **options: object) -> Path:
    image.save(path, **options)
    return path


def make_srgb_profile() -> bytes:
    content = ImageCms.ImageCmsProfile(ImageCms.createProfile("sRGB")).tobytes()
    return content[:24] + struct.pack(">6H", 2020, 1, 1, 0, 0, 0) + content[36:]  # not the clock's


def make_swapped_profile() -> bytes:
    """sRGB with the tags of its red and blue primaries exchanged."""
    table = make_srgb_profile()
    return table.replace(b"rXYZ", b"tXYZ").replace(b"bXYZ", b"rXYZ").replace(b"tXYZ", b"bXYZ")


def encode_png(width: int, height: int, depth: int, colour: int, rows: bytes) -> bytes:
    head = struct.pack(">IIBBBBB", width, height, depth, colour, 0, 0, 0)
    chunks = ((b"IHDR", head), (b"IDAT", zlib.compress(rows)), (b"IEND", b""))
    return b"\x89PNG\r\n\x1a\n" + b"".join(
        struct.pack(">I", len(body)) + name + body + struct.pack(">I", zlib.crc32(name + body))
        for name, body in chunks
    )
