"""Synthetic faces on a chart: upright, symmetric, with skin in the middle."""

from pathlib import Path

import numpy as np

from train.dynamic import charted_faces
from train.dynamic.charted_faces import chart_faces
from train.synthetic.videos.clips import Clips


def test_faces_are_laid_out(tmp_path: Path, monkeypatch) -> None:  # type: ignore[no-untyped-def]
    def make_few(count, settings, seed, **words):  # type: ignore[no-untyped-def]
        return Clips(count, settings, seed, heads=2, size=128, **words)

    monkeypatch.setattr(charted_faces, "Clips", make_few)
    monkeypatch.setattr(charted_faces, "_FRONTAL", 1.0)
    monkeypatch.setattr(charted_faces, "_TURNED", 1.0)
    faces = chart_faces(2, 32, 0, None, str(tmp_path))
    assert faces.landmarks.shape == (478, 2) and faces.hemoglobin.shape == (2, 32, 32)
    eyes = faces.landmarks[[33, 263]]
    assert abs(eyes[:, 0].sum() - 1) < 0.05 and abs(eyes[0, 1] - eyes[1, 1]) < 0.02
    middle = faces.hemoglobin[:, 12:20, 12:20]
    assert np.isfinite(middle).mean() > 0.5 and np.nanmax(middle) < 0.3
    assert np.isnan(faces.hemoglobin[:, 0, 0]).all()
