"""Writers of picture files, each with everything that its format holds."""

from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from skinnet.files import READ_ERRORS
from skinnet.images import _segments as jpeg
from skinnet.images._carried import Carried
from skinnet.images._exif import read_orientation
from skinnet.images._mark import append_mark
from skinnet.images.picture import Picture

_QUALITY = 95
_SUBSAMPLINGS = {0: "4:4:4", 1: "4:2:2", 2: "4:2:0"}


def write_jpeg(path: Path, picture: Picture, carried: Carried, quality: int | None = None) -> None:
    """Write a JPEG file with the subsampling of the original, if that is one.

    Without a quality it has the original's tables too.
    """
    image = _to_pillow(picture)
    buffer = BytesIO()
    options = _choose_tables(carried, image.mode)
    if quality is not None:
        options = {key: value for key, value in options.items() if key != "qtables"}
        options["quality"] = quality
    try:
        image.save(buffer, "JPEG", **options)
    except READ_ERRORS:  # tables that Pillow does not write
        image.save(buffer, "JPEG", quality=quality or _QUALITY, subsampling=0)
    encoded = buffer.getvalue()
    path.write_bytes(jpeg.replace_segments(encoded, _list_jpeg_segments(carried, encoded)))


def write_webp(path: Path, picture: Picture, carried: Carried, quality: int | None = None) -> None:
    """Write a WebP file; without a quality it has loss only if the original is one with loss."""
    lossless = quality is None and carried.own.get("lossless", True)
    _to_pillow(picture).save(
        path,
        "WEBP",
        lossless=lossless,
        exact=True,
        quality=70 if lossless else quality or _QUALITY,
        exif=carried.exif,
        xmp=carried.xmp,
        icc_profile=carried.profile,
    )


def write_avif(path: Path, picture: Picture, carried: Carried, quality: int | None = None) -> None:
    """Write an AVIF file."""
    _to_pillow(picture).save(
        path,
        "AVIF",
        quality=quality or _QUALITY,
        subsampling="4:4:4",
        exif=carried.exif,
        xmp=carried.xmp,
        icc_profile=carried.profile or None,
    )


def write_heif(path: Path, picture: Picture, carried: Carried, quality: int | None = None) -> None:
    """Write a HEIC file."""
    import pillow_heif

    image = _to_pillow(picture)
    if carried.profile:
        image.info["icc_profile"] = carried.profile
    file = pillow_heif.from_pillow(image)
    with path.open("wb") as target:
        file.save(
            target,
            quality=quality or _QUALITY,
            chroma=444,
            exif=carried.exif or None,
            xmp=carried.xmp or None,
        )


def write_bmp(path: Path, picture: Picture, carried: Carried) -> None:
    """Write a BMP file."""
    _to_pillow(picture).save(path, "BMP", dpi=carried.dpi or (72, 72))
    _mark_end(path, carried)


def write_ppm(path: Path, picture: Picture, carried: Carried) -> None:
    """Write a PPM file of 8 or 16 bits."""
    height, width = picture.pixels.shape[:2]
    top = np.iinfo(picture.pixels.dtype).max
    with path.open("wb") as file:
        file.write(f"P6\n{width} {height}\n{top}\n".encode("ascii"))
        file.write(picture.pixels.astype(picture.pixels.dtype.newbyteorder(">")).tobytes())
    _mark_end(path, carried)


def join_alpha(picture: Picture) -> NDArray[Any]:
    """Pixels with alpha as the last channel, if there is one."""
    if picture.alpha is None:
        return picture.pixels
    return np.concatenate([picture.pixels, picture.alpha[..., None]], -1)


def _to_pillow(picture: Picture) -> Image.Image:
    if picture.pixels.shape[2] == 4:
        return Image.fromarray(picture.pixels, "CMYK")
    return Image.fromarray(join_alpha(picture))


def _mark_end(path: Path, carried: Carried) -> None:
    if carried.mark is not None:
        append_mark(path, carried.mark)


def _choose_tables(carried: Carried, mode: str) -> dict[str, Any]:
    own = carried.own
    tables = own.get("tables")
    if not tables:
        return {"quality": _QUALITY, "subsampling": 0}
    turned = read_orientation(own.get("exif", b""), own.get("xmp", b"")) >= 5
    ordered = [np.reshape(table, (8, 8)) for _, table in sorted(tables.items())]
    sampling = own.get("sampling", 0)
    # Turned by 90 degrees, 4:2:2 would become 4:4:0, which Pillow does not write.
    kept = sampling in _SUBSAMPLINGS and mode == "RGB" and not (turned and sampling == 1)
    return {
        "qtables": [(table.T if turned else table).ravel().tolist() for table in ordered],
        "subsampling": _SUBSAMPLINGS[sampling] if kept else "4:4:4",
        "progressive": own.get("progressive", False),
        "keep_rgb": own.get("rgb", False),
    }


def _list_jpeg_segments(carried: Carried, encoded: bytes) -> list[jpeg.Segment]:
    own = list(carried.own.get("segments", ()))
    segments = [_choose_head(own, encoded)] if own or encoded else []
    if carried.exif:
        segments.append((jpeg.EXIF_OR_XMP, jpeg.EXIF_PREFIX + carried.exif))
    if carried.xmp:
        segments.append((jpeg.EXIF_OR_XMP, jpeg.XMP_PREFIX + carried.xmp))
    segments += [*jpeg.split_profile(carried.profile), *jpeg.split_resources(carried.photoshop)]
    segments += [segment for segment in own if jpeg.is_plain(segment)]
    has_comment = any(marker == jpeg.COMMENT for marker, _ in own)
    if carried.comment and not has_comment:
        segments.append((jpeg.COMMENT, carried.comment[: jpeg.LARGEST]))
    return [segment for segment in segments if segment[1]]


def _choose_head(own: list[jpeg.Segment], encoded: bytes) -> jpeg.Segment:
    """The original's JFIF segment without a thumbnail, or an empty one."""
    for marker, content in own or jpeg.list_segments(encoded):
        if marker == jpeg.APP0 and content.startswith(jpeg.JFIF_PREFIX):
            return marker, content[:12] + b"\0\0"
    return jpeg.APP0, b""
