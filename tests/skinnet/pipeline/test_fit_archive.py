"""Archives of fitted shapes: arrays that do not fit together are refused."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from skinnet.errors import InputError
from skinnet.pipeline._fit_archive import load_fit, save_fit
from skinnet.shape import Registration, Similarity, StageRecord


@pytest.fixture
def arrays(tmp_path: Path) -> dict[str, Any]:
    fit = Registration(
        Similarity(np.eye(3), 1.0, np.zeros(3)),
        np.zeros(2),
        np.ones((5, 3)),
        np.ones(5),
        np.ones(5, bool),
        1.0,
        (StageRecord(5, 2, (2.0, 1.0), True),),
    )
    save_fit(tmp_path / "a_shape.npz", fit, {})
    assert load_fit(tmp_path / "a_shape.npz").record == fit.record
    with np.load(tmp_path / "a_shape.npz") as file:
        return dict(file)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("vertices", np.ones((4, 3))),
        ("vertices", np.full((5, 3), np.nan)),
        ("distances", np.ones(5) * 1j),
        ("kept", np.ones(1, bool)),
        ("kept", np.zeros(5, bool)),
        ("rotation", np.eye(2)),
        ("translation", np.array(["a", "b", "c"])),
        ("scale", np.float64(np.nan)),
        ("millimetres", np.float64(0)),
        ("stages", np.array("[]")),
        ("stages", np.array('[{"vertices": 5, "modes": null, "rms": [1], "converged": true}]')),
    ],
)
def test_a_changed_array_is_refused(
    name: str, value: Any, arrays: dict[str, Any], tmp_path: Path
) -> None:
    np.savez(tmp_path / "b_shape.npz", **arrays | {name: value})
    with pytest.raises(InputError, match=r"b_shape\.npz is no fitted shape"):
        load_fit(tmp_path / "b_shape.npz")
