"""Every photograph of a folder is read, and everything else is named or counted."""

import json
import os
import shutil
import socket
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import tifffile
from flat_decomposer import SKIN, WALL, names, paint, read_melanin, run, save
from other_files import KINDS, NO_PICTURES, RAW, write_pages

from skinnet.images import read_picture

__all__ = ["run"]
Run = Callable[..., tuple[int, str, str]]

DARK = (100, 70, 60)
JPEG_NAMES = (
    *("a.jpg", "a.JPG", "a.jpeg", "a.jpe", "a.jfif", "a.jif", "a.jfi", "a.pjpeg", "a.pjp", "a.JPE"),
    *("a.JPG_large", "a.jpg~", "a.jpg!d", "a.jpg-orig", "a", "a b.c", "a.png", "a.tif", "a.txt"),
    *("a.dat", "a.heic", "a.gif", "a.pdf", "a.nef", "a.json", "a.mp4", "a.bak", "a.tmp", "a."),
)
FORMATS = ("JPEG", "PNG", "TIFF", "WEBP", "AVIF", "JPEG2000", "BMP", "GIF", "PPM", "MPO")
BY_ENDING = ("plain.nef", "unknown.arw")
"""RAW files that nothing but their ending makes known."""


@pytest.fixture
def no_extras(monkeypatch: pytest.MonkeyPatch) -> None:
    """The readers of HEIC and of RAW files are not installed."""
    for package in ("pillow_heif", "rawpy"):
        monkeypatch.setitem(__import__("sys").modules, package, None)
    monkeypatch.setattr("skinnet.images._kind.find_spec", lambda name: None)


@pytest.mark.parametrize("name", JPEG_NAMES)
def test_the_content_decides_and_not_the_ending(run: Run, tmp_path: Path, name: str) -> None:
    save(tmp_path / "g" / name, format_="JPEG")
    code, _, err = run("predict", tmp_path / "g", "-o", tmp_path / "out")
    assert code == 0 and "1 photograph, 1 face read, 0 not read" in err
    (melanin,) = read_melanin(tmp_path / "out").values()
    assert melanin == pytest.approx(0.2, abs=0.005)


@pytest.mark.parametrize("format_", FORMATS)
@pytest.mark.parametrize("name", ["picture", "a.jpg"])
def test_every_format_is_known_by_its_content(
    run: Run, tmp_path: Path, format_: str, name: str
) -> None:
    save(tmp_path / "g" / name, format_=format_)
    code, _, err = run("predict", tmp_path / "g", "-o", tmp_path / "out")
    assert code == 0 and "1 photograph, 1 face read, 0 not read" in err
    (melanin,) = read_melanin(tmp_path / "out").values()
    assert melanin == pytest.approx(0.2, abs=0.01)


@pytest.mark.parametrize("name", ["a.heic", "a.HEIC", "a.heif", "a.hif", "a.jpg", "a"])
def test_heic_is_read_with_its_extra(run: Run, tmp_path: Path, name: str) -> None:
    pillow_heif = pytest.importorskip("pillow_heif")
    (tmp_path / "g").mkdir()
    picture = pillow_heif.from_pillow(paint().resize((64, 32), 0))
    picture.save(tmp_path / "g" / "x.heic", quality=-1, chroma=444)
    (tmp_path / "g" / "x.heic").rename(tmp_path / "g" / name)
    code, _, err = run("predict", tmp_path / "g", "-o", tmp_path / "out")
    assert code == 0 and "1 photograph, 1 face read, 0 not read" in err
    (melanin,) = read_melanin(tmp_path / "out").values()
    assert melanin == pytest.approx(0.2, abs=0.005)


@pytest.mark.parametrize("name", ["a.heic", "a.jpg", "a"])
@pytest.mark.usefixtures("no_extras")
def test_heic_without_its_extra_names_it(run: Run, tmp_path: Path, name: str) -> None:
    heic = KINDS["HEIC picture"]["a.heic"]
    save(tmp_path / "g" / "b.png")
    (tmp_path / "g" / name).write_bytes(heic)
    for inputs in (tmp_path / "g" / name, tmp_path / "g"):
        code, _, err = run("predict", inputs, "-o", tmp_path / "out")
        assert 'pip install "skinnet[heif]"' in err and name in err
    assert code == (2 if name == "a.jpg" else 0)
    assert read_melanin(tmp_path / "out") == {"b.json": 0.2}


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.usefixtures("no_extras")
def test_other_kinds_are_passed_over_by_name(run: Run, tmp_path: Path, kind: str) -> None:
    save(tmp_path / "g" / "photo.png")
    for name, content in KINDS[kind].items():
        (tmp_path / "g" / name).write_bytes(content)
    code, _, err = run("predict", tmp_path / "g", "-o", tmp_path / "out")
    count = len(KINDS[kind])
    assert code == 0
    assert f"1 photograph, 1 face read, 0 not read, {count} passed over" in err
    assert f"Passed over: {count} {kind}{'s' * (count > 1)} (" in err
    assert read_melanin(tmp_path / "out") == {"photo.json": 0.2}


@pytest.mark.parametrize(
    ("kind", "name"), [(kind, name) for kind, files in KINDS.items() for name in files]
)
@pytest.mark.usefixtures("no_extras")
def test_other_kinds_are_refused_where_they_are_named(
    run: Run, tmp_path: Path, kind: str, name: str
) -> None:
    (tmp_path / name).write_bytes(KINDS[kind][name])
    for verb in ("predict", "edit"):
        code, out, err = run(verb, tmp_path / name)
        (line,) = err.splitlines()
        assert code == 2 and out == "" and name in line
        assert kind in line or kind in ("other file", "empty file")
    assert names(tmp_path) == [name]


@pytest.mark.parametrize(
    ("name", "ending"),
    [(name, "") for name in RAW]
    + [(name, end) for name in RAW for end in (".tif", ".jpg", ".txt") if name not in BY_ENDING],
)
def test_a_raw_file_is_never_read_by_its_preview(
    run: Run, tmp_path: Path, name: str, ending: str
) -> None:
    (tmp_path / f"{name}{ending}").write_bytes(RAW[name])
    code, _, err = run("predict", tmp_path)
    assert code == 2 and "RAW file" in err
    assert not (tmp_path / "skinmaps").exists()


@pytest.mark.parametrize("name", NO_PICTURES)
def test_what_only_looks_like_a_picture_could_not_be_read(
    run: Run, tmp_path: Path, name: str
) -> None:
    save(tmp_path / "g" / "photo.png")
    (tmp_path / "g" / name).write_bytes(NO_PICTURES[name])
    code, _, err = run("predict", tmp_path / "g", "-o", tmp_path / "out")
    sentence, count = err.splitlines()
    assert code == 2 and sentence.startswith(f"skinnet: {tmp_path / 'g' / name} ")
    assert count.startswith("skinnet: 1 photograph, 1 face read, 1 not read, ")
    assert read_melanin(tmp_path / "out") == {"photo.json": 0.2}


@pytest.mark.parametrize(
    "name",
    ["._a.jpg", ".a.jpg", ".hidden/a.png", "Thumbs.db", ".DS_Store", "desktop.ini", "Icon\r"]
    + ["__MACOSX/._a.jpg", "@eaDir/a.jpg/SYNOPHOTO_THUMB_XL.jpg", "$RECYCLE.BIN/a.jpg"],
)
@pytest.mark.parametrize("options", [[], ["--recursive"]])
def test_what_file_managers_leave_is_no_noise(
    run: Run, tmp_path: Path, name: str, options: list[str]
) -> None:
    save(tmp_path / "g" / "a.png")
    save(tmp_path / "g" / name, DARK, "JPEG")
    code, _, err = run("predict", tmp_path / "g", "-o", tmp_path / "out", *options)
    assert code == 0
    assert err.startswith("skinnet: 1 photograph, 1 face read, 0 not read, ")
    assert "passed over" not in err and err.count("\n") == 1
    assert read_melanin(tmp_path / "out") == {"a.json": 0.2}


def test_a_hidden_folder_that_is_named_is_read(run: Run, tmp_path: Path) -> None:
    save(tmp_path / ".g" / "a.png")
    assert run("predict", tmp_path / ".g", "-o", tmp_path / "out")[0] == 0
    assert read_melanin(tmp_path / "out") == {"a.json": 0.2}


def test_subfolders_are_counted_or_read(run: Run, tmp_path: Path) -> None:
    for place in ("a.png", "1/b.png", "1/c.jfif", "2/deep/er/d.png", "3/notes.txt/e"):
        save(tmp_path / "g" / place, format_="PNG")
    (tmp_path / "g" / "4").mkdir()
    (tmp_path / "g" / "4" / "x.json").write_text("{}")
    code, _, err = run("predict", tmp_path / "g", "-o", tmp_path / "out")
    assert code == 0 and "further pictures, 4 in 3 subfolders; --recursive reads them too" in err
    assert list(read_melanin(tmp_path / "out")) == ["a.json"]
    code, _, err = run("predict", tmp_path / "g", "-r", "-o", tmp_path / "out")
    assert code == 0 and "5 photographs, 5 faces read, 0 not read, 1 passed over" in err
    assert list(read_melanin(tmp_path / "out")) == [f"{each}.json" for each in "abcde"]


def test_a_folder_of_folders_says_where_its_pictures_are(run: Run, tmp_path: Path) -> None:
    save(tmp_path / "g" / "1" / "a.png")
    code, _, err = run("predict", tmp_path / "g")
    assert code == 2
    assert "holds no photographs itself, but 1 in 1 subfolder; --recursive reads them" in err


@pytest.mark.parametrize("target", ["..", ".", "../g", "../../g"])
def test_loops_of_links_end(run: Run, tmp_path: Path, target: str) -> None:
    save(tmp_path / "g" / "1" / "a.png")
    (tmp_path / "g" / "1" / "loop").symlink_to(target)
    code, _, err = run("predict", tmp_path / "g", "-r", "-o", tmp_path / "out")
    assert code == 0 and "1 face read, " in err
    assert list(read_melanin(tmp_path / "out")) == ["a.json"]


def test_a_linked_folder_is_read(run: Run, tmp_path: Path) -> None:
    save(tmp_path / "far" / "a.png")
    (tmp_path / "g").mkdir()
    (tmp_path / "g" / "link").symlink_to(tmp_path / "far")
    assert run("predict", tmp_path / "g", "-r", "-o", tmp_path / "out")[0] == 0
    assert read_melanin(tmp_path / "out") == {"a.json": 0.2}


@pytest.mark.parametrize("kind", ["link", "loop", "pipe", "socket"])
@pytest.mark.parametrize("name", ["z.jpg", "z"])
def test_what_is_no_file_does_not_stop_the_others(
    run: Run, tmp_path: Path, kind: str, name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    save(tmp_path / "g" / "a.png")
    monkeypatch.chdir(tmp_path / "g")  # names of sockets are short
    if kind in ("link", "loop"):
        Path(name).symlink_to("absent.jpg" if kind == "link" else name)
    elif kind == "pipe":
        os.mkfifo(name)
    else:
        with socket.socket(socket.AF_UNIX) as server:
            server.bind(name)
    code, _, err = run("predict", ".", "-o", tmp_path / "out")
    broken = kind in ("link", "loop") and name == "z.jpg"
    assert code == (2 if broken else 0) and "z" in err
    assert ("1 not read" if broken else "0 not read, 1 passed over") in err
    assert read_melanin(tmp_path / "out") == {"a.json": 0.2}
    code, _, err = run("predict", name)
    assert code == 2 and len(err.splitlines()) == 1 and name in err


def test_folders_that_cannot_be_listed_are_named(
    run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    save(tmp_path / "g" / "a.png")
    save(tmp_path / "g" / "locked" / "b.png")
    listdir = os.listdir

    def refuse(path: str | Path) -> list[str]:
        if Path(path).name == "locked":
            raise PermissionError(13, "Permission denied")
        return listdir(path)

    monkeypatch.setattr(os, "listdir", refuse)
    code, _, err = run("predict", tmp_path / "g", "-r", "-o", tmp_path / "out")
    assert code == 2 and "locked cannot be read (Permission denied)" in err
    assert "1 photograph, 1 face read, 1 not read" in err


@pytest.mark.parametrize("name", [b"\xff.jpg", b"\xe9t\xe9", b"a\xffb.png"])
def test_names_that_are_not_unicode_are_read(run: Run, tmp_path: Path, name: bytes) -> None:
    (tmp_path / "g").mkdir()
    save(tmp_path / "a.png")
    os.rename(os.fsencode(tmp_path / "a.png"), os.path.join(os.fsencode(tmp_path / "g"), name))
    for options in ([], ["--json"]):
        code, _, err = run("predict", tmp_path / "g", "-o", tmp_path / "out", *options)
        assert code == 0 and "1 photograph, 1 face read, 0 not read" in err
    assert list(read_melanin(tmp_path / "out").values()) == [0.2]


@pytest.mark.parametrize("link", [False, True])
def test_a_file_is_read_once(
    run: Run, tmp_path: Path, link: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    save(tmp_path / "g" / "a.png")
    others = ["g/a.png", "./g/a.png", "g/../g/a.png", tmp_path / "g" / "a.png"]
    if link:
        (tmp_path / "link.jpg").symlink_to("g/a.png")
        os.link("g/a.png", "hard.jpg")
        others = ["link.jpg", "hard.jpg"]
    for inputs in (["g/a.png", *others], ["g", *others]):
        code, out, err = run("predict", *inputs, "-o", "out")
        assert code == 0 and len(out.splitlines()) == 1
        assert (
            f"1 photograph, 1 face read, 0 not read, {len(others)} passed over" in err
            and "second names of files" in err
        )
    assert list(read_melanin(tmp_path / "out")) == ["a.json"]


def test_a_folder_is_read_once(run: Run, tmp_path: Path) -> None:
    save(tmp_path / "g" / "a.png")
    (tmp_path / "link").symlink_to("g")
    code, _, err = run("predict", tmp_path / "g", tmp_path / "link", tmp_path / "g")
    assert code == 0 and "1 photograph, 1 face read, 0 not read, 2 passed over" in err


PATTERNS = {
    "*.jpg": "ab",
    "*": "abcde",
    "?.jpg": "ab",
    "[ac].*": "ac",
    "[!a]*": "bcde",
    "**": "abcde",
    "**/*.jpg": "abd",
    "d*/*": "de",
    "d*": "de",
    "../g/*.jpg": "ab",
}


@pytest.mark.parametrize("pattern", PATTERNS)
def test_a_pattern_that_no_shell_has_expanded(
    run: Run, tmp_path: Path, pattern: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("a.jpg", "b.jpg", "c.png", "d/d.jpg", "d/e.png", ".hidden.jpg"):
        save(tmp_path / "g" / name)
    (tmp_path / "g" / "notes.txt").write_text("")
    monkeypatch.chdir(tmp_path / "g")
    code, _, err = run("predict", pattern, "-o", tmp_path / "out")
    found = PATTERNS[pattern]
    assert code == 0 and f"{len(found)} faces read, 0 not read" in err
    assert list(read_melanin(tmp_path / "out")) == [f"{each}.json" for each in found]


@pytest.mark.parametrize("name", ["photo[1].jpg", "a*.jpg", "what?.jpg", "[x].png", "a[!b].png"])
def test_a_file_of_that_literal_name_comes_first(run: Run, tmp_path: Path, name: str) -> None:
    save(tmp_path / "photo1.jpg", DARK)
    save(tmp_path / "ab.jpg", DARK)
    save(tmp_path / name)
    code, out, err = run("predict", tmp_path / name, "-o", tmp_path / "out")
    assert code == 0 and err == "" and len(out.splitlines()) == 1
    assert list(read_melanin(tmp_path / "out").values()) == [pytest.approx(0.2, abs=0.005)]


def test_a_folder_with_brackets_holds_a_pattern(run: Run, tmp_path: Path) -> None:
    save(tmp_path / "photos [1]" / "a.png")
    save(tmp_path / "photos 1" / "b.png", DARK)
    assert run("predict", tmp_path / "photos [1]" / "*.png", "-o", tmp_path / "out")[0] == 0
    assert read_melanin(tmp_path / "out") == {"a.json": 0.2}


@pytest.mark.parametrize("pattern", ["*.jpg", "absent/*", "[b].png", "?", "**/*.gif"])
@pytest.mark.parametrize("verb", ["predict", "edit"])
def test_a_pattern_that_matches_nothing_is_a_sentence(
    run: Run, tmp_path: Path, verb: str, pattern: str
) -> None:
    save(tmp_path / "a.png")
    code, _, err = run(verb, tmp_path / pattern)
    assert code == 2
    assert f"No file matches the pattern {tmp_path / pattern}; check the folder" in err


def test_edit_takes_a_pattern_of_one_match(run: Run, tmp_path: Path) -> None:
    save(tmp_path / "a.png")
    assert run("edit", tmp_path / "*.png", "-o", tmp_path / "out.png")[0] == 0
    code, _, err = run("edit", tmp_path / "*.txt")
    assert code == 2
    save(tmp_path / "b.png")
    code, _, err = run("edit", tmp_path / "*.png", "-o", tmp_path / "out.png")
    assert code == 2 and "out.png would be one picture, and 2 photographs are edited" in err


@pytest.mark.parametrize("suffix", ["gif", "png", "webp", "tif"])
def test_frames_that_are_left_out_are_said(run: Run, tmp_path: Path, suffix: str) -> None:
    first, rest = paint(), [paint(DARK), paint((90, 80, 70))]
    path = tmp_path / f"a.{suffix}"
    if suffix == "tif":
        write_pages(str(path), np.array(first), 3)
    else:
        options = {"lossless": True} if suffix == "webp" else {}
        first.save(path, save_all=True, append_images=rest, duration=100, **options)
    code, out, err = run("predict", path, "--json", "-o", tmp_path / "out")
    assert code == 0 and "holds 3 pictures; the first is read" in err
    summary = json.loads(out)
    assert any("3 pictures" in note for note in summary["notes"])
    assert summary["maps"]["melanin"]["mean"] == pytest.approx(0.2, abs=0.005)


def test_a_file_that_is_only_in_icloud_is_passed_over_by_name(run: Run, tmp_path: Path) -> None:
    save(tmp_path / "g" / "a.png")
    (tmp_path / "g" / ".IMG_1.HEIC.icloud").write_bytes(b"bplist00")
    code, _, err = run("predict", tmp_path / "g", "-o", tmp_path / "out")
    assert code == 0 and "1 file that is only in iCloud (.IMG_1.HEIC.icloud)" in err


@pytest.mark.parametrize(
    ("kinds", "text", "count"),
    [
        (("Baseline", "Disparity"), b"", 2),
        (("Baseline", "Undefined", "Undefined"), b"", 3),
        (("Baseline", "Large Thumbnail (VGA Equivalent)"), b"", 1),
        (("Baseline", "Large Thumbnail (Full HD Equivalent)", "Panorama"), b"", 2),
        (("Baseline", "Undefined"), b"http://ns.adobe.com/hdr-gain-map/1.0/", 1),
        (("Baseline", "Undefined"), b"http://ns.apple.com/HDRGainMap/1.0/", 1),
    ],
)
def test_previews_and_gain_maps_of_jpegs_are_no_pictures(
    tmp_path: Path, kinds: tuple[str, ...], text: bytes, count: int
) -> None:
    """Cameras and telephones put them into every photograph."""
    codes = {
        **{"Baseline": 0x030000, "Undefined": 0, "Disparity": 0x020002, "Panorama": 0x020001},
        "Large Thumbnail (VGA Equivalent)": 0x010001,
        "Large Thumbnail (Full HD Equivalent)": 0x010002,
    }
    path = save(
        tmp_path / "a.jpg",
        format_="MPO",
        save_all=True,
        append_images=[paint(DARK)] * (len(kinds) - 1),
    )
    data = bytearray(path.read_bytes())
    head = data.index(b"MPF\0II*\0") + 4
    tag = data.index(b"\x02\xb0", head)  # of the entries, 16 bytes each
    start = head + int.from_bytes(data[tag + 8 : tag + 12], "little")
    for number, kind in enumerate(kinds):
        place = start + 16 * number
        data[place : place + 4] = codes[kind].to_bytes(4, "little")
    path.write_bytes(data + text)
    notes = read_picture(path).notes
    assert notes == ((f"{path} holds {count} pictures; the first is read.",) if count > 1 else ())


def test_pages_of_reduced_size_are_no_pictures(tmp_path: Path) -> None:
    path, first = tmp_path / "a.tif", np.array(paint())
    with tifffile.TiffWriter(path) as file:
        for number in range(3):
            file.write(first[:: number + 1], photometric="rgb", subfiletype=int(number > 0))
    assert read_picture(path).notes == ()
    np.testing.assert_array_equal(read_picture(path).srgb, first)


@pytest.mark.usefixtures("no_extras")
def test_the_end_of_a_run_counts(run: Run, tmp_path: Path) -> None:
    folder = tmp_path / "g"
    for name, colour in (("a.png", SKIN), ("b", DARK), ("wall.png", WALL)):
        save(folder / name, colour, "PNG")
    shutil.copy(folder / "a.png", folder / "copy.jpe")
    for name, content in (("c.nef", RAW["a.nef"]), ("d.jpg", b""), ("e.txt", b"text")):
        (folder / name).write_bytes(content)
    code, out, err = run("predict", folder, tmp_path / "absent.jpg", "--json")
    assert code == 2
    assert [json.loads(line)["file"] for line in out.splitlines()] == [
        str(folder / name) for name in ("a.png", "b", "copy.jpe")
    ]
    assert err.splitlines()[-1].startswith(
        "skinnet: 3 photographs, 3 faces read, 3 not read (2 could not be read, 1 without a face), "
        "2 passed over, "
    )
    assert err.endswith("Passed over: 1 RAW file (c.nef); 1 other file (e.txt).\n")


def test_one_plain_file_needs_no_count(run: Run, tmp_path: Path) -> None:
    code, _, err = run("predict", save(tmp_path / "a.png"))
    assert code == 0 and err == ""
