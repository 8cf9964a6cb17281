"""The table of quantised files has a row for each way; float32 does not differ from itself."""

import numpy as np
import pytest

from benchmarks.quantised import DECODERS, Faces, compare, measure


def make_outputs(melanin: float, mask: np.ndarray) -> dict[str, np.ndarray]:
    level = np.full(mask.shape, melanin, np.float32)
    return {
        "melanin": level[None],
        "hemoglobin": np.full_like(level, 0.05)[None],
        "mask": mask[None],
    }


def test_errors_are_shares_of_the_mean_over_skin() -> None:
    mask = np.zeros((4, 4))
    mask[:2] = 1
    other = np.zeros((4, 4))
    other[0] = 1
    faces = Faces(np.zeros((1, 4, 4, 3), np.uint8), np.full((1, 4, 4), 0.03), mask[None] > 0)
    found = compare([make_outputs(0.04, mask)], [make_outputs(0.05, other)], faces)
    assert found["melanin"] == pytest.approx(0.25) == found["melanin_of_face"]
    assert found["hemoglobin"] == 0 and found["melanin_from_truth"] == pytest.approx(0.02)
    assert found["mask_iou"] == 0.5


@pytest.mark.slow
def test_the_benchmark_measures_every_way() -> None:
    found = measure(heads=1, count=2, rounds=1)
    ways = ["float32", "float16", "dynamic", "dynamic_uint8", "static"]
    assert list(found["encoder"]) == ways and tuple(found["decoder"]) == DECODERS
    for rows in found.values():
        assert rows["float32"]["times_faster"] == 1
        assert all(np.isfinite(list(row.values())).all() for row in rows.values())
    encoder = found["encoder"]
    assert encoder["float32"]["melanin"] == 0 == found["decoder"]["float32"]["image"]
    for way in ways[1:]:
        assert encoder[way]["megabytes"] < 0.6 * encoder["float32"]["megabytes"]
        assert encoder[way]["melanin"] < 0.2 and encoder[way]["mask_iou"] > 0.9
