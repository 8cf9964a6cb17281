"""What docs/known.md says, works."""

import re
import shlex
import shutil
from pathlib import Path

import numpy as np
import pytest
import raw_files
from PIL import Image
from skimage.data import astronaut

from benchmarks.chart_pictures import View, photograph
from skinnet.cli import main
from skinnet.images import srgb_to_linear

GUIDE = Path(__file__).parents[1] / "docs" / "known.md"


def blocks(language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", GUIDE.read_text(encoding="utf-8"), re.DOTALL)


@pytest.fixture(scope="module")
def pictures(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A photograph with a grey card, a chart, a RAW file, and shots in several lights."""
    folder = tmp_path_factory.mktemp("guide")
    photo = astronaut()
    Image.fromarray(photo).save(folder / "before.jpg", quality=95)
    Image.fromarray(np.ascontiguousarray(photo[:, 4:])).save(folder / "after.jpg", quality=95)
    photo[50:100, 390:450] = 180
    Image.fromarray(photo).save(folder / "photo.jpg", quality=95)
    view = View("D55", 3, tilt=20, axis=40, roll=8, exposure=0.55, contrast=0.14, bend=0.5)
    Image.fromarray(photograph(view)).save(folder / "chart.jpg", quality=95)
    raw = raw_files.photograph_picture(srgb_to_linear(astronaut()), "Nikon D700")
    (folder / "portrait.dng").write_bytes(raw)
    for name in ("session", "folder"):
        (folder / name).mkdir()
    for name, gain in {"a": (1, 1, 1), "b": (1.06, 1, 0.9), "c": (0.95, 1, 1.08)}.items():
        shot = (photo * np.array(gain)).clip(0, 255).astype(np.uint8)
        Image.fromarray(shot).save(folder / f"{name}.jpg", quality=95)
        shutil.copy(folder / f"{name}.jpg", folder / "session")
    shutil.copy(folder / "photo.jpg", folder / "folder")
    (folder / "photos").symlink_to(folder / "session")
    return folder


@pytest.fixture(autouse=True)
def inside(pictures: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(pictures)


@pytest.mark.parametrize("code", blocks("python"))
def test_python_runs(code: str) -> None:
    assert len(code.splitlines()) <= 9
    exec(code, {})


@pytest.mark.slow
def test_commands_run() -> None:
    commands = [line for block in blocks("sh") for line in block.splitlines()]
    assert len(commands) == 13
    for command in commands:
        words = shlex.split(command, comments=True)
        # The photograph shows no chart; the picture of one shows no face.
        expected = 2 if "--chart" in words else 0
        assert main(words[1:]) == expected, command
    assert Path("studio.yaml").is_file() and Path("faces.csv").is_file()
