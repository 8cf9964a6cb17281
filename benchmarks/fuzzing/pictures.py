"""Pictures of every format that is read: damaged, and with parts that do not fit."""

from collections.abc import Callable
from functools import cache
from io import BytesIO
from pathlib import Path
from random import Random

import numpy as np
from PIL import Image, ImageCms
from skimage.data import astronaut

from benchmarks.fuzzing.case import Case
from benchmarks.fuzzing.changes import change_bytes
from benchmarks.fuzzing.chunks import (
    change_boxes,
    change_directories,
    change_jpeg,
    change_png,
    change_riff,
)
from skinnet.errors import InputError
from skinnet.images import read_picture
from skinnet.images._mark import Mark, read_mark
from skinnet.images._write import has_format, write_picture

_XMP = (
    b'<x:xmpmeta xmlns:x="adobe:ns:meta/"><rdf:RDF xmlns:rdf="http://www.w3.org/1999/02/22-rdf-'
    b'syntax-ns#"><rdf:Description rdf:about="" xmlns:xmp="http://ns.adobe.com/xap/1.0/" '
    b'xmp:Rating="3"/></rdf:RDF></x:xmpmeta>'
)

_STRUCTURES: dict[str, Callable[[bytes, Random], bytes]] = {
    ".jpg": change_jpeg,
    ".png": change_png,
    ".webp": change_riff,
    ".avif": change_boxes,
    ".heic": change_boxes,
    ".jp2": change_boxes,
    ".tif": change_directories,
    ".dng": change_directories,
}


def make(rng: Random) -> Case:
    """Make a damaged picture that is read, and written again if it can be read."""
    files = make_pictures()
    name = rng.choice(list(files))
    suffix = Path(name).suffix
    structured = _STRUCTURES.get(suffix)
    if structured is not None and rng.random() < 0.6:
        data = structured(files[name], rng)
    else:
        data = change_bytes(files[name], rng, files[rng.choice(list(files))])
    return Case(lambda folder: _read_and_write(folder / name), {name: data}, name)


def _read_and_write(path: Path) -> None:
    read_mark(path)
    picture = read_picture(path)
    height, width = picture.srgb.shape[:2]
    assert picture.srgb.dtype == np.uint8 and picture.srgb.ndim == 3 and height * width > 0
    suffix = path.suffix if has_format(path.suffix) else ".png"
    written = path.with_name(f"written{suffix}")
    write_picture(written, picture, Mark("edit", "edited", "0" * 64))
    try:
        again = read_picture(written)
    except InputError as error:
        raise AssertionError(f"what was written cannot be read: {error}") from error
    assert again.srgb.shape[:2] == (height, width), "another size was written"


@cache
def make_pictures() -> dict[str, bytes]:
    """Small photographs in every format, by file name."""
    image = Image.fromarray(astronaut()[60:188, 150:278]).resize((64, 64))
    exif = Image.Exif()
    exif[0x010F], exif[0x0110], exif[0x0112], exif[0x0132] = (
        "Canon",
        "EOS",
        6,
        "2020:01:01 00:00:00",
    )
    exif.get_ifd(0x8769).update({0x829A: 0.01, 0x8827: 100, 0x9209: 1, 0x9208: 3})
    profile = ImageCms.ImageCmsProfile(ImageCms.createProfile("sRGB")).tobytes()
    rich = {"exif": exif, "icc_profile": profile}
    found = {
        "a.jpg": _save(image, "JPEG", quality=85, xmp=_XMP, comment=b"by me", **rich),
        "progressive.jpg": _save(image, "JPEG", progressive=True, exif=exif),
        "cmyk.jpg": _save(image.convert("CMYK"), "JPEG"),
        "grey.jpg": _save(image.convert("L"), "JPEG", **rich),
        "a.png": _save(image, "PNG", pnginfo=_make_text(), **rich),
        "alpha.png": _save(image.convert("RGBA"), "PNG"),
        "palette.png": _save(image.quantize(64), "PNG"),
        "a.webp": _save(image, "WEBP", lossless=True, xmp=_XMP, **rich),
        "lossy.webp": _save(image, "WEBP", quality=80, exif=exif),
        "a.avif": _save(image, "AVIF", speed=10, exif=exif, icc_profile=profile),
        "a.jp2": _save(image, "JPEG2000"),
        "a.bmp": _save(image, "BMP"),
        "a.gif": _save(image.quantize(64), "GIF"),
        "a.ppm": _save(image, "PPM"),
        "a.mpo": _save(image, "MPO", save_all=True, append_images=[image]),
        "animated.webp": _save(image, "WEBP", save_all=True, append_images=[image.rotate(90)]),
        "a.tif": _save(image, "TIFF", compression="raw", **rich),
        **{
            f"{kind.removeprefix('tiff_')}.tif": _save(image, "TIFF", compression=kind)
            for kind in ("tiff_lzw", "tiff_adobe_deflate", "jpeg")
        },
    }
    return found | _make_deep(np.asarray(image)) | _make_camera_files(image)


def _make_deep(pixels: np.ndarray) -> dict[str, bytes]:
    """Pictures of 16 bits, and in tiles."""
    import imagecodecs
    import tifffile

    deep = pixels.astype(np.uint16) * 257
    tiled, big = BytesIO(), BytesIO()
    tifffile.imwrite(
        tiled, deep, photometric="rgb", tile=(32, 32), compression="zlib", metadata=None
    )
    tifffile.imwrite(big, deep, photometric="rgb", bigtiff=True, metadata=None)
    return {
        "deep.png": imagecodecs.png_encode(deep),
        "tiled.tif": tiled.getvalue(),
        "big.tif": big.getvalue(),
        "deep.jp2": imagecodecs.jpeg2k_encode(deep, codecformat="jp2"),
        "a.j2k": imagecodecs.jpeg2k_encode(pixels, codecformat="j2k"),
    }


def _make_camera_files(image: Image.Image) -> dict[str, bytes]:
    """HEIC and RAW."""
    import pillow_heif

    from tools.dng import Sensor, write_dng

    heif = BytesIO()
    pillow_heif.from_pillow(image).save(heif, quality=80)
    return {"a.heic": heif.getvalue(), "a.dng": write_dng(np.asarray(image) / 255, Sensor())}


def _make_text() -> "object":
    from PIL.PngImagePlugin import PngInfo

    text = PngInfo()
    text.add_text("Title", "a face")
    text.add_itxt("XML:com.adobe.xmp", _XMP.decode())
    text.add_text("Comment", "compressed " * 20, zip=True)
    return text


def _save(image: Image.Image, kind: str, **options: object) -> bytes:
    file = BytesIO()
    image.save(file, kind, **options)
    return file.getvalue()
