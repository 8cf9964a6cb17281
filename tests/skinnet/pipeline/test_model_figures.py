"""Pictures are written and have their rows and columns."""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from skinnet.appearance._curves import Curve
from skinnet.appearance.hybrid import HybridModel
from skinnet.appearance.linear import LinearModel
from skinnet.appearance.measures import Measures
from skinnet.appearance.stack import SubjectStack
from skinnet.errors import InputError
from skinnet.inference._tiles import TILE
from skinnet.pipeline._model_figures import draw_hybrid, draw_linear, fill_texels, plot_measures


def measures(name: str, shape: bool) -> Measures:
    counts = np.arange(1, 6)
    curve = Curve(counts, np.ones((5, 3)) / counts[:, None], "")
    more = (curve, curve) if shape else (None, None)
    return Measures(name, np.linspace(0.5, 1, 6), curve, curve, curve, *more)


@pytest.mark.parametrize("shape", [True, False])
def test_curves_are_written_without_pyplot(tmp_path: Path, shape: bool) -> None:
    path = tmp_path / "measures.png"
    plot_measures(path, [measures("hybrid", False), measures("other", shape)])
    with Image.open(path) as picture:
        assert picture.format == "PNG" and (picture.width > 1.7 * picture.height) == shape
    assert [file.name for file in tmp_path.iterdir()] == ["measures.png"]


def test_the_hybrid_has_three_rows(stack: SubjectStack) -> None:
    model = HybridModel.fit(stack)
    picture = draw_hybrid(model, deviations=2.0, components=2)
    one = draw_linear(LinearModel.fit(stack), deviations=2.0, components=2)
    assert picture.dtype == np.uint8 and picture.shape[1] == one.shape[1] > 5 * TILE
    assert 3 < picture.shape[0] / one.shape[0] < 3.5  # maps have a scale below


def test_the_appearance_can_be_rendered(stack: SubjectStack) -> None:
    seen: list[np.ndarray] = []

    def renderer(albedo: np.ndarray) -> np.ndarray:
        seen.append(albedo)
        return np.full((10, 30, 3), 200, np.uint8)

    model = HybridModel.fit(stack)
    draw_hybrid(model, components=1, renderer=renderer)
    mask = model.mask
    assert np.array_equal(seen[0][mask], model.reconstruct(np.zeros(6))[mask]) and len(seen) == 3
    beta = np.eye(6)[0] * -3 * np.sqrt(model.statistics.variances)
    assert np.allclose(seen[1][mask], model.reconstruct(beta)[mask])


def test_texels_that_are_not_modelled_are_not_black() -> None:
    mask = np.zeros((4, 4), bool)
    mask[0, 0] = mask[3, 3] = True
    albedo = np.zeros((4, 4, 3), np.float32)
    albedo[0, 0], albedo[3, 3] = 0.2, 0.6
    filled = fill_texels(albedo, mask)
    assert (filled[0, 1] == albedo[0, 0]).all() and (filled[3, 2] == albedo[3, 3]).all()
    assert filled.min() > 0.1


@pytest.mark.parametrize("components", [0, 7])
def test_components_that_are_not_there_are_refused(stack: SubjectStack, components: int) -> None:
    with pytest.raises(InputError, match=f"The model has 6 components; {components} cannot"):
        draw_hybrid(HybridModel.fit(stack), components=components)
