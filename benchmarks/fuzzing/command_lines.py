"""Command lines from the parsers of all verbs, with good, damaged and absent files."""

import argparse
import io
import json
import sys
from functools import cache
from pathlib import Path
from random import Random

from PIL import Image
from skimage.data import astronaut

from benchmarks.fuzzing import archives, meshes
from benchmarks.fuzzing.case import Case
from skinnet.cli import _VERBS, _make_parser, main

_WORDS = (
    *("", " ", "-", "--", "---", "-x", "=", ".", "..", "/", "/dev/null", "absent", "*", "[", "{}"),
    *("-1", "0", "1", "2", "1.5", "nan", "inf", "-inf", "1e400", "1,5", "10", "9" * 20, "null"),
    *("true", "é", "\x1b[31m", "a\nb", "\udcff", "x" * 300, "a" * 5000, "~", "$HOME", "%s", "{0}"),
    *("http://a.org/a.jpg", "data:,x", "largest", "all", "face", "skin", "D65", "daylight", "exif"),
    *("12,14", "12,14,20,22", "-1,-1", "9e9,1", "#e6e1d2", "classic", "cpu", "cuda,cpu", "jpg"),
    *("[]", "[1,2", "{a: 1", "'", '"', "@a", "--help", "-h", "-q", "-v", "--version", "help"),
)

_GOOD = {
    "input": ("face.jpg", "plain.png", "bad.jpg", "folder", "-", "*.jpg", "empty.jpg", "notes.txt"),
    "before": ("face.jpg", "plain.png", "-", "bad.jpg"),
    "after": ("face.jpg", "plain.png", "empty.jpg"),
    "scan": ("bad.obj", "empty.jpg", "notes.txt", "bad.ply"),
    "maps": ("maps.npz", "bad.npz", "folder", "face.jpg"),
    "model": ("hybrid.npz", "maps.npz", "bad.npz", "notes.txt", "absent.onnx"),
    "melanin": ("1.5", "0", "1", "10", "11", "-1"),
    "hemoglobin": ("1.5", "0", "1", "nan"),
    "quality": ("90", "0", "101"),
    "format": ("png", "jpg", "tif", "webp", "bmp", "ppm", "gif"),
    "mask": ("plain.png", "bad.jpg", "absent.png", "face.jpg"),
    "config": ("settings.yaml", "notes.txt", "bad.npz", "absent.yaml"),
    "capture": ("settings.yaml", "absent.yaml", "face.jpg"),
    "output": ("out", "out/", "face.jpg", "folder", "new/deep", "out.yaml", "out.png", "-"),
    "csv": ("table.csv", "face.jpg", "folder", "absent/table.csv"),
    "report": ("page.html", "page.txt", "folder"),
    "count": ("1", "2", "0", "-1", "1.5"),
    "chart": ("classic", "notes.txt", "absent.csv"),
    "shape": ("bad.npz", "folder", "absent.npz", "notes.txt"),
    "port": ("-1", "70000", "x", "99999999999999"),
    "shell": ("bash", "zsh", "fish", "csh"),
}
"""Words that a flag or an input may rightly have, or nearly, by its name."""


def make(rng: Random) -> Case:
    """Make a command line, which is run in a folder of small files."""
    words = _make_words(rng)
    files = dict(_make_files())
    return Case(lambda folder: _run(folder, words), files, f"skinnet {words!r}"[:1500])


def _run(folder: Path, words: list[str]) -> None:
    output, errors = io.StringIO(), io.StringIO()
    streams = sys.stdin, sys.stdout, sys.stderr
    sys.stdin = io.TextIOWrapper(io.BytesIO(_make_files()["face.jpg"]), "utf-8")
    sys.stdout = output  # type: ignore[assignment]
    sys.stderr = errors  # type: ignore[assignment]
    try:
        code = main(words)
    finally:
        sys.stdin, sys.stdout, sys.stderr = streams
    _check(code, output.getvalue(), errors.getvalue(), words)
    left = [each for each in folder.rglob(".*") if each.name.startswith(".skinnet-")]
    assert not left, f"partial files are left: {left}"


def _check(code: int, output: str, errors: str, words: list[str]) -> None:
    said = f"{output[-700:]}\n{errors[-1500:]}"
    assert code in (0, 1, 2), f"exit code {code}: {said}"
    assert "Traceback" not in said, said
    if code == 2:
        sentences = [line for line in errors.splitlines() if line.startswith("skinnet:")]
        assert sentences, f"no sentence: {said}"
        assert max(map(len, sentences)) < 2000, f"a long message: {said}"
    assert not any(ord(each) < 32 and each not in "\n\t\r" for each in errors + output), said
    if (
        code == 0
        and "--json" in words
        and words[0] not in ("help", "web", "completion")
        and not {"-h", "--help"} & {*words}
    ):
        for line in output.splitlines():
            json.loads(line)


def _make_words(rng: Random) -> list[str]:
    verb = rng.choice(list(_VERBS))
    if rng.random() < 0.03:
        return [rng.choice(_WORDS) for _ in range(rng.randint(0, 4))]
    parser = _make_parser(verb)
    words: list[str] = []
    required = [each for each in parser._actions if not each.option_strings or each.required]
    optional = [each for each in parser._actions if each.option_strings and not each.required]
    if verb == "web":
        words += ["--port", rng.choice(_GOOD["port"])]
        optional = [each for each in optional if each.dest != "port"]
    for action in (
        *required,
        *rng.sample(optional, min(len(optional), rng.choice((0, 1, 1, 2, 3, 5)))),
    ):
        words += _write_action(action, rng)
    if rng.random() < 0.15:
        words.insert(rng.randrange(len(words) + 1), rng.choice(_WORDS))
    if verb == "web" and not {"-1", "70000", "x", "99999999999999"} & {*words}:
        words += ["--port", "x"]
    return [verb, *_make_small(verb, words)]


def _make_small(verb: str, words: list[str]) -> list[str]:
    """Keep runs of many settings small."""
    return [*words, "--relight.size=32"] if verb == "edit-maps" else words


def _write_action(action: argparse.Action, rng: Random) -> list[str]:
    """An option or an input, with values of its kind or of others."""
    flag = [rng.choice(action.option_strings)] if action.option_strings else []
    if action.nargs == 0 or rng.random() < 0.03:
        return flag
    name = action.dest.rpartition(".")[2].replace("-", "_")
    pool = [*_GOOD.get(name, ()), *map(str, action.choices or ())]
    count = rng.choice((1, 1, 2, 3)) if action.nargs in ("*", "+") else 1
    values = [rng.choice(pool if pool and rng.random() < 0.8 else _WORDS) for _ in range(count)]
    if len(flag) == 1 and flag[0].startswith("--") and rng.random() < 0.3:
        return [f"{flag[0]}={values[0]}"]
    return [*flag, *values]


@cache
def _make_files() -> dict[str, bytes]:
    """A folder of photographs, maps, a model, meshes and damaged files."""
    face = io.BytesIO()
    Image.fromarray(astronaut()[20:240:2, 110:330:2]).save(face, "JPEG", quality=90)
    plain = io.BytesIO()
    Image.new("RGB", (40, 30), (200, 150, 130)).save(plain, "PNG")
    arrays, files = archives.make_archives(), meshes.make_files()
    photo = face.getvalue()
    return {
        "face.jpg": photo,
        "plain.png": plain.getvalue(),
        "bad.jpg": photo[: len(photo) // 2],
        "empty.jpg": b"",
        "notes.txt": b"Gr\xf6\xdfe 1,2\n",
        "folder/a.jpg": photo,
        "folder/b.png": b"\x89PNG",
        "maps.npz": arrays["maps"],
        "hybrid.npz": arrays["HybridModel"],
        "bad.npz": arrays["maps"][:-40],
        "bad.obj": files["obj"]["face.obj"][:-700] + b"f 1 2 9999\n",
        "bad.ply": files["ply"]["face.ply"][:-30],
        "settings.yaml": b"seed: 3\n",
    }
