"""What the README says, works."""

import re
import shlex
from pathlib import Path

import pytest
from PIL import Image
from pipeline_scans import FAST, write_scan
from skimage.data import astronaut

from skinnet.cli import main

README = Path(__file__).parents[1] / "README.md"
SMALL = {
    "fit-shape": FAST,
    "maps": (*FAST, "--warp.size=48"),
    "build-model": ("--model.samples=3",),
    "edit-maps": ("--relight.size=64",),
}
"""Options that make the slower commands quick."""


def blocks(language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", README.read_text(encoding="utf-8"), re.DOTALL)


@pytest.fixture(autouse=True)
def photo(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("scans").mkdir()
    Image.fromarray(astronaut()).save("photo.jpg")


@pytest.mark.parametrize("code", blocks("python"))
def test_python_runs(code: str) -> None:
    assert len(code.splitlines()) <= 8
    exec(code, {})


@pytest.mark.slow
def test_commands_run() -> None:
    commands = [line for block in blocks("sh") for line in block.splitlines()]
    ours = [line for line in commands if line.startswith("skinnet ") and "--model" not in line]
    assert len(ours) == 8
    for number in (1, 2, 3):
        write_scan(Path(f"scans/{number}.obj"), number)
    for command in ours:
        words = shlex.split(command, comments=True)[1:]
        assert main([*words, *SMALL.get(words[0], ())]) == 0
    assert Path("skinmaps/photo_panel.png").is_file() and Path("photo_edited.jpg").is_file()
    assert Path("scans/skinmaps/1_edited_panel.png").is_file()


def test_paths_exist() -> None:
    text = README.read_text(encoding="utf-8")
    for path in re.findall(r"configs/\w+\.yaml|\]\(([\w/.]+)\)", text):
        assert not path or (README.parent / path).is_file(), path
