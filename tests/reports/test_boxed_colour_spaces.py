"""HEIF, AVIF, JPEG 2000 and BMP state their colours in boxes and headers of their own."""

import io
import struct
import sys
from typing import Any

import colour
import numpy as np
import pillow_heif
import pytest
from PIL import Image

from skinnet.errors import InputError
from skinnet.images import read_picture
from skinnet.images._icc import make_profile
from skinnet.images._named_spaces import DISPLAY_P3

SKIN = np.array([[[0.80, 0.60, 0.50], [0.55, 0.36, 0.27]], [[0.30, 0.18, 0.13], [0.9, 0.75, 0.68]]])
LINEAR_P3 = colour.RGB_to_RGB(SKIN, "sRGB", "Display P3", apply_cctf_decoding=True)
PROFILE = make_profile(DISPLAY_P3.primaries, 2.2)


def enlarge(values: np.ndarray) -> Image.Image:
    pixels = np.rint(values * 255).astype(np.uint8)
    return Image.fromarray(pixels.repeat(16, 0).repeat(16, 1))


SRGB_IMAGE = enlarge(SKIN)
P3_IMAGE = enlarge(colour.cctf_encoding(LINEAR_P3))
P3_IMAGE_22 = enlarge(LINEAR_P3 ** (1 / 2.2))


def make_heif(image: Image.Image, **options: Any) -> bytes:
    file = io.BytesIO()
    pillow_heif.from_pillow(image).save(file, quality=95, chroma=444, **options)
    return file.getvalue()


def make_avif(image: Image.Image, points: tuple[int, int], **options: Any) -> bytes:
    file = io.BytesIO()
    image.save(file, "AVIF", quality=95, subsampling="4:4:4", **options)
    content = file.getvalue()
    at = content.index(b"colrnclx") + 8
    return content[:at] + struct.pack(">HH", *points) + content[at + 4 :]


def make_jp2(image: Image.Image, profile: bytes | None) -> bytes:
    """JPEG 2000 whose colr box holds a profile in place of an enumerated space."""
    file = io.BytesIO()
    image.save(file, "JPEG2000")
    content = file.getvalue()
    if profile is None:
        return content
    start, box = content.index(b"jp2h") - 4, content.index(b"colr") - 4
    old = struct.unpack_from(">I", content, box)[0]
    new = struct.pack(">I4s3B", 11 + len(profile), b"colr", 2, 0, 0) + profile
    size = struct.unpack_from(">I", content, start)[0] + len(new) - old
    return (
        b"".join((content[:start], struct.pack(">I", size), content[start + 4 : box], new))
        + content[box + old :]
    )


def make_bmp(
    image: Image.Image, kind: bytes, ends: Any = (0,) * 9, gamma: float = 0, profile: bytes = b""
) -> bytes:
    """BMP with a header of version 5."""
    pixels = np.asarray(image)[::-1, :, ::-1].tobytes()
    head = struct.pack("<IiiHHIIiiII", 124, *image.size, 1, 24, 0, len(pixels), 2835, 2835, 0, 0)
    head += struct.pack("<4I4s", 0, 0, 0, 0, kind[::-1])
    head += struct.pack("<9i", *(round(value * 2**30) for value in ends))
    head += struct.pack("<3I", *(round(gamma * 2**16),) * 3)
    head += struct.pack("<4I", 4, 124 + len(pixels) if profile else 0, len(profile), 0)
    size = 138 + len(pixels) + len(profile)
    return struct.pack("<2sIHHI", b"BM", size, 0, 0, 138) + head + pixels + profile


P3_XYZ = colour.RGB_COLOURSPACES["Display P3"].matrix_RGB_to_XYZ.T.ravel()
P3_CODES = {"color_primaries": 12, "transfer_characteristics": 13}

CASES: dict[str, tuple[bytes, str, str]] = {
    "HEIF, codes of P3": (make_heif(P3_IMAGE, **P3_CODES), "Display P3", "nclx box"),
    "HEIF, codes of sRGB": (make_heif(SRGB_IMAGE), "sRGB", "nclx box"),
    "AVIF, codes of P3": (make_avif(P3_IMAGE, (12, 13)), "Display P3", "nclx box"),
    "AVIF, codes of sRGB": (make_avif(SRGB_IMAGE, (1, 13)), "sRGB", "nclx box"),
    "AVIF, codes of BT.709": (make_avif(SRGB_IMAGE, (1, 1)), "sRGB", "nclx box"),
    "AVIF, no codes": (make_avif(SRGB_IMAGE, (2, 2)), "sRGB", "assumed"),
    "JPEG 2000, sRGB": (make_jp2(SRGB_IMAGE, None), "sRGB", "colr box"),
    "JPEG 2000, profile": (make_jp2(P3_IMAGE_22, PROFILE), "RGB built-in", "ICC profile"),
    "BMP, sRGB": (make_bmp(SRGB_IMAGE, b"sRGB"), "sRGB", "assumed"),
    "BMP, system's": (make_bmp(SRGB_IMAGE, b"Win "), "sRGB", "assumed"),
    "BMP, profile": (make_bmp(P3_IMAGE_22, b"MBED", profile=PROFILE), "RGB built-in", "BMP header"),
    "BMP, primaries": (
        make_bmp(P3_IMAGE, b"\0\0\0\0", P3_XYZ, 2.2),
        "Display P3",
        "BMP header",
    ),
}


@pytest.mark.parametrize("case", CASES)
def test_boxes_and_headers(case: str) -> None:
    content, name, known_from = CASES[case]
    picture = read_picture(io.BytesIO(content), "a")
    assert (picture.colour_space.name, picture.colour_space.known_from) == (name, known_from)
    np.testing.assert_allclose(picture.srgb[8::16, 8::16], SKIN * 255, atol=3)
    assert not picture.notes


def test_a_profile_counts_more_than_codes() -> None:
    image = P3_IMAGE_22.copy()
    content = make_avif(image, (1, 13), icc_profile=PROFILE)
    picture = read_picture(io.BytesIO(content), "a")
    assert picture.colour_space.known_from == "ICC profile"
    np.testing.assert_allclose(picture.srgb[8::16, 8::16], SKIN * 255, atol=3)


@pytest.mark.parametrize(("transfer", "words"), [(16, "PQ"), (18, "HLG")])
@pytest.mark.parametrize("kind", ["HEIF", "AVIF"])
def test_high_dynamic_range_is_refused(kind: str, transfer: int, words: str) -> None:
    codes = {"color_primaries": 9, "transfer_characteristics": transfer}
    content = (
        make_heif(SRGB_IMAGE, **codes) if kind == "HEIF" else make_avif(SRGB_IMAGE, (9, transfer))
    )
    with pytest.raises(InputError, match=rf"a is a picture of high dynamic range \({words}, "):
        read_picture(io.BytesIO(content), "a")


def test_a_profile_that_states_pq_is_refused() -> None:
    tag = b"cicp\0\0\0\0" + bytes([9, 16, 0, 1])
    count = struct.unpack_from(">I", PROFILE, 128)[0]
    table = PROFILE[132 : 132 + 12 * count]
    moved = b"".join(
        struct.pack(">4sII", name, offset + 12, size)
        for name, offset, size in struct.iter_unpack(">4sII", table)
    )
    end = len(PROFILE) + 12
    entry = struct.pack(">4sII", b"cicp", end, 12)
    profile = struct.pack(">I", end + 12) + PROFILE[4:128] + struct.pack(">I", count + 1)
    profile += entry + moved + PROFILE[132 + 12 * count :] + tag
    file = io.BytesIO()
    SRGB_IMAGE.save(file, "PNG", icc_profile=profile)
    with pytest.raises(InputError, match="PQ, stated by its colour profile"):
        read_picture(io.BytesIO(file.getvalue()), "a")


def test_heic_without_the_extra_names_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pillow_heif", None)
    with pytest.raises(InputError, match=r'a is a HEIC picture.*pip install "skinnet\[heif\]"'):
        read_picture(io.BytesIO(make_heif(SRGB_IMAGE)), "a")
