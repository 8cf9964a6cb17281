"""Settings that cannot be are refused before any work begins."""

import re
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

import pytest

from skinnet.errors import InputError
from skinnet.pipeline._build_model import ModelSettings
from skinnet.pipeline._sentence_parser import SentenceParser
from skinnet.pipeline.calibrate import ColourSettings
from skinnet.pipeline.texture_space import WarpSettings
from skinnet.shape import FitSettings

WRONG = [
    *(
        (FitSettings, {"seed": -1}),
        (FitSettings, {"iterations": 0}),
        (FitSettings, {"angle": -5.0}),
    ),
    *((FitSettings, {"tolerance": float("nan")}), (FitSettings, {"map_weight": float("nan")})),
    (FitSettings, {"stages": ((-1, 0, 0.1),)}),
    *((ModelSettings, {"samples": -1}), (ModelSettings, {"seed": -1})),
    *((ModelSettings, {"components": 0}), (ModelSettings, {"share": 0.0})),
    *((WarpSettings, {"limit": -1.0}), (WarpSettings, {"angle": float("nan")})),
]


@pytest.mark.parametrize(("kind", "values"), WRONG)
def test_numbers_out_of_range(kind: Callable[..., object], values: dict[str, object]) -> None:
    with pytest.raises(InputError, match=r"; got "):
        kind(**values)


@pytest.mark.parametrize(
    "settings",
    [
        ColourSettings(f_mel=(0.4, 0.1)),
        ColourSettings(f_blood=(0.0, 15.0)),
        ColourSettings(f_mel=(float("nan"), 0.1)),
        ColourSettings(seed=-1),
    ],
)
def test_colours_are_checked_before_the_fit(settings: ColourSettings) -> None:
    with pytest.raises(InputError, match="got"):
        settings.check()


def test_a_seed_of_samples(tmp_path: Path, refused: Callable[..., str]) -> None:
    said = refused("sample", tmp_path / "absent.npz", "--seed", -1)
    assert "seed is a whole number from 0; got -1" in said


def make_bomb() -> str:
    """A text of 300 bytes that is a billion values when its aliases are written out."""
    levels = [f"{b}: &{b} [{','.join(['*' + a] * 9)}]" for a, b in pairwise("abcdefghij")]
    return "\n".join(["a: &a [x]", *levels])


CONTENTS = {
    "aliases": (make_bomb().encode(), "more than 100,000 values"),
    "an alias of itself": (b"count: &a [*a]", r"\*a stands inside of &a"),
    "depth": (b"count: " + b"[" * 3000, "deep"),
    "Latin-1": (b"# Gr\xf6\xdfe\ncount: 3", "line 1 has the byte 0xf6"),
    "a zero byte": (b"count: \0", "control characters"),
    "a binary file": (bytes(range(128, 256)) * 10, "UTF-8"),
}


@pytest.mark.parametrize("kind", CONTENTS)
def test_files_of_settings(tmp_path: Path, refused: Callable[..., str], kind: str) -> None:
    content, expected = CONTENTS[kind]
    path = tmp_path / "settings.yaml"
    path.write_bytes(content)
    for arguments in ([f"--config={path}"], ["--config", path], ["--fit", path]):
        said = refused("maps" if "--fit" in arguments else "sample", *arguments)
        assert str(path) in said and re.search(expected, said)


def test_values_on_the_command_line_are_bounded() -> None:
    parser = SentenceParser(prog="skinnet sample")
    parser.add_argument("--numbers", type=list[int])
    with pytest.raises(InputError):
        parser.parse_args(["--numbers", "[" * 3000 + "]" * 3000])
    assert parser.parse_args(["--numbers", "[1, 2]"]).numbers == [1, 2]


def test_settings_within_settings(tmp_path: Path, refused: Callable[..., str]) -> None:
    (tmp_path / "inner.yaml").write_bytes(b"# \xff")
    outer = tmp_path / "outer.yaml"
    for name in (tmp_path / "inner.yaml", "inner.yaml"):
        outer.write_text(f"fit: {name}\n")
        said = refused("maps", "--config", outer, "a.obj")
        assert f"{tmp_path / 'inner.yaml'} is not text in UTF-8: line 1" in said
    outer.write_text("fit: outer.yaml\n")  # without an end
    refused("maps", "--config", outer, "a.obj")


@pytest.mark.parametrize(
    ("verb", "text", "said"),
    [
        ("build-model", "appearance: {share: null}", "appearance.share has no value"),
        ("fit-shape", "fit: [1, 2]", "settings cannot be used"),
        ("maps", 'shape: "a\\0b"', r"no shape model a\x00b"),
        ("edit-maps", "melanin_add: " + "x" * 5000, "melanin_add is a number"),
    ],
)
def test_a_setting_of_another_kind(
    verb: str, text: str, said: str, tmp_path: Path, refused: Callable[..., str]
) -> None:
    (tmp_path / "a.yaml").write_text(text)
    sentence = refused(verb, tmp_path / "absent", "--config", tmp_path / "a.yaml")
    assert said in sentence and len(sentence) < 1500
