"""The blushing faces: what Blender is given."""

import json
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from examples import blushing


def test_blender_gets_three_skins_and_a_head(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    commands: list[list[Any]] = []
    monkeypatch.setattr(blushing, "_SIDE", 256)
    monkeypatch.setattr(subprocess, "run", lambda words, **_: commands.append(words))
    assert blushing.main(tmp_path) == 0
    ((_, script, folder, tones),) = commands
    assert Path(script).is_file() and folder == tmp_path
    means = []
    for tone in json.loads(tones):
        assert (tmp_path / tone / "skin_blender.py").is_file()
        picture = Image.open(tmp_path / f"{tone}_melanin.png")
        means.append(np.array(picture).mean() * float(picture.text["scale"]))
    assert means == sorted(means) and means[-1] > 5 * means[0]
    assert (tmp_path / "face.obj").is_file()
