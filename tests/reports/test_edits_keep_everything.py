"""An edited photograph is its original but for the skin, read back by other readers.

They are Pillow, tifffile and imagecodecs.

The right colours are those of the edit of the sRGB version, converted by colour-science.
"""

import io
import struct
import warnings
import zlib
from functools import cache
from pathlib import Path
from typing import Any

import colour
import imagecodecs
import numpy as np
import pytest
import tifffile
from PIL import ExifTags, Image, IptcImagePlugin, JpegImagePlugin, PngImagePlugin
from skimage.color import lab2rgb, rgb2lab
from skimage.data import astronaut

from skinnet import Decomposer
from skinnet.errors import InputError
from skinnet.images import Picture, read_photo, read_picture
from skinnet.images._icc import make_profile, make_srgb_profile
from skinnet.images._mark import EDITED, Mark, read_mark
from skinnet.images._named_spaces import ADOBE_RGB, DISPLAY_P3
from skinnet.images._write import choose_suffix, write_picture

FACE = np.ascontiguousarray(astronaut()[40:200, 144:304])
MARK = Mark("edit", EDITED, "0123456789abcdef" * 4)
PROFILES = {
    "Display P3": make_profile(DISPLAY_P3.primaries, 2.2),
    "Adobe RGB (1998)": make_profile(ADOBE_RGB.primaries, 563 / 256),
    "sRGB": make_srgb_profile(),
}
EXPONENTS = {"Display P3": 2.2, "Adobe RGB (1998)": 563 / 256}
XMP = (
    b'<?xpacket begin="" id="W5M0MpCehiHzreSzNTczkc9d"?><x:xmpmeta xmlns:x="adobe:ns:meta/">'
    b'<rdf:RDF xmlns:rdf="http://www.w3.org/1999/02/22-rdf-syntax-ns#"><rdf:Description '
    b'xmlns:tiff="http://ns.adobe.com/tiff/1.0/" xmlns:xmp="http://ns.adobe.com/xap/1.0/" '
    b'xmp:Rating="4" tiff:Orientation="1"/></rdf:RDF></x:xmpmeta><?xpacket end="w"?>'
)


@cache
def load() -> Decomposer:
    return Decomposer(threads=1)


@cache
def edit_srgb() -> np.ndarray:
    """The edit of the face in sRGB, which is the right result for every file."""
    return load().edit(FACE, melanin=2.0, hemoglobin=1.5)


def edit(path: Path, suffix: str | None = None) -> tuple[Path, tuple[str, ...]]:
    """Edit a file as the command does; its new path and what is said."""
    picture = read_picture(path)
    chosen, notes = choose_suffix(picture, path.suffix)
    target = path.with_name(f"{path.stem}_edited{suffix or chosen}")
    edited = load().edit_picture(picture, 2.0, 1.5)
    return target, (*notes, *write_picture(target, edited, MARK))


def encode(space: str, dtype: type = np.uint8, pixels: np.ndarray = FACE) -> np.ndarray:
    """sRGB pixels in another space."""
    values = pixels / 255
    if space != "sRGB":
        linear = colour.RGB_to_RGB(
            values, "sRGB", space, apply_cctf_decoding=True, apply_cctf_encoding=False
        )
        values = linear.clip(0, 1) ** (1 / EXPONENTS[space])
    return np.rint(values * np.iinfo(dtype).max).astype(dtype)


def decode(space: str, pixels: np.ndarray) -> np.ndarray:
    """Pixels of a space in sRGB, from 0 to 255."""
    values = pixels / np.iinfo(pixels.dtype).max
    if space == "sRGB":
        return values * 255
    linear = values ** EXPONENTS[space]
    return 255 * colour.RGB_to_RGB(
        linear, space, "sRGB", apply_cctf_decoding=False, apply_cctf_encoding=True
    ).clip(0, 1)


def make_alpha(dtype: type = np.uint8) -> np.ndarray:
    """A cut-out: transparent at the left, and a soft edge."""
    ramp = np.clip((np.arange(FACE.shape[1]) - 20) / 30, 0, 1) * np.iinfo(dtype).max
    return np.broadcast_to(np.rint(ramp), FACE.shape[:2]).astype(dtype)


@cache
def find_untouched(alpha: bool) -> np.ndarray:
    """Pixels that an edit of the face leaves as they are; a cut-out is read mixed with white."""
    photo = read_photo(Image.fromarray(np.dstack([FACE, make_alpha()]))) if alpha else FACE
    return np.asarray((load().edit(photo, melanin=2.0, hemoglobin=1.5) == photo).all(-1))


def make_exif(orientation: int | None = None, **inner: Any) -> Image.Exif:
    exif = Image.Exif()
    exif[0x010F], exif[0x0110], exif[0x8298] = "NIKON CORPORATION", "NIKON D90", "A. Person"
    exif[0x011A] = exif[0x011B] = 300.0
    exif[0x0128] = 2
    if orientation is not None:
        exif[0x0112] = orientation
    more = exif.get_ifd(0x8769)
    more[0x829D], more[0x9003] = 2.8, "2021:03:04 05:06:07"
    more[0x927C] = b"Nikon\0\x02\x10\0\0" + bytes(range(200))
    more[0xA002], more[0xA003] = FACE.shape[1], FACE.shape[0]
    more |= {int(tag, 16): value for tag, value in inner.items()}
    exif.get_ifd(0x8825)[1], exif.get_ifd(0x8825)[2] = "N", (47.0, 22.0, 1.5)
    return exif


def list_exif(path: Path) -> dict[Any, Any]:
    """All that EXIF holds but the mark."""
    with Image.open(path) as image:
        exif = image.getexif()
        inner = {(ifd, tag): v for ifd in (0x8769, 0x8825) for tag, v in exif.get_ifd(ifd).items()}
        return {tag: v for tag, v in exif.items() if tag not in (0x000B, 0x8769, 0x8825)} | inner


LOSSLESS = (".png", ".tif", ".webp")
CODEC = 8
"""Largest usual error of two codings with loss, in levels."""


def save(path: Path, pixels: np.ndarray, **options: Any) -> Path:
    """A file by Pillow, and of 16 bits by tifffile or imagecodecs."""
    if pixels.dtype == np.uint16:
        return save_deep(path, pixels, **options)
    own = {
        ".webp": {"lossless": True, "exact": True},
        ".jpg": {"quality": 97, "subsampling": 0},
        ".avif": {"quality": 97, "subsampling": "4:4:4"},
    }
    Image.fromarray(pixels).save(path, **own.get(path.suffix, {}), **options)
    return path


def save_deep(path: Path, pixels: np.ndarray, icc_profile: bytes | None = None) -> Path:
    if path.suffix == ".tif":
        extra = ["unassalpha"] if pixels.shape[2] == 4 else None
        options = {"photometric": "rgb", "extrasamples": extra, "compression": "lzw"}
        tifffile.imwrite(path, pixels, iccprofile=icc_profile, **options)
        return path
    profile = [(b"iCCP", b"p\0\0" + zlib.compress(icc_profile))] if icc_profile else []
    path.write_bytes(make_png(pixels, *profile))
    return path


def make_png(pixels: np.ndarray, *chunks: tuple[bytes, bytes]) -> bytes:
    content = imagecodecs.png_encode(pixels)
    extra = b"".join(
        struct.pack(">I", len(body)) + name + body + struct.pack(">I", zlib.crc32(name + body))
        for name, body in chunks
    )
    return content[:33] + extra + content[33:]


def load_pixels(path: Path) -> np.ndarray:
    """Pixels as they are stored, by a reader that is not skinnet's."""
    if path.suffix == ".tif":
        return tifffile.imread(path)
    if path.suffix == ".png":
        return imagecodecs.png_decode(path.read_bytes())
    with Image.open(path) as image:
        return np.array(image)


def name_format(path: Path) -> str | None:
    with Image.open(path) as image:
        return image.format


def load_profile(path: Path) -> bytes | None:
    with Image.open(path) as image:
        return image.info.get("icc_profile")


def check_colours(srgb: np.ndarray, tolerance: float) -> None:
    """Compare with the edit of the sRGB version; its brightest and darkest pixels are clipped."""
    difference = np.abs(np.asarray(srgb, float) - edit_srgb())
    assert np.quantile(difference, 0.99) <= tolerance
    assert np.abs(edit_srgb().astype(float) - FACE).mean() > 5


DEPTHS = [(".png", np.uint8), (".png", np.uint16), (".tif", np.uint8), (".tif", np.uint16)]
DEPTHS += [(".webp", np.uint8), (".jpg", np.uint8), (".avif", np.uint8)]


@pytest.mark.parametrize("alpha", [False, True])
@pytest.mark.parametrize("space", ["Display P3", "Adobe RGB (1998)"])
@pytest.mark.parametrize(("suffix", "dtype"), DEPTHS)
def test_profile_depth_alpha_and_colours(
    tmp_path: Path, suffix: str, dtype: type, space: str, alpha: bool
) -> None:
    pixels = encode(space, dtype)
    if alpha and suffix == ".jpg":
        pytest.skip("JPEG holds no transparency")
    stored = np.dstack([pixels, make_alpha(dtype)]) if alpha else pixels
    path, notes = edit(save(tmp_path / f"a{suffix}", stored, icc_profile=PROFILES[space]))
    assert path.name == f"a_edited{suffix}" and notes == ()
    assert load_profile(path) == PROFILES[space]
    assert read_mark(path) == MARK
    result = load_pixels(path)
    assert result.dtype == dtype and result.shape == stored.shape
    if suffix in LOSSLESS:
        untouched = find_untouched(alpha)
        assert 0.1 < untouched.mean() < 0.9
        kept = (result == stored).all(-1)
        assert kept[untouched].mean() > 0.99  # a change that is too small for 8 bits of sRGB
        if alpha:
            np.testing.assert_array_equal(result[..., 3], make_alpha(dtype))
            np.testing.assert_array_equal(result[:, :20], stored[:, :20])
    if dtype == np.uint16:
        assert len(np.unique(result[~(result == stored).all(-1)])) > 2000
    if not alpha:
        check_colours(decode(space, result[..., :3]), 2 if suffix in LOSSLESS else CODEC)


def test_alpha_of_an_avif_is_kept_within_its_loss(tmp_path: Path) -> None:
    stored = np.dstack([FACE, make_alpha()])
    path, _ = edit(save(tmp_path / "a.avif", stored))
    assert np.abs(load_pixels(path)[..., 3].astype(int) - make_alpha()).max() < 12


def test_an_edit_that_changes_nothing_keeps_every_pixel(tmp_path: Path) -> None:
    for dtype, name in ((np.uint8, "a.png"), (np.uint16, "a.tif")):
        stored = encode("Display P3", dtype)
        path = save(tmp_path / name, stored, icc_profile=PROFILES["Display P3"])
        picture = load().edit_picture(read_picture(path))
        np.testing.assert_array_equal(picture.pixels, stored)


WITH_EXIF = (".jpg", ".png", ".tif", ".webp", ".avif")


@pytest.mark.parametrize("suffix", WITH_EXIF)
def test_exif_xmp_and_resolution_stay(tmp_path: Path, suffix: str) -> None:
    options: dict[str, Any] = {"exif": make_exif().tobytes()}
    if suffix == ".png":
        options["pnginfo"] = PngImagePlugin.PngInfo()
        options["pnginfo"].add_itxt("XML:com.adobe.xmp", XMP.decode())
    elif suffix == ".tif":
        exif = make_exif()
        exif[700] = XMP
        options["exif"] = exif.tobytes()
    else:
        options["xmp"] = XMP
    if suffix in (".jpg", ".png", ".tif"):
        options["dpi"] = (300, 300)
    path = save(tmp_path / f"a{suffix}", FACE, **options)
    target, notes = edit(path)
    assert notes == ()
    layout = range(254, 280)
    before, after = (
        {tag: value for tag, value in list_exif(each).items() if tag not in layout}
        for each in (path, target)
    )
    for tag in (259, 273, 278, 279, 284, 338, 339, 317):
        before.pop(tag, None), after.pop(tag, None)
    assert after == before
    assert before[(0x8769, 0x927C)].startswith(b"Nikon")
    with Image.open(path) as one, Image.open(target) as other:
        assert other.info.get("xmp") == one.info.get("xmp") == XMP
        assert other.info.get("dpi") == one.info.get("dpi")


@pytest.mark.parametrize("orientation", range(1, 9))
@pytest.mark.parametrize("suffix", WITH_EXIF)
def test_a_turned_photograph_becomes_upright_once(
    tmp_path: Path, suffix: str, orientation: int
) -> None:
    upright = FACE[:, 10:]
    stored = turn_back(upright, orientation)
    exif = make_exif(orientation, a002=stored.shape[1], a003=stored.shape[0]).tobytes()
    path, _ = edit(save(tmp_path / f"a{suffix}", stored, exif=exif))
    with Image.open(path) as image:
        assert image.getexif().get(0x0112, 1) == 1
        inner = image.getexif().get_ifd(0x8769)
        assert (inner[0xA002], inner[0xA003]) == (upright.shape[1], upright.shape[0])
    right = load().edit(upright, 2.0, 1.5)
    tolerance = 0 if suffix in LOSSLESS else CODEC
    assert np.quantile(np.abs(load_pixels(path).astype(int) - right), 0.99) <= tolerance


def turn_back(upright: np.ndarray, orientation: int) -> np.ndarray:
    """Pixels whose turn by an orientation of EXIF gives the upright ones."""
    rows, columns = orientation in (3, 4, 7, 8), orientation in (2, 3, 6, 7)
    stored = upright[:: -1 if rows else 1, :: -1 if columns else 1]
    return np.ascontiguousarray(stored.swapaxes(0, 1) if orientation >= 5 else stored)


def test_maker_notes_stay_at_their_offset_and_the_thumbnail_goes(tmp_path: Path) -> None:
    small = io.BytesIO()
    Image.fromarray(FACE[::4, ::4]).save(small, "JPEG")
    exif = make_exif(6).tobytes()[6:]
    order = "<" if exif[:2] == b"II" else ">"
    first = struct.unpack_from(f"{order}I", exif, 4)[0]
    pointer = first + 2 + 12 * struct.unpack_from(f"{order}H", exif, first)[0]
    second = len(exif)
    thumbnail = struct.pack(f"{order}H", 2) + b"".join(
        struct.pack(f"{order}HHII", tag, 4, 1, value)
        for tag, value in ((0x0201, second + 30), (0x0202, len(small.getvalue())))
    )
    block = bytearray(exif + thumbnail + b"\0" * 4 + small.getvalue())
    struct.pack_into(f"{order}I", block, pointer, second)
    path = save(tmp_path / "a.jpg", FACE, exif=b"Exif\0\0" + bytes(block))
    with Image.open(path) as image:
        assert image.getexif().get_ifd(ExifTags.IFD.IFD1)[0x0201]
    target, _ = edit(path)
    with Image.open(target) as image:
        result = image.info["exif"][6:]
        assert not image.getexif().get_ifd(ExifTags.IFD.IFD1)
    assert result.index(b"Nikon\0\x02") == exif.index(b"Nikon\0\x02")
    assert small.getvalue()[20:] not in target.read_bytes()


EXIF_ONLY = [{"a001": 65535, "a005": {1: "R03"}}, {"a001": 2}, {"a001": 65535}]


@pytest.mark.parametrize("target", [None, ".png", ".tif", ".jpg"])
@pytest.mark.parametrize("inner", EXIF_ONLY)
@pytest.mark.parametrize("suffix", [".jpg", ".png", ".webp"])
def test_adobe_rgb_that_exif_alone_states_stays_adobe_rgb(
    tmp_path: Path, suffix: str, inner: dict[str, Any], target: str | None
) -> None:
    exif = make_exif(None, **inner)
    path = save(tmp_path / f"_DSC1{suffix}", encode("Adobe RGB (1998)"), exif=exif)
    path, notes = edit(path, target)
    assert notes == ()
    read = read_picture(path)
    lossy = ".jpg" in (suffix, path.suffix)
    check_colours(decode("Adobe RGB (1998)", load_pixels(path)), CODEC if lossy else 2)
    check_colours(read.srgb.astype(float), CODEC if lossy else 2)
    moved = read_picture(path.rename(tmp_path / f"moved{path.suffix}"))
    check_colours(moved.srgb.astype(float), CODEC if lossy else 2)


CHUNKS = {
    "cICP": [(b"cICP", bytes([12, 13, 0, 1]))],
    "gAMA and cHRM": [
        (b"gAMA", struct.pack(">I", 45455)),
        (b"cHRM", struct.pack(">8I", 31270, 32900, 68000, 32000, 26500, 69000, 15000, 6000)),
    ],
}


@pytest.mark.parametrize("target", [None, ".tif", ".jpg", ".webp"])
@pytest.mark.parametrize("dtype", [np.uint8, np.uint16])
@pytest.mark.parametrize("case", CHUNKS)
def test_colours_that_chunks_state_stay(
    tmp_path: Path, case: str, dtype: type, target: str | None
) -> None:
    linear = colour.RGB_to_RGB(
        FACE / 255, "sRGB", "Display P3", apply_cctf_decoding=True, apply_cctf_encoding=True
    )
    stored = np.rint(linear * np.iinfo(dtype).max).astype(dtype)
    (tmp_path / "a.png").write_bytes(make_png(stored, *CHUNKS[case]))
    path, _ = edit(tmp_path / "a.png", target)
    check_colours(read_picture(path).srgb.astype(float), CODEC if target == ".jpg" else 3)
    if target is None:
        content = path.read_bytes()
        assert all(body in content for _, body in CHUNKS[case]) and b"iCCP" not in content
        assert read_picture(path).colour_space == read_picture(tmp_path / "a.png").colour_space
    else:
        assert load_profile(path)


def test_png_keeps_its_chunks(tmp_path: Path) -> None:
    chunks = [
        (b"pHYs", struct.pack(">IIB", 11811, 11811, 1)),
        (b"tEXt", b"Software\0GIMP 2.10"),
        (b"tEXt", b"Author\0A. Person"),
        (b"zTXt", b"Description\0\0" + zlib.compress(b"a long text")),
        (b"iTXt", "Title\0\0\0\0\0Größe".encode()),
        (b"tIME", struct.pack(">H5B", 2020, 1, 2, 3, 4, 5)),
        (b"bKGD", struct.pack(">3H", 1, 2, 3)),
        (b"sBIT", bytes([8, 8, 8])),
        (b"skNt", b"a private chunk"),
    ]
    (tmp_path / "a.png").write_bytes(make_png(FACE, *chunks))
    path, notes = edit(tmp_path / "a.png")
    content = path.read_bytes()
    for name, body in chunks:
        assert content.count(name + body) == 1
    with Image.open(path) as image:
        image.load()
        assert image.text["Title"] == "Größe" and image.text["Software"] == "GIMP 2.10"
        assert image.text["Description"] == "a long text"
    assert notes == () and read_mark(path) == MARK


def test_a_raw_profile_of_imagemagick_does_not_turn_the_result_again(tmp_path: Path) -> None:
    block = make_exif(6).tobytes()
    text = f"\nexif\n{len(block):8}\n{block.hex()}\n".encode()
    chunk = (b"zTXt", b"Raw profile type exif\0\0" + zlib.compress(text))
    (tmp_path / "a.png").write_bytes(make_png(turn_back(FACE, 6), chunk))
    path, _ = edit(tmp_path / "a.png")
    with Image.open(path) as image:
        assert image.getexif().get(0x0112) == 1
        assert image.getexif()[0x010F] == "NIKON CORPORATION"
    np.testing.assert_array_equal(load_pixels(path), edit_srgb())


def test_a_palette_with_transparency_becomes_full_colours_with_alpha(tmp_path: Path) -> None:
    image = Image.fromarray(FACE).quantize(256)
    image.save(tmp_path / "a.png", transparency=image.getpixel((0, 0)))
    with Image.open(tmp_path / "a.png") as palette:
        stored = np.array(palette.convert("RGBA"))
    path, _ = edit(tmp_path / "a.png")
    result = load_pixels(path)
    np.testing.assert_array_equal(result[..., 3], stored[..., 3])
    assert (stored[..., 3] == 0).any()
    np.testing.assert_array_equal(result[stored[..., 3] == 0], stored[stored[..., 3] == 0])


@pytest.mark.parametrize("subsampling", [0, 1, 2])
@pytest.mark.parametrize("quality", [70, 92])
def test_jpeg_keeps_tables_subsampling_comment_and_iptc(
    tmp_path: Path, quality: int, subsampling: int
) -> None:
    caption = struct.pack(">BBBH", 0x1C, 2, 120, 7) + b"caption"
    thumbnail = b"8BIM" + struct.pack(">HHI", 1036, 0, 10) + b"0123456789"
    resources = thumbnail + b"8BIM" + struct.pack(">HHI", 1028, 0, 12) + caption
    options: dict[str, Any] = {"quality": quality, "subsampling": subsampling, "dpi": (300, 300)}
    buffer = io.BytesIO()
    Image.fromarray(FACE).save(buffer, "JPEG", comment="a comment", progressive=True, **options)
    segment = b"Photoshop 3.0\0" + resources
    other = b"\xff\xe4" + struct.pack(">H", 9) + b"private"
    content = buffer.getvalue()
    path = tmp_path / "a.jpeg"
    path.write_bytes(
        content[:20]
        + other
        + b"\xff\xed"
        + struct.pack(">H", len(segment) + 2)
        + segment
        + content[20:]
    )
    target, notes = edit(path)
    assert target.name == "a_edited.jpeg" and notes == ()
    with Image.open(path) as one, Image.open(target) as result:
        assert result.quantization == one.quantization
        assert JpegImagePlugin.get_sampling(result) == JpegImagePlugin.get_sampling(one)
        assert result.info["comment"] == b"a comment" and result.info["dpi"] == (300, 300)
        assert result.info["progressive"]
        assert IptcImagePlugin.getiptcinfo(result) == {(2, 120): b"caption"}
        assert 1036 not in result.info["photoshop"]
    assert b"private" in target.read_bytes()


D50 = (63190, 65536, 54061)
IDENTITY = (65536, 0, 0, 0, 65536, 0, 0, 0, 65536)


def make_cmyk() -> np.ndarray:
    """The face as CMYK with some black, by Pillow's formula."""
    rgb = FACE / 255
    black = 0.5 * (1 - rgb.max(-1, keepdims=True))
    inks = 1 - rgb / (1 - black)
    return np.rint(np.concatenate([inks, np.broadcast_to(black, inks[..., :1].shape)], -1) * 255)


@pytest.mark.parametrize("suffix", [".jpg", ".tif"])
def test_cmyk_stays_cmyk(tmp_path: Path, suffix: str) -> None:
    stored = make_cmyk().astype(np.uint8)
    options = {"quality": 98} if suffix == ".jpg" else {}
    image = Image.fromarray(stored, "CMYK")
    image.save(tmp_path / f"a{suffix}", **options)
    path, notes = edit(tmp_path / f"a{suffix}")
    with Image.open(path) as result:
        assert result.mode == "CMYK" and notes == ()
        check_colours(
            np.array(result.convert("RGB")).astype(float), 2 if suffix == ".tif" else CODEC
        )
        if suffix == ".tif":
            kept = (np.array(result) == stored).all(-1)
            assert kept[find_untouched(False)].mean() > 0.99


def join_profile(kind: bytes, space: bytes, tables: dict[bytes, bytes]) -> bytes:
    """A profile of tables."""
    tags = {
        b"desc": b"desc\0\0\0\0\0\0\0\x05ink\0\0" + bytes(79),
        b"cprt": b"text\0\0\0\0none\0\0\0\0",
        b"wtpt": b"XYZ \0\0\0\0" + struct.pack(">3i", *D50),
    } | tables
    at, table, body = 128 + 4 + 12 * len(tags), b"", b""
    for name, content in tags.items():
        table += struct.pack(">4sII", name, at + len(body), len(content))
        body += content + bytes(-len(content) % 4)
    words = (0x02400000, kind, space, b"Lab ", 2020, 1, 1, 0, 0, 0, b"acsp")
    head = struct.pack(">4xI4s4s4s6H4s", *words) + bytes(28) + struct.pack(">3i", *D50) + bytes(48)
    size = struct.pack(">I", 128 + 4 + len(table) + len(body))
    return size + head + struct.pack(">I", len(tags)) + table + body


def make_scanner_profile() -> bytes:
    """A scanner's profile of sRGB, which has no way back from colours to its values."""
    grid = np.stack(np.meshgrid(*[np.linspace(0, 1, 17)] * 3, indexing="ij"), -1)
    lab = rgb2lab(grid) * [652.8, 256, 256] + [0, 32768, 32768]
    return join_profile(b"scnr", b"RGB ", {b"A2B0": make_table(lab)})


def test_a_profile_without_a_way_back_becomes_srgb_in_words(tmp_path: Path) -> None:
    path = save(tmp_path / "a.tif", encode("sRGB", np.uint16), icc_profile=make_scanner_profile())
    picture = read_picture(path)
    assert picture.colour_space.profile == make_scanner_profile()
    edited = load().edit_picture(picture, 2.0, 1.5)
    assert "is converted from ink, which is only read, to sRGB" in edited.notes[-1]
    write_picture(tmp_path / "b.tif", edited)
    assert load_profile(tmp_path / "b.tif") is None
    right = load().edit(picture.srgb, 2.0, 1.5)
    difference = np.abs(tifffile.imread(tmp_path / "b.tif") / 257 - right)
    assert np.quantile(difference, 0.99) <= 2


def make_cmyk_profile() -> bytes:
    """A printer's profile, by tables, for Pillow's formula of CMYK."""
    grid = np.stack(np.meshgrid(*[np.linspace(0, 1, 9)] * 4, indexing="ij"), -1)
    lab = rgb2lab((1 - grid[..., :3]) * (1 - grid[..., 3:]))
    to_lab = lab * [652.8, 256, 256] + [0, 32768, 32768]
    axes = np.meshgrid(*[np.linspace(0, 65535, 17)] * 3, indexing="ij")
    wanted = (np.stack(axes, -1) - [0, 32768, 32768]) / [652.8, 256, 256]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        rgb = lab2rgb(wanted).clip(0, 1)
    black = 0.5 * (1 - rgb.max(-1, keepdims=True))
    from_lab = np.concatenate([1 - rgb / (1 - black), black], -1) * 65535
    tables = {b"A2B0": make_table(to_lab), b"B2A0": make_table(from_lab)}
    return join_profile(b"prtr", b"CMYK", tables)


def make_table(values: np.ndarray) -> bytes:
    """A table of 16 bits (mft2) without curves."""
    inputs, outputs = values.ndim - 1, values.shape[-1]
    ramp = struct.pack(">2H", 0, 65535)
    head = struct.pack(">4s4xBBBx9i2H", b"mft2", inputs, outputs, values.shape[0], *IDENTITY, 2, 2)
    clut = np.rint(values).clip(0, 65535).astype(">u2").tobytes()
    return head + ramp * inputs + clut + ramp * outputs


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16])
@pytest.mark.parametrize("suffix", [".jpg", ".tif"])
def test_cmyk_with_a_profile_stays_so(tmp_path: Path, suffix: str, dtype: type) -> None:
    stored = make_cmyk().astype(np.uint8).astype(dtype) * (257 if dtype == np.uint16 else 1)
    path, profile = tmp_path / f"a{suffix}", make_cmyk_profile()
    if suffix == ".tif":
        tifffile.imwrite(path, stored, photometric="separated", iccprofile=profile)
    elif dtype == np.uint16:
        pytest.skip("JPEG holds 8 bits")
    else:
        Image.fromarray(stored, "CMYK").save(path, quality=98, icc_profile=profile)
    before = read_picture(path)
    assert before.colour_space.profile == profile
    target, notes = edit(path)
    assert notes == () and load_profile(target) == profile
    result = load_pixels(target)
    assert result.shape == stored.shape and result.dtype == dtype
    right = load().edit(before.srgb, 2.0, 1.5)
    if suffix == ".tif":
        untouched = (right == before.srgb).all(-1)
        assert (result == stored).all(-1)[untouched].mean() > 0.99
    difference = np.abs(read_picture(target).srgb.astype(int) - right)
    assert np.quantile(difference, 0.95) <= (4 if suffix == ".tif" else CODEC)


@pytest.mark.parametrize("compression", ["zlib", "lzw", "packbits", "zstd", None])
@pytest.mark.parametrize("byteorder", ["<", ">"])
def test_tiff_keeps_compression_and_tags(
    tmp_path: Path, compression: str | None, byteorder: str
) -> None:
    tags = [
        (270, 2, 0, "a description", True),
        (315, 2, 0, "A. Person", True),
        (65000, 12, 2, (1.5, 2.5), True),
    ]
    options = {"compression": compression, "byteorder": byteorder, "resolution": (240, 240)}
    path = tmp_path / "a.tiff"
    stored = encode("Display P3", np.uint16)
    profile = PROFILES["Display P3"]
    tifffile.imwrite(
        path,
        stored,
        photometric="rgb",
        metadata=None,
        extratags=tags,
        iccprofile=profile,
        **options,
    )
    target, notes = edit(path)
    assert notes == () and target.suffix == ".tiff"
    with tifffile.TiffFile(path) as one, tifffile.TiffFile(target) as other:
        for tag in (259, 270, 282, 283, 296, 315, 34675, 65000):
            assert other.pages[0].tags[tag].value == one.pages[0].tags[tag].value
        assert other.byteorder == one.byteorder and len(other.pages) == 1
    check_colours(decode("Display P3", tifffile.imread(target)), 2)


LOSSES: dict[str, tuple[str, list[str]]] = {
    "JPEG": (".jpg", ["blended with white", "has 8 bits", "texts (Title)"]),
    "WebP": (".webp", ["has 8 bits", "texts (Title)"]),
    "AVIF": (".avif", ["has 8 bits", "texts (Title)"]),
    "TIFF": (".tif", ["texts (Title)"]),
    "JPEG 2000": (".jp2", ["texts (Title)"]),
    "BMP": (
        ".bmp",
        ["from RGB built-in to sRGB", "blended with white", "has 8 bits", "EXIF, XMP, texts"],
    ),
    "PPM": (".ppm", ["from RGB built-in to sRGB", "blended", "EXIF, XMP, the resolution"]),
}


@pytest.mark.parametrize("case", LOSSES)
def test_what_a_format_cannot_hold_is_said(tmp_path: Path, case: str) -> None:
    suffix, words = LOSSES[case]
    stored = np.dstack([encode("Display P3", np.uint16), make_alpha(np.uint16)])
    (tmp_path / "a.png").write_bytes(
        make_png(
            stored,
            (b"iCCP", b"p\0\0" + zlib.compress(PROFILES["Display P3"])),
            (b"pHYs", struct.pack(">IIB", 11811, 11811, 1)),
            (b"eXIf", make_exif(1).tobytes()[6:]),
            (b"iTXt", b"XML:com.adobe.xmp\0\0\0\0\0" + XMP),
            (b"tEXt", b"Title\0a title"),
        )
    )
    path, notes = edit(tmp_path / "a.png", suffix)
    said = " ".join(notes)
    for word in words:
        assert word in said
    assert len(notes) == len([word for word in words if "texts (" not in word or suffix != ""])
    assert read_mark(path) == MARK
    right = read_picture(tmp_path / "a.png")
    edited = load().edit_picture(right, 2.0, 1.5).srgb.astype(int)
    assert np.quantile(np.abs(read_picture(path).srgb - edited), 0.98) <= CODEC


def test_a_gif_becomes_png_in_words(tmp_path: Path) -> None:
    image = Image.fromarray(FACE).quantize(200)
    image.save(tmp_path / "a.gif", transparency=image.getpixel((0, 0)), comment="a comment")
    path, notes = edit(tmp_path / "a.gif")
    assert path.suffix == ".png" and name_format(path) == "PNG"
    assert notes[0].endswith("a.gif is written as PNG, since GIF holds 256 colours only.")
    with Image.open(path) as result:
        assert result.mode == "RGBA" and result.text["Comment"] == "a comment"


@pytest.mark.parametrize("alpha", [False, True])
def test_jpeg_2000_keeps_profile_alpha_and_exif(tmp_path: Path, alpha: bool) -> None:
    stored = encode("Display P3")
    stored = np.dstack([stored, make_alpha()]) if alpha else stored
    profile = PROFILES["Display P3"]
    first = save(tmp_path / "b.png", stored, icc_profile=profile, exif=make_exif())
    write_picture(tmp_path / "a.jp2", read_picture(first))
    path, notes = edit(tmp_path / "a.jp2")
    assert path.suffix == ".jp2" and notes == () and read_mark(path) == MARK
    assert path.read_bytes().count(profile) == 1 and b"NIKON" in path.read_bytes()
    with Image.open(path) as image:
        assert image.mode == ("RGBA" if alpha else "RGB")
        result = np.array(image)
    kept = (result == stored).all(-1)
    assert kept[find_untouched(alpha)].mean() > 0.99
    if alpha:
        np.testing.assert_array_equal(result[..., 3], make_alpha())
    else:
        check_colours(decode("Display P3", result), 2)


def test_jpeg_2000_holds_16_bits(tmp_path: Path) -> None:
    path, notes = edit(save(tmp_path / "a.tif", encode("sRGB", np.uint16)), ".jp2")
    result = imagecodecs.jpeg2k_decode(path.read_bytes())
    assert notes == () and result.dtype == np.uint16 and len(np.unique(result)) > 2000
    check_colours(result / 257, 2)


def test_white_of_a_deep_jpeg_2000_is_not_black(tmp_path: Path) -> None:
    stored = np.full((8, 8, 3), 65535, np.uint16)
    stored[0] = 1000
    path = tmp_path / "a.jp2"
    for bits in (10, 16):
        values = stored >> (16 - bits)
        content = imagecodecs.jpeg2k_encode(values, level=0, codecformat="jp2", bitspersample=bits)
        path.write_bytes(content)
        pixels = read_picture(path).pixels
        assert pixels.dtype == np.uint16
        assert np.abs(pixels.astype(int) - stored).max() <= 65536 >> bits


def test_exif_that_is_too_large_for_jpeg_is_said_and_the_mark_stays(tmp_path: Path) -> None:
    exif = make_exif(None, **{"9286": b"x" * 80000}).tobytes()[6:]
    (tmp_path / "a.png").write_bytes(make_png(FACE, (b"eXIf", exif)))
    path, notes = edit(tmp_path / "a.png", ".jpg")
    assert "EXIF of more than 64 KB" in notes[0] and read_mark(path) == MARK


def test_data_behind_a_jpeg_are_said(tmp_path: Path) -> None:
    path = save(tmp_path / "a.jpg", FACE)
    path.write_bytes(path.read_bytes() + b"ftypmp42" * 100)
    assert "data behind the picture" in edit(path)[1][0]


@pytest.mark.parametrize("top", [1023, 65535])
def test_deep_ppm_keeps_its_depth(tmp_path: Path, top: int) -> None:
    stored = np.rint(FACE / 255 * top).astype(">u2")
    (tmp_path / "a.ppm").write_bytes(b"P6 160 160 %d " % top + stored.tobytes())
    path, notes = edit(tmp_path / "a.ppm")
    assert notes == () and path.read_bytes().startswith(b"P6\n160 160\n65535\n")
    result = np.frombuffer(path.read_bytes(), ">u2", FACE.size, 17).reshape(FACE.shape)
    check_colours(result / 257, 2)


def test_a_transparent_colour_of_16_bits_stays_transparent(tmp_path: Path) -> None:
    stored = encode("sRGB", np.uint16)
    chunk = (b"tRNS", struct.pack(">3H", *stored[0, 0].tolist()))
    (tmp_path / "a.png").write_bytes(make_png(stored, chunk))
    path, _ = edit(tmp_path / "a.png")
    result = load_pixels(path)
    clear = (stored == stored[0, 0]).all(-1)
    assert result.dtype == np.uint16 and ((result[..., 3] == 0) == clear).all()
    np.testing.assert_array_equal(result[clear][:, :3], stored[clear])


@pytest.mark.parametrize("bits", [10, 12])
def test_a_depth_that_is_read_as_8_bits_is_said(tmp_path: Path, bits: int) -> None:
    stored = encode("sRGB", np.uint16) >> (16 - bits)
    content = imagecodecs.avif_encode(stored, bitspersample=bits, level=95, speed=10)
    (tmp_path / "a.avif").write_bytes(content)
    _, notes = edit(tmp_path / "a.avif")
    assert f"{bits} bits a channel, of which 8 are read" in notes[0]


@pytest.mark.parametrize("orientation", [1, 6])
def test_heic(tmp_path: Path, orientation: int) -> None:
    heif = pytest.importorskip("pillow_heif")
    stored = turn_back(FACE, orientation)
    image = Image.fromarray(stored)
    image.info["icc_profile"] = PROFILES["sRGB"]
    exif = make_exif(orientation)
    heif.from_pillow(image).save(
        tmp_path / "a.heic", quality=95, chroma=444, exif=exif.tobytes(), xmp=XMP
    )
    path, notes = edit(tmp_path / "a.heic")
    assert path.suffix == ".heic" and notes == ()
    result = heif.open_heif(path)
    assert result.info["icc_profile"] == PROFILES["sRGB"] and result.info["xmp"] == XMP
    pixels = np.asarray(result.to_pillow())
    assert pixels.shape == FACE.shape
    check_colours(pixels, CODEC)
    kept = Image.Exif()
    kept.load(result.info["exif"])
    assert kept[0x010F] == "NIKON CORPORATION" and kept.get(0x0112, 1) == 1
    assert kept.get_ifd(0x8769)[0x927C].startswith(b"Nikon")


def test_a_jpeg_of_rgb_components_stays_so(tmp_path: Path) -> None:
    Image.fromarray(FACE).save(tmp_path / "a.jpg", quality=97, subsampling=0, keep_rgb=True)
    path, _ = edit(tmp_path / "a.jpg")
    with Image.open(path) as image:
        assert image.info["adobe_transform"] == 0 and image.mode == "RGB"
    check_colours(load_pixels(path), CODEC)


def test_what_cannot_be_encoded_is_a_sentence(tmp_path: Path) -> None:
    wide = Picture("a", np.zeros((1, 17000, 3), np.uint8))
    with pytest.raises(InputError, match=r"b\.webp cannot be written .*; choose another file with"):
        write_picture(tmp_path / "b.webp", wide, MARK)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("suffix", [".bmp", ".ppm"])
def test_plain_formats_keep_their_format_and_pixels(tmp_path: Path, suffix: str) -> None:
    path, notes = edit(save(tmp_path / f"a{suffix}", FACE))
    assert path.suffix == suffix and notes == () and read_mark(path) == MARK
    np.testing.assert_array_equal(load_pixels(path), edit_srgb())


def test_a_jpeg_with_a_wrong_suffix_keeps_its_format(tmp_path: Path) -> None:
    path = save(tmp_path / "a.jpg", FACE).rename(tmp_path / "a.png")
    target, _ = edit(path)
    assert target.name == "a_edited.jpg" and name_format(target) == "JPEG"


def test_further_pictures_are_said(tmp_path: Path) -> None:
    gain = Image.new("RGB", (8, 8))
    image = Image.fromarray(FACE)
    image.save(tmp_path / "a.jpg", "MPO", save_all=True, append_images=[gain], quality=97)
    path, notes = edit(tmp_path / "a.jpg")
    assert "1 further picture" in notes[0]
    content = path.read_bytes()
    assert b"MPF\0" not in content and content.count(b"\xff\xd8\xff") == 1
    assert name_format(path) == "JPEG"


def test_a_gain_map_is_said_and_no_longer_stated(tmp_path: Path) -> None:
    xmp = XMP.replace(b'xmp:Rating="4"', b'xmp:Rating="4" hdrgm:Version="1.0"').replace(
        b"/></rdf:RDF>",
        b'><Container:Directory><rdf:Seq><rdf:li Item:Semantic="GainMap" Item:Length="9"/>'
        b"</rdf:Seq></Container:Directory></rdf:Description></rdf:RDF>",
    )
    path = save(tmp_path / "a.jpg", FACE, xmp=xmp)
    path.write_bytes(path.read_bytes() + small_jpeg())
    target, notes = edit(path)
    assert "gain map" in notes[0]
    with Image.open(target) as image:
        result = image.info["xmp"]
    assert b"hdrgm" not in result and b"GainMap" not in result and b'xmp:Rating="4"' in result


def small_jpeg() -> bytes:
    buffer = io.BytesIO()
    Image.new("L", (8, 8)).save(buffer, "JPEG")
    return buffer.getvalue()


def test_damaged_exif_is_left_out_and_said(tmp_path: Path) -> None:
    path = save(tmp_path / "a.jpg", FACE, exif=b"Exif\0\0II*\0\xff\xff\xff\x7f")
    target, notes = edit(path)
    assert "damaged EXIF" in notes[0] and read_mark(target) == MARK


def test_a_failure_leaves_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    picture = Picture("a", FACE)

    def fail(*_: object, **__: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Image.Image, "save", fail)
    with pytest.raises(InputError, match="No space left on device"):
        write_picture(tmp_path / "a.webp", picture, MARK)
    assert list(tmp_path.iterdir()) == []


def test_an_edit_of_an_edit_carries_one_mark(tmp_path: Path) -> None:
    for suffix in (".png", ".jpg", ".tif"):
        first, _ = edit(save(tmp_path / f"a{suffix}", FACE))
        second, notes = edit(first)
        assert notes == () and second.read_bytes().count(str(MARK).encode()) <= 2
        assert read_mark(second) == MARK


@pytest.mark.parametrize("suffix", [".png", ".tif", ".webp", ".jpg", ".bmp"])
def test_the_mark_is_that_of_the_last_edit(tmp_path: Path, suffix: str) -> None:
    first, _ = edit(save(tmp_path / "a.jpg", FACE))
    later = Mark("edit", EDITED, "f" * 64)
    write_picture(tmp_path / f"b{suffix}", read_picture(first), later)
    assert read_mark(tmp_path / f"b{suffix}") == later


def test_a_damaged_text_takes_no_other_chunk_with_it(tmp_path: Path) -> None:
    chunks = [(b"zTXt", b"Title\0\0no zlib"), (b"tEXt", b"Author\0A. Person")]
    (tmp_path / "a.png").write_bytes(make_png(FACE, *chunks))
    path, notes = edit(tmp_path / "a.png")
    assert notes == () and all(body in path.read_bytes() for _, body in chunks)
    _, notes = edit(tmp_path / "a.png", ".tif")
    assert "texts (Title, Author)" in notes[0]
    broken = (b"tEXt", b"Raw profile type exif\0\nexif\n 4\nzz\n")
    (tmp_path / "a.png").write_bytes(make_png(FACE, broken))
    assert "damaged text (Raw profile type exif)" in edit(tmp_path / "a.png")[1][0]


@pytest.mark.parametrize("kind", ["xmp", "APP1"])
def test_xmp_that_imagemagick_wrote_is_kept(tmp_path: Path, kind: str) -> None:
    packet = (b"http://ns.adobe.com/xap/1.0/\0" if kind == "APP1" else b"") + XMP
    text = f"\n{kind}\n{len(packet):8}\n{packet.hex()}\n".encode()
    chunk = (b"zTXt", f"Raw profile type {kind}".encode() + b"\0\0" + zlib.compress(text))
    (tmp_path / "a.png").write_bytes(make_png(FACE, chunk))
    path, notes = edit(tmp_path / "a.png")
    with Image.open(path) as image:
        assert image.info["xmp"] == XMP and notes == ()
