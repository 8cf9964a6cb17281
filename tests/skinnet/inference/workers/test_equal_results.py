"""Two processes give what one gives: files, lines, table, page, and exit code."""

import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from skinnet.cli import main


@pytest.fixture(scope="module")
def photographs(tmp_path_factory: pytest.TempPathFactory, astronaut: np.ndarray) -> Path:
    """One person under names that collide, several people, a wall, a damaged file."""
    folder = tmp_path_factory.mktemp("photographs")
    small = Image.fromarray(astronaut).resize((256, 256))
    for name in ("a.jpg", "a.png", "a-2.jpg"):
        small.save(folder / name)
    pair = np.hstack([np.asarray(small), np.asarray(small)[:, ::-1]])
    Image.fromarray(pair).save(folder / "b.jpg")
    Image.new("RGB", (256, 256), (90, 120, 200)).save(folder / "wall.png")
    (folder / "z.jpg").write_bytes(b"\xff\xd8\xff")
    return folder


def run(
    words: Sequence[object], folder: Path, workers: int, capsys: pytest.CaptureFixture[str]
) -> tuple[int, str, list[str], dict[str, bytes]]:
    """Run a verb in a folder; what it prints, without rates, and all files there."""
    folder.mkdir()
    output = ["-o", str(folder / "out") + "/", "--workers", str(workers)]
    code = main([*map(str, words), *output])
    out, err = capsys.readouterr()
    files = {
        str(path.relative_to(folder)): re.sub(rb", [\d.e+]+ per second", b"", path.read_bytes())
        for path in folder.rglob("*")
        if path.is_file()
    }
    moved = [text.replace(str(folder), "") for text in (out, err)]
    lines = re.sub(r", [\d.e+]+ per second", "", moved[1]).splitlines()
    written = {name: data.replace(str(folder).encode(), b"") for name, data in files.items()}
    return code, moved[0], [each for each in lines if "processes" not in each], written


def test_predict(
    photographs: Path, model_file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["predict", photographs, "--model", model_file, "--faces", "all", "--json"]
    results = []
    for name, workers in (("1", 1), ("2", 2)):
        folder = tmp_path / name
        page = [f"--csv={folder}/numbers.csv", f"--report={folder}/page.html", "--colour-maps=all"]
        results.append(run([*words, *page], folder, workers, capsys))
    code, out, err, files = results[0]
    assert code == 2 and out.count("\n") >= 4
    assert "page.html" in files and "numbers.csv" in files and "out/a-3.json" in files
    assert results[1] == results[0]
    assert "1 could not be read, 1 without a face" in err[-1], err


def test_edit(
    photographs: Path, model_file: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    mask = tmp_path / "mask.png"
    Image.new("L", (256, 256), "white").save(mask)
    words = ["edit", photographs, "--model", model_file, "--melanin", 1.5, "--mask", mask, "-v"]
    one, two = (run(words, tmp_path / str(count), count, capsys) for count in (1, 2))
    assert one[0] == 2 and "out/a_edited.jpg" in one[3] and "out/a-2_edited.jpg" in one[3]
    kept = [
        [line for line in each[2] if " took " not in line and "assumed" not in line]
        for each in (one, two)
    ]
    assert kept[1] == kept[0]
    assert (two[0], two[1], two[3]) == (one[0], one[1], one[3])
