"""Garments on heads of both kinds: they hide what is under them, and nothing of them is skin."""

from collections.abc import Callable

import numpy as np
import pytest

from skinnet.mesh import Mesh
from skinnet.render import OrthographicView, Scene, trace_geometry
from train.synthetic.bodies.bald_ict import make_bald_ict
from train.synthetic.bodies.bald_procedural import make_bald_procedural
from train.synthetic.bodies.body import Neck
from train.synthetic.bodies.ict_model import IctModel
from train.synthetic.bodies.labelled_mesh import LabelledMesh, join, select
from train.synthetic.bodies.long_beards import make_long_beard
from train.synthetic.bodies.shell import HeadSurface
from train.synthetic.casts.head_cast import cast_view
from train.synthetic.garments import face_masks, headwear, neckwear
from train.synthetic.garments.glasses import make_any_glasses
from train.synthetic.labels import (
    BEARD,
    CLEAR_LENS,
    CLOTH,
    EYE,
    FACE_MASK,
    FILM,
    GLASSES,
    HEADWEAR,
    LENS,
    SCARF,
    SKIN,
)
from train.synthetic.subjects.framing import rotate

Bald = tuple[LabelledMesh, Neck]
SIDES = (-0.6, 0.0, 0.5)


@pytest.fixture(scope="module", params=["procedural", "ict"])
def bald(request: pytest.FixtureRequest) -> Bald:
    rng = np.random.default_rng(4)
    if request.param == "procedural":
        return make_bald_procedural(rng, "any")
    model: IctModel = request.getfixturevalue("ict_model")
    return make_bald_ict(model, rng, "any")


def find_skin(mesh: LabelledMesh, size: int = 90) -> np.ndarray:
    """Places on the chart of all skin that is seen from three sides."""
    scene, places = Scene(Mesh(mesh.vertices, mesh.triangles)), []
    for yaw in SIDES:
        axes = rotate(np.array([0, yaw, 0]))
        view = OrthographicView((size, size), np.array([0, 0, 20]) @ axes, axes, 0.6 * size / 2)
        hit = trace_geometry(scene, view)
        skin = mesh.label[hit.triangle] == SKIN
        corners = mesh.chart[mesh.triangles[hit.triangle[skin]]]
        places.append(np.einsum("pk,pkx->px", hit.barycentric[skin], corners))
    return np.concatenate(places)


def dress(bald: Bald, *garments: LabelledMesh) -> LabelledMesh:
    return join([bald[0], *garments])


@pytest.mark.parametrize("seed", range(4))
def test_a_mask_hides_the_mouth(bald: Bald, seed: int) -> None:
    surface = HeadSurface(select(bald[0], SKIN))
    mask = face_masks.make_face_mask(surface, np.random.default_rng(seed))
    assert set(mask.label) == {FACE_MASK}
    top = mask.chart[:, 1].max()
    assert top == 1
    azimuth, elevation = find_skin(dress(bald, mask)).T
    seen = (np.abs(azimuth) < 0.4) & (elevation < -0.9) & (elevation > -1.05)
    assert not seen.any()


@pytest.mark.parametrize(
    "make",
    [
        headwear.make_beanie,
        headwear.make_cap,
        headwear.make_brimmed_hat,
        headwear.make_hard_hat,
        headwear.make_turban,
    ],
)
def test_a_hat_hides_the_crown(
    bald: Bald, make: Callable[[HeadSurface, np.random.Generator], LabelledMesh]
) -> None:
    surface = HeadSurface(select(bald[0], SKIN))
    for seed in range(2):
        hat = make(surface, np.random.default_rng(seed))
        assert set(hat.label) == {HEADWEAR} and np.isfinite(hat.vertices).all()
        assert find_skin(dress(bald, hat))[:, 1].max() < 0.72


@pytest.mark.parametrize(
    ("make", "lowest"),
    [(headwear.make_headscarf, -1.4), (headwear.make_veil, -0.45)],
)
def test_a_hood_leaves_the_face_or_the_eyes(
    bald: Bald,
    make: Callable[[HeadSurface, Neck, np.random.Generator], LabelledMesh],
    lowest: float,
) -> None:
    surface = HeadSurface(select(bald[0], SKIN))
    for seed in range(2):
        hood = make(surface, bald[1], np.random.default_rng(seed))
        assert set(hood.label) == {HEADWEAR}
        azimuth, elevation = find_skin(dress(bald, hood)).T
        face = elevation > -1.2
        assert np.abs(azimuth[face]).max() < 1.35 and elevation.max() < 0.75
        assert elevation[np.abs(azimuth) < 0.5].min() > lowest
        assert ((np.abs(azimuth) < 0.5) & (np.abs(elevation) < 0.15)).any()


@pytest.mark.parametrize(
    ("make", "label"),
    [
        (neckwear.make_scarf, SCARF),
        (neckwear.make_roll_neck, SCARF),
        (neckwear.make_collar, CLOTH),
    ],
)
def test_neckwear_lies_around_the_neck(
    bald: Bald, make: Callable[[Neck, np.random.Generator], LabelledMesh], label: int
) -> None:
    worn = make(bald[1], np.random.default_rng(1))
    assert set(worn.label) == {label}
    assert worn.vertices[:, 1].max() < -0.6 and worn.vertices[:, 1].min() > -2
    low, high = worn.vertices[:, 0].min(), worn.vertices[:, 0].max()
    assert low < -0.4 and high > 0.4


def test_a_long_beard_hides_the_chin_and_not_the_lips(bald: Bald) -> None:
    surface = HeadSurface(select(bald[0], SKIN))
    beard = make_long_beard(surface, np.random.default_rng(2))
    assert set(beard.label) == {BEARD}
    azimuth, elevation = find_skin(dress(bald, beard)).T
    assert not ((np.abs(azimuth) < 0.2) & (np.abs(elevation + 0.98) < 0.08)).any()
    assert ((np.abs(azimuth) < 0.15) & (np.abs(elevation + 0.6) < 0.05)).any()


def test_skin_is_seen_through_clear_lenses_alone(bald: Bald) -> None:
    skin, eyes = select(bald[0], SKIN), np.array([[0.3, 0.02, 0.8], [-0.3, 0.02, 0.8]])
    if (bald[0].label == EYE).any():
        ball = select(bald[0], EYE).vertices
        eyes[:, 2] = ball[:, 2].max()
    kinds = {}
    for seed in range(12):
        glasses = make_any_glasses(skin, eyes, np.random.default_rng(seed))
        kinds[LENS if (glasses.label == LENS).any() else CLEAR_LENS] = glasses
    assert set(kinds[LENS].label) == {GLASSES, LENS}
    view = OrthographicView((64, 64), np.array([0.0, 0, 20]), np.eye(3), 0.6 * 32)
    for kind, glasses in kinds.items():
        head = dress(bald, glasses)
        cast = cast_view(head, Scene(Mesh(head.vertices, head.triangles)), view)
        behind = (cast.label == SKIN + FILM).sum()
        assert (behind > 40) == (kind == CLEAR_LENS)
        assert (cast.label == CLEAR_LENS).sum() == 0
        assert ((cast.label == LENS).sum() > 40) == (kind == LENS)
