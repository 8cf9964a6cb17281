"""What the README says, works."""

import re
import shlex
from pathlib import Path

import pytest
from PIL import Image
from skimage.data import astronaut

from skinnet.cli import main

README = Path(__file__).parents[1] / "README.md"


def blocks(language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", README.read_text(encoding="utf-8"), re.DOTALL)


@pytest.fixture(autouse=True)
def photo(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Image.fromarray(astronaut()).save("photo.jpg")


@pytest.mark.parametrize("code", blocks("python"))
def test_python_runs(code: str) -> None:
    assert len(code.splitlines()) <= 8
    exec(code, {})


def test_commands_run() -> None:
    commands = [line for block in blocks("sh") for line in block.splitlines()]
    ours = [line for line in commands if line.startswith("skinnet ") and "--model" not in line]
    assert len(ours) == 2
    for command in ours:
        assert main(shlex.split(command, comments=True)[1:]) == 0
    assert Path("skinmaps/photo_panel.png").is_file() and Path("photo_edited.png").is_file()


def test_paths_exist() -> None:
    text = README.read_text(encoding="utf-8")
    for path in re.findall(r"configs/\w+\.yaml|\]\(([\w/.]+)\)", text):
        assert not path or (README.parent / path).is_file(), path
