"""Portraits with landmarks become maps and models, where the set is there."""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from examples import london

ROOT = Path(__file__).parents[2]
PORTRAITS = ROOT.parent / "shared" / "data" / "faces" / "london"


@pytest.mark.slow
def test_portraits_become_models(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    if not PORTRAITS.is_dir():
        pytest.skip(f"{PORTRAITS} is not there")
    portraits, results = tmp_path / "portraits", tmp_path / "results"
    portraits.mkdir()
    for template in sorted(PORTRAITS.rglob("*.tem"))[:4]:
        _reduce(template, portraits)
    monkeypatch.setattr(london, "SIZE", 64)
    words = [str(portraits), "-o", str(results), "--skins", "2"]
    assert london.main(words) == 0
    assert (results / "model" / "hybrid.npz").is_file()
    assert (results / "skins.npz").is_file()
    assert capsys.readouterr().out.count("hemoglobin") >= 4


def _reduce(template: Path, folder: Path) -> None:
    """Copy a portrait, and its landmarks, at a fifth of its size."""
    with Image.open(template.with_suffix(".jpg")) as photo:
        photo.reduce(5).save(folder / f"{template.stem}.jpg", quality=95)
    count, *rows = template.read_text(encoding="utf-8").split("\n")
    points = np.array([row.split() for row in rows[: int(count)]], float) / 5
    lines = [count, *(f"{x} {y}" for x, y in points)]
    (folder / template.name).write_text("\n".join(lines) + "\n")
