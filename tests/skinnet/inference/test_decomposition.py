import json
from pathlib import Path

import numpy as np
import pytest

from skinnet import Decomposer, Decomposition, __version__
from skinnet.inference import draw_panel


def test_the_summary_is_json_of_what_the_arrays_hold(decomposition: Decomposition) -> None:
    summary = json.loads(json.dumps(decomposition.summary(), allow_nan=False))
    skin = decomposition.mask > 0.5
    melanin = summary["maps"]["melanin"]
    assert melanin["unit"] == "melanosome volume fraction"
    assert melanin["mean"] == pytest.approx(decomposition.melanin[skin].mean(), rel=1e-4)
    assert melanin["std"] == pytest.approx(decomposition.melanin[skin].std(), rel=1e-4)
    assert melanin["p5"] < melanin["mean"] < melanin["p95"]
    assert summary["skin_share"] == pytest.approx(skin[decomposition.box.slices].mean(), rel=1e-4)
    assert summary["box"] == decomposition.box._asdict()
    assert summary["photo"] == {"width": 512, "height": 512}
    assert summary["version"] == __version__
    assert summary["model"] == {"version": "0.1.0", "trained_on": "nothing", "optics": "paper"}


def test_without_skin_the_numbers_are_none(skinless_file: Path, astronaut: np.ndarray) -> None:
    decomposition = Decomposer(skinless_file)(astronaut)
    summary = decomposition.summary()
    assert summary["skin_share"] == 0
    assert summary["maps"]["hemoglobin"]["mean"] is None
    assert draw_panel(astronaut, decomposition).dtype == np.uint8
    np.testing.assert_array_equal(Decomposer(skinless_file).edit(astronaut, 3.0), astronaut)


def test_a_repr_holds_numbers_and_no_arrays(
    decomposition: Decomposition, skinless_file: Path, astronaut: np.ndarray
) -> None:
    summary = decomposition.summary()
    melanin, hemoglobin = (summary["pigments"][name] for name in ("melanin", "hemoglobin"))
    (low, high), (other_low, other_high) = melanin["interval"], hemoglobin["interval"]
    assert repr(decomposition) == (
        "<Decomposition 512 x 512: "
        f"melanin {melanin['mean']:.2g} (90%: {low:.2g} to {high:.2g}), "
        f"hemoglobin {hemoglobin['mean']:.2g} (90%: {other_low:.2g} to {other_high:.2g}), "
        f"{summary['skin_share']:.0%} is skin>"
    )
    assert repr(Decomposer(skinless_file)(astronaut)) == "<Decomposition 512 x 512: no skin>"


def test_channels_of_the_offset_are_described(decomposition: Decomposition) -> None:
    assert decomposition.describe_map("offset_g").unit == "linear sRGB"
    assert decomposition.describe_map("melanin").range == (0.0, 0.6)
