"""Synthetic heads: what they are made of, and that paint fits both kinds."""

from pathlib import Path

import numpy as np
import pytest

from skinnet.errors import InputError
from train.synthetic.bodies.ict_chart import LANDMARK_PLACES
from train.synthetic.bodies.ict_model import ARRAYS, IctModel, read_ict_model
from train.synthetic.bodies.labelled_mesh import LabelledMesh, find_vertex, mirror, select
from train.synthetic.labels import CLOTH, EYE, HAIR, MOUTH, SKIN, TEETH
from train.synthetic.subjects.heads import make_ict_head, make_procedural_head


def test_a_procedural_head_has_its_parts(head: LabelledMesh) -> None:
    assert {SKIN, EYE, HAIR, CLOTH} <= set(head.label)
    _whole(head)


def test_an_ict_head_has_its_parts(ict: LabelledMesh) -> None:
    assert {SKIN, EYE, TEETH, MOUTH, HAIR, CLOTH} <= set(ict.label)
    _whole(ict)


def test_the_same_seed_makes_the_same_head(
    head: LabelledMesh, ict: LabelledMesh, ict_model: IctModel
) -> None:
    again = (
        make_procedural_head(np.random.default_rng(6)),
        make_ict_head(ict_model, np.random.default_rng(1)),
    )
    for one, other in zip((head, ict), again, strict=True):
        for a, b in zip(one, other, strict=True):
            np.testing.assert_array_equal(a, b)


@pytest.mark.parametrize(
    ("azimuth", "elevation", "x", "y"), [(0, -0.33, 0, -0.3), (0.34, 0.08, 0.3, 0.08)]
)
def test_paint_fits_both_kinds(
    head: LabelledMesh, ict: LabelledMesh, azimuth: float, elevation: float, x: float, y: float
) -> None:
    for one in (head, ict):
        place = find_vertex(select(one, SKIN), azimuth, elevation)
        assert place[:2] == pytest.approx([x, y], abs=0.12) and place[2] > 0.6


def test_the_charts_of_an_ict_head_put_landmarks_where_they_are_painted(
    ict_model: IctModel, ict_file: Path
) -> None:
    landmarks = np.load(ict_file)["landmarks68"]
    for numbers, place in LANDMARK_PLACES:
        found = ict_model.chart[landmarks[list(numbers)]].mean(0)
        assert found == pytest.approx(place, abs=0.02)


def test_the_charts_of_an_ict_head_are_symmetric(ict_model: IctModel) -> None:
    face = slice(0, 9409)
    image = mirror(
        LabelledMesh(ict_model.mean, ict_model.triangles, ict_model.label, ict_model.chart)
    )
    off = image.vertices[face, None, :][::37] - ict_model.mean[face][None]
    nearest = (off**2).sum(2).argmin(1)
    np.testing.assert_allclose(image.chart[face][::37], ict_model.chart[face][nearest], atol=0.02)


def test_an_iris_lies_around_the_gaze(ict: LabelledMesh) -> None:
    eyes = select(ict, EYE)
    front = eyes.vertices[np.hypot(*eyes.chart.T) < 1]
    assert 0.02 < np.ptp(front[front[:, 0] > 0, 1]) / 2 < 0.08
    assert (front[:, 2] > np.median(eyes.vertices[:, 2])).all()


def test_a_file_without_an_array_is_refused(tmp_path: Path) -> None:
    np.savez(tmp_path / "a.npz", verts=np.zeros((4, 3)))
    with pytest.raises(InputError, match=r"a\.npz lacks id_modes"):
        read_ict_model(tmp_path / "a.npz")


def test_a_file_that_is_no_model_is_refused(tmp_path: Path) -> None:
    (tmp_path / "a.npz").write_bytes(b"PK\x03\x04 cut short")
    with pytest.raises(InputError, match=r"a\.npz cannot be read"):
        read_ict_model(tmp_path / "a.npz")
    with pytest.raises(InputError, match=r"b\.npz cannot be read"):
        read_ict_model(tmp_path / "b.npz")


def test_arrays_of_different_meshes_are_refused(tmp_path: Path) -> None:
    sizes = {"verts": (30, 3), "id_modes": (2, 31, 3), "expr_modes": (1, 30, 3)}
    arrays = {name: np.zeros([n or 3 for n in shape], np.int32) for name, shape in ARRAYS.items()}
    arrays |= {name: np.zeros(size) for name, size in sizes.items()}
    np.savez(tmp_path / "a.npz", **arrays)
    with pytest.raises(InputError, match=r"a\.npz.* do not belong together"):
        read_ict_model(tmp_path / "a.npz")
    np.savez(tmp_path / "a.npz", **(arrays | {"landmarks68": np.zeros(51, np.int32)}))
    with pytest.raises(InputError, match="landmarks68 is"):
        read_ict_model(tmp_path / "a.npz")


def _whole(head: LabelledMesh) -> None:
    assert np.isfinite(head.vertices).all() and np.isfinite(head.chart).all()
    assert head.triangles.max() < len(head.vertices) == len(head.chart)
    assert head.label.dtype == np.uint8 and len(head.label) == len(head.triangles)
    skin = select(head, SKIN).vertices
    assert skin[:, 1].max() == pytest.approx(1, abs=0.25)
