"""Charts in rendered pictures are found, and white is known within a few percent."""

import pytest

from benchmarks import charts
from benchmarks.chart_pictures import load_light, load_patches
from skinnet.physics import load_light as load_physical_light


@pytest.mark.slow
def test_charts_are_found(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(charts, "LIGHTS", ("D65", "LED-B3", "A"))
    found = charts.measure(pictures=1)
    assert found["all"]["pictures"] == 3 and found["shaded"]["pictures"] == 1
    assert found["all"]["found"] == 1
    assert found["all"]["white_error"]["p95"] < 0.03


@pytest.mark.parametrize("name", ["A", "FL11", "LED-B3"])
def test_lights_are_those_of_physics(name: str) -> None:
    own = load_light(name)
    assert own / own.sum() == pytest.approx(load_physical_light(name).numpy(), rel=0.15, abs=2e-3)


def test_patches_are_reflectances() -> None:
    patches = load_patches()
    assert patches.shape == (24, 33) and 0 < patches.min() < patches.max() < 1
