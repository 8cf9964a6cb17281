"""The blushing faces: what Blender is given."""

import json
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from examples import blushing
from skinnet.mesh._topology import list_boundary_loops
from skinnet.shape import load_shape_model


def test_blender_gets_three_skins_and_a_head(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    commands: list[list[Any]] = []
    monkeypatch.setattr(blushing, "_SIDE", 256)

    def render(words: list[Any], **_: object) -> None:
        commands.append(words)
        for tone in json.loads(words[-1]):
            for name in ("rest", "blushing", "near"):
                Image.new("RGB", (8, 8)).save(tmp_path / f"{tone}_{name}.png")

    monkeypatch.setattr(subprocess, "run", render)
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
    with Image.open(tmp_path / "blushing.png") as sheet:
        assert sheet.size == (24, 24)


def test_the_rim_of_the_head_is_smooth() -> None:
    model = load_shape_model()
    rim = max(list_boundary_loops(model.triangles), key=len)
    smooth = blushing._smooth_rim(model.mean, model.triangles)
    roughness = [np.abs(np.diff(one[rim], 2, axis=0)).mean() for one in (smooth, model.mean)]
    assert roughness[0] < 0.2 * roughness[1]
    inner = np.setdiff1d(np.arange(len(smooth)), rim)
    assert (smooth[inner] == model.mean[inner]).all()
