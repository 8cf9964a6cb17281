"""The same colours, stated by a file in every way that there is, are read as the same sRGB.

The right values are colour-science's.
"""

import io
import struct
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import colour
import numpy as np
import pytest
import tifffile
from imagecodecs import cms_profile, png_encode
from PIL import Image

from skinnet.errors import InputError
from skinnet.images import read_picture
from skinnet.images._icc import make_profile
from skinnet.images._named_spaces import ADOBE_RGB, DISPLAY_P3, WIDE_GAMUT_RGB

SKIN = np.array([[[0.80, 0.60, 0.50], [0.55, 0.36, 0.27]], [[0.30, 0.18, 0.13], [0.9, 0.75, 0.68]]])
"""sRGB of four skins, all inside every space below."""


def encode(space: str, exponent: float | None = None) -> np.ndarray:
    """The skins in another space, in [0, 1]."""
    linear = colour.RGB_to_RGB(
        SKIN, "sRGB", space, apply_cctf_decoding=True, apply_cctf_encoding=False
    )
    if exponent is not None:
        return linear ** (1 / exponent)
    return colour.RGB_COLOURSPACES[space].cctf_encoding(linear)


def to_uint8(values: np.ndarray) -> np.ndarray:
    return np.rint(values * 255).astype(np.uint8)


def enlarge(values: np.ndarray) -> np.ndarray:
    """Blocks of 16 pixels, which lossy formats keep."""
    return to_uint8(values).repeat(16, 0).repeat(16, 1)


def make_exif(space: int | None, index: str | None, make: str = "") -> Image.Exif:
    exif = Image.Exif()
    inner = exif.get_ifd(0x8769)
    if make:
        exif[0x010F] = make
    if space is not None:
        inner[0xA001] = space
    if index is not None:
        inner[0xA005] = {1: index}
    return exif


def save(path: Path, pixels: np.ndarray, **options: Any) -> Path:
    lossless = {".webp": {"lossless": True}, ".jpg": {"quality": 98, "subsampling": 0}}
    Image.fromarray(pixels).save(path, **lossless.get(path.suffix, {}), **options)
    return path


def check(path: Path, name: str, known_from: str, tolerance: float = 3) -> None:
    picture = read_picture(path)
    assert (picture.colour_space.name, picture.colour_space.known_from) == (name, known_from)
    read = picture.srgb.astype(float)
    step = read.shape[0] // 2
    centres = read[step // 2 :: step, step // 2 :: step]
    np.testing.assert_allclose(centres, SKIN * 255, atol=tolerance)
    linear = picture.linear()[step // 2 :: step, step // 2 :: step]
    np.testing.assert_allclose(linear, colour.cctf_decoding(SKIN), rtol=0.05, atol=0.003)


SUFFIXES = (".jpg", ".tif", ".png", ".webp")


@pytest.mark.parametrize("suffix", SUFFIXES)
@pytest.mark.parametrize(("space", "index"), [(65535, "R03"), (2, "R03"), (2, None), (2, "R98")])
def test_adobe_rgb_by_exif(
    tmp_path: Path, suffix: str, space: int | None, index: str | None
) -> None:
    exif = make_exif(space, index).tobytes()
    pixels = enlarge(encode("Adobe RGB (1998)"))
    check(save(tmp_path / f"_DSC1{suffix}", pixels, exif=exif), "Adobe RGB (1998)", "EXIF")


@pytest.mark.parametrize(
    ("name", "make", "space"),
    [
        ("_DSC1.jpg", "", "Adobe RGB (1998)"),
        ("DSC1.jpg", "NIKON CORPORATION", "Adobe RGB (1998)"),
        ("IMG_1.jpg", "Apple", "Display P3"),
    ],
)
def test_uncalibrated_exif_is_taken_as_what_its_writer_writes_and_said(
    tmp_path: Path, name: str, make: str, space: str
) -> None:
    exif = make_exif(65535, None, make).tobytes()
    path = save(tmp_path / name, enlarge(encode(space)), exif=exif)
    check(path, space, "EXIF")
    assert f"it is taken as {space}" in read_picture(path).notes[0]


def test_uncalibrated_exif_of_an_unknown_writer_is_taken_as_srgb_and_said(tmp_path: Path) -> None:
    path = save(tmp_path / "a.jpg", enlarge(SKIN), exif=make_exif(65535, None).tobytes())
    check(path, "sRGB", "assumed")
    assert "not calibrated, and names no space; it is taken as sRGB" in read_picture(path).notes[0]


@pytest.mark.parametrize("suffix", SUFFIXES)
@pytest.mark.parametrize(("space", "index"), [(1, None), (1, "R98"), (1, "R03"), (None, None)])
def test_srgb_stays_as_it_is(
    tmp_path: Path, suffix: str, space: int | None, index: str | None
) -> None:
    exif = make_exif(space, index).tobytes()
    path = save(tmp_path / f"_a{suffix}", enlarge(SKIN), exif=exif)
    check(path, "sRGB", "EXIF" if space else "assumed")
    assert not read_picture(path).notes


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_a_profile_counts_more_than_exif(tmp_path: Path, suffix: str) -> None:
    profile = make_profile(DISPLAY_P3.primaries, 2.2)
    path = save(
        tmp_path / f"_a{suffix}",
        enlarge(encode("Display P3", 2.2)),
        exif=make_exif(65535, "R03").tobytes(),
        icc_profile=profile,
    )
    check(path, "RGB built-in", "ICC profile")


def make_png(pixels: np.ndarray, *chunks: tuple[bytes, bytes]) -> bytes:
    """A PNG file with chunks before its pixels."""
    content = png_encode(pixels)
    head = 8 + 25
    extra = b"".join(
        struct.pack(">I", len(body)) + name + body + struct.pack(">I", zlib.crc32(name + body))
        for name, body in chunks
    )
    return content[:head] + extra + content[head:]


def gama(value: float) -> tuple[bytes, bytes]:
    return b"gAMA", struct.pack(">I", round(value * 100000))


def chrm(*values: float) -> tuple[bytes, bytes]:
    return b"cHRM", struct.pack(">8I", *(round(value * 100000) for value in values))


def cicp(primaries: int, transfer: int, full_range: int = 1) -> tuple[bytes, bytes]:
    return b"cICP", bytes([primaries, transfer, 0, full_range])


def iccp(profile: bytes) -> tuple[bytes, bytes]:
    return b"iCCP", b"name\0\0" + zlib.compress(profile)


SRGB = (b"sRGB", b"\0")
D65 = (0.3127, 0.329)
P3_CHRM = chrm(*D65, 0.68, 0.32, 0.265, 0.69, 0.15, 0.06)
ADOBE_CHRM = chrm(*D65, 0.64, 0.33, 0.21, 0.71, 0.15, 0.06)
SRGB_CHRM = chrm(*D65, 0.64, 0.33, 0.3, 0.6, 0.15, 0.06)
P3_PROFILE = make_profile(DISPLAY_P3.primaries, 2.2)

BOTH = "gAMA and cHRM chunks"

PNG_CASES: dict[str, tuple[np.ndarray, list[tuple[bytes, bytes]], str]] = {
    "linear": (encode("sRGB", 1.0), [gama(1.0)], "gAMA chunk"),
    "linear with sRGB primaries": (
        encode("sRGB", 1.0),
        [gama(1), SRGB_CHRM],
        BOTH,
    ),
    "linear P3": (encode("Display P3", 1.0), [gama(1.0), P3_CHRM], BOTH),
    "gamma 1.8": (encode("sRGB", 1.8), [gama(1 / 1.8)], "gAMA chunk"),
    "gamma 2.2 means sRGB": (SKIN, [gama(0.45455)], "gAMA chunk"),
    "Adobe RGB": (encode("Adobe RGB (1998)"), [gama(0.45455), ADOBE_CHRM], BOTH),
    "Display P3": (encode("Display P3"), [gama(0.45455), P3_CHRM], BOTH),
    "Display P3 by codes": (encode("Display P3"), [cicp(12, 13)], "cICP chunk"),
    "BT.2020 linear by codes": (encode("ITU-R BT.2020", 1.0), [cicp(9, 8)], "cICP chunk"),
    "BT.2020 by codes": (encode("ITU-R BT.2020"), [cicp(9, 14)], "cICP chunk"),
    "sRGB by codes": (SKIN, [cicp(1, 13)], "cICP chunk"),
    "sRGB counts more than gAMA": (SKIN, [SRGB, gama(1.0), P3_CHRM], "sRGB chunk"),
    "a profile counts more than sRGB": (
        encode("Display P3", 2.2),
        [iccp(P3_PROFILE), SRGB, gama(1.0)],
        "ICC profile",
    ),
    "cICP counts more than a profile": (SKIN, [cicp(1, 13), iccp(P3_PROFILE)], "cICP chunk"),
}


@pytest.mark.parametrize("depth", [8, 16])
@pytest.mark.parametrize("case", PNG_CASES)
def test_png_chunks(tmp_path: Path, case: str, depth: int) -> None:
    values, chunks, known_from = PNG_CASES[case]
    pixels = to_uint8(values) if depth == 8 else np.rint(values * 65535).astype(np.uint16)
    path = tmp_path / "a.png"
    path.write_bytes(make_png(pixels, *chunks))
    picture = read_picture(path)
    assert picture.colour_space.known_from == known_from
    # Eight bits of linear light are few in the dark.
    tolerance = 5 if depth == 8 and "linear" in case else 2
    np.testing.assert_allclose(picture.srgb, SKIN * 255, atol=tolerance)
    np.testing.assert_allclose(
        picture.linear(), colour.cctf_decoding(SKIN), atol=0.006 if depth == 8 else 2e-4
    )


@pytest.mark.parametrize(
    ("chunk", "words"),
    [
        (cicp(9, 16), r"high dynamic range \(PQ, stated by its cICP chunk\)"),
        (cicp(9, 18), r"high dynamic range \(HLG, stated by its cICP chunk\)"),
        (cicp(1, 13, 0), "narrow range, which is not read; save it as sRGB"),
        (cicp(77, 13), "primaries 77, transfer 13"),
    ],
)
def test_what_has_no_known_white_is_refused(
    tmp_path: Path, chunk: tuple[bytes, bytes], words: str
) -> None:
    path = tmp_path / "a.png"
    path.write_bytes(make_png(to_uint8(SKIN), chunk))
    with pytest.raises(InputError, match=rf"a\.png .*{words}"):
        read_picture(path)


@pytest.mark.parametrize("chunk", [gama(0.0), gama(20.0), chrm(*D65, 0, 0, 0, 0, 0, 0)])
def test_impossible_chunks_are_said_and_not_used(
    tmp_path: Path, chunk: tuple[bytes, bytes]
) -> None:
    path = tmp_path / "a.png"
    path.write_bytes(make_png(to_uint8(SKIN), chunk))
    check(path, "sRGB", "assumed", 1)


WRONG_PROFILES: dict[str, Callable[[], bytes]] = {
    "grey": lambda: bytes(cms_profile("gray", gamma=2.2)),
    "Lab": lambda: bytes(cms_profile("lab4")),
    "damaged": lambda: bytes(cms_profile("srgb"))[:200],
    "another thing": lambda: b"no profile at all, but some text",
    "CMYK": lambda: bytes(cms_profile("srgb")).replace(b"RGB XYZ ", b"CMYKLab ", 1),
}


@pytest.mark.parametrize("suffix", SUFFIXES)
@pytest.mark.parametrize("kind", WRONG_PROFILES)
def test_a_profile_that_does_not_fit_is_said_and_not_used(
    tmp_path: Path, suffix: str, kind: str
) -> None:
    path = save(tmp_path / f"a{suffix}", enlarge(SKIN), icc_profile=WRONG_PROFILES[kind]())
    check(path, "sRGB", "assumed")
    assert (
        f"a{suffix} has a colour profile that does not fit its RGB" in read_picture(path).notes[0]
    )


@pytest.mark.parametrize(
    ("space", "name"),
    [(ADOBE_RGB, "Adobe RGB (1998)"), (WIDE_GAMUT_RGB, "Adobe Wide Gamut RGB")],
)
def test_tiff_tags(tmp_path: Path, space: Any, name: str) -> None:
    primaries = [value for pair in space.primaries[1:] for value in pair]
    tags = [
        (318, 5, 2, rational(space.primaries.white), True),
        (319, 5, 6, rational(primaries), True),
    ]
    path = tmp_path / "a.tif"
    pixels = np.rint(encode(name) * 65535).astype(np.uint16)
    tifffile.imwrite(path, pixels, photometric="rgb", extratags=tags)
    picture = read_picture(path)
    assert picture.colour_space.known_from == "TIFF tags"
    np.testing.assert_allclose(picture.srgb, SKIN * 255, atol=2)


def rational(values: Any) -> tuple[int, ...]:
    return tuple(part for value in values for part in (round(value * 100000), 100000))


TIFF_LAYOUTS: dict[str, dict[str, Any]] = {
    "plain": {},
    "planes": {"planarconfig": "separate"},
    "deflated planes": {"planarconfig": "separate", "compression": "zlib"},
    "LZW": {"compression": "lzw", "predictor": True},
    "tiles": {"tile": (16, 16)},
    "big-endian": {"byteorder": ">"},
    "big-endian planes": {"byteorder": ">", "planarconfig": "separate"},
    "BigTIFF": {"bigtiff": True},
    "Zstandard": {"compression": "zstd"},
}


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16])
@pytest.mark.parametrize("alpha", [False, True])
@pytest.mark.parametrize("layout", TIFF_LAYOUTS)
def test_tiff_layouts(tmp_path: Path, layout: str, dtype: type, alpha: bool) -> None:
    options = TIFF_LAYOUTS[layout]
    top = np.iinfo(dtype).max
    pixels = np.rint(SKIN * top).astype(dtype).repeat(9, 0).repeat(8, 1)
    if alpha:
        pixels = np.concatenate([pixels, np.full_like(pixels[..., :1], top)], -1)
        options = options | {"extrasamples": ["unassalpha"]}
    stored = np.moveaxis(pixels, -1, 0) if options.get("planarconfig") else pixels
    path = tmp_path / "a.tif"
    tifffile.imwrite(path, stored, photometric="rgb", **options)
    picture = read_picture(path)
    np.testing.assert_array_equal(picture.pixels, pixels[..., :3])
    np.testing.assert_allclose(picture.srgb[4::9, 4::8], SKIN * 255, atol=1)


@pytest.mark.parametrize("photometric", ["minisblack", "miniswhite"])
@pytest.mark.parametrize("dtype", [np.uint8, np.uint16])
def test_grey_tiff_is_not_negative(tmp_path: Path, photometric: str, dtype: type) -> None:
    top = np.iinfo(dtype).max
    ramp = np.linspace(0, top, 12).astype(dtype).reshape(3, 4)
    stored = top - ramp if photometric == "miniswhite" else ramp
    path = tmp_path / "a.tif"
    tifffile.imwrite(path, stored, photometric=photometric)
    np.testing.assert_allclose(read_picture(path).srgb[..., 1], np.rint(ramp / top * 255), atol=1)


def test_the_orientation_of_a_16_bit_tiff_is_applied(tmp_path: Path) -> None:
    pixels = np.rint(SKIN * 65535).astype(np.uint16)
    path = tmp_path / "a.tif"
    tifffile.imwrite(path, pixels, photometric="rgb", extratags=[(274, 3, 1, 6, True)])
    np.testing.assert_array_equal(read_picture(path).pixels, np.rot90(pixels, -1))


@pytest.mark.parametrize("dtype", [np.float32, np.float16, np.int16, np.uint32])
def test_tiff_numbers_without_a_known_white_are_refused(tmp_path: Path, dtype: type) -> None:
    path = tmp_path / "a.tif"
    tifffile.imwrite(path, (SKIN * 100).astype(dtype), photometric="rgb")
    with pytest.raises(InputError, match=r"a\.tif"):
        read_picture(path)


def test_a_jpeg_with_a_gain_map_is_read_as_its_base_picture(tmp_path: Path) -> None:
    path = tmp_path / "a.jpg"
    base, gain = Image.fromarray(enlarge(SKIN)), Image.new("RGB", (8, 8))
    base.save(path, "MPO", save_all=True, append_images=[gain], quality=98, subsampling=0)
    check(path, "sRGB", "assumed")
    assert read_picture(path).notes == (f"{path} holds 2 pictures; the first is read.",)


@pytest.mark.parametrize("turned", [False, True])
def test_a_pillow_image_is_turned_by_the_tag_that_it_carries(turned: bool) -> None:
    exif = Image.Exif()
    exif[0x0112] = 6
    file = io.BytesIO()
    Image.fromarray(to_uint8(SKIN)).save(file, "PNG", exif=exif)
    image = Image.open(file)
    if turned:
        from PIL import ImageOps

        image = ImageOps.exif_transpose(image)
    np.testing.assert_array_equal(read_picture(image).srgb, np.rot90(to_uint8(SKIN), -1))


RAW_FILES: dict[str, dict[str, Any]] = {
    "DNG": {"photometric": "rgb", "extratags": [(50706, 1, 4, (1, 4, 0, 0), True)]},
    "a preview, as NEF and ARW begin with": {"photometric": "rgb", "subfiletype": 1},
    "linear raw": {"photometric": "linear_raw"},
    "a mosaic": {"photometric": "cfa"},
}


@pytest.mark.parametrize("kind", RAW_FILES)
def test_raw_files_that_are_tiff_inside_are_refused(tmp_path: Path, kind: str) -> None:
    pixels = to_uint8(SKIN)
    path = tmp_path / "a.tif"
    tifffile.imwrite(path, pixels[..., 0] if kind == "a mosaic" else pixels, **RAW_FILES[kind])
    with pytest.raises(
        InputError, match=r"a\.tif is (a RAW file( that|,) .*develop it|not a picture)"
    ):
        read_picture(path)
