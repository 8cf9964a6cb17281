"""Beards, make-up and plasters on the chart: stubble is skin, a full beard is not."""

import numpy as np
import pytest
import torch
from torch.utils.data import default_collate

from skinnet.shape._procedural_head import compute_chart_angles
from train.synthetic.painting.face_painting import paint_face
from train.synthetic.painting.style_painting import cover_with_style
from train.synthetic.sampling.face_sampling import sample_face
from train.synthetic.sampling.style_sampling import STUBBLE_RANGE
from train.synthetic.scene import CHART_SIZE, BeardStyleParameters, FaceParameters, map_tensors

AZIMUTH, ELEVATION = compute_chart_angles(*CHART_SIZE)
CHIN = (AZIMUTH.abs() < 0.15) & (ELEVATION < -0.9) & (ELEVATION > -1.05)
CHEEK = ((AZIMUTH.abs() - 0.8).abs() < 0.1) & ((ELEVATION + 0.75).abs() < 0.08)
FOREHEAD = (AZIMUTH.abs() < 0.6) & ((ELEVATION - 0.45).abs() < 0.08)
LIPS = (AZIMUTH.abs() < 0.1) & ((ELEVATION + 0.69).abs() < 0.02)


@pytest.fixture(scope="module")
def face() -> FaceParameters:
    """Three bare faces."""
    faces = [sample_face(np.random.default_rng(seed), variety="any") for seed in (1, 2, 3)]
    batch: FaceParameters = default_collate([map_tensors(torch.Tensor.float, f) for f in faces])
    make_up = map_tensors(torch.zeros_like, batch.cosmetics)
    features = batch.features._replace(make_up=torch.zeros(3))
    return batch._replace(
        cosmetics=make_up, features=features, beard_style=grow(batch.beard_style, 0, 0)
    )


def grow(style: BeardStyleParameters, beard: float, stubble: float) -> BeardStyleParameters:
    return style._replace(
        parts=torch.ones_like(style.parts),
        cheek_line=torch.zeros_like(style.cheek_line),
        beard=torch.full_like(style.beard, beard),
        stubble=torch.full_like(style.stubble, stubble),
    )


def test_stubble_counts_as_skin_and_a_full_beard_does_not(face: FaceParameters) -> None:
    densest = grow(face.beard_style, 0.0, STUBBLE_RANGE[1])
    stubble = paint_face(face._replace(beard_style=densest)).cover[:, 0]
    beard = paint_face(face._replace(beard_style=grow(face.beard_style, 0.9, 0))).cover[:, 0]
    for place in (CHIN, CHEEK):
        assert (0.2 < stubble[:, place]).all() and (stubble[:, place] < 0.5).all()
        assert (beard[:, place] > 0.5).float().mean() > 0.97
    for cover in (stubble, beard):
        assert (cover[:, FOREHEAD] < 0.05).all() and (cover[:, LIPS] < 0.4).all()


def test_the_edge_of_a_beard_is_soft_and_irregular(face: FaceParameters) -> None:
    cover = cover_with_style(grow(face.beard_style, 1.0, 0.0), AZIMUTH.abs(), ELEVATION)[:, 0]
    columns = (AZIMUTH[0].abs() > 0.5) & (AZIMUTH[0].abs() < 1.2)
    upper = (cover > 0.5).float().argmax(1)[:, columns].float()
    slope = torch.linspace(0, 1, upper.shape[1])
    assert (upper.diff(dim=1).std(dim=1) > 0.7).all() and slope.numel() > 20
    between = (cover > 0.15) & (cover < 0.85)
    assert (between.float().mean((1, 2)) > 0.02).all()


def test_foundation_evens_out_pigments_and_stays_skin(face: FaceParameters) -> None:
    made_up = face.cosmetics._replace(foundation=torch.full((3,), 0.8))
    before, after = (paint_face(f) for f in (face, face._replace(cosmetics=made_up)))
    inside = (AZIMUTH.abs() < 0.9) & (ELEVATION.abs() < 0.6)
    spread = [one.melanin[:, 0][:, inside].log().std(1) for one in (before, after)]
    assert (spread[1] < 0.6 * spread[0]).all()
    torch.testing.assert_close(before.cover, after.cover)


def test_a_plaster_and_lipstick_cover_their_places_alone(face: FaceParameters) -> None:
    worn = face.cosmetics._replace(
        plaster=torch.tensor([[0.0, 0.45, 0.0, 0.2, 0.07]]).expand(3, -1),
        plaster_opacity=torch.ones(3),
        plaster_colour=torch.full((3, 3), 0.4),
    )
    features = face.features._replace(make_up=torch.full((3,), 0.9))
    charts = paint_face(face._replace(cosmetics=worn, features=features))
    plaster = torch.hypot(AZIMUTH, ELEVATION - 0.45) < 0.05
    assert (charts.cover[:, 0][:, plaster] > 0.9).all()
    assert (charts.cover[:, 0][:, LIPS] > 0.8).all()
    assert (charts.cover[:, 0][:, CHIN | CHEEK] < 0.1).all()
