"""The parts of the constancy benchmark that need no portraits, and its contract on a few."""

import csv
from pathlib import Path

import numpy as np
import pytest
import torch
from PIL import Image
from skimage.data import astronaut

from benchmarks import constancy
from benchmarks.capture_spreads import measure_spreads
from benchmarks.colour_of_places import PLACES, LinearMap, map_to_other, measure_places
from benchmarks.face_photographs import REGIONS, describe_colour, find_face
from benchmarks.pigment_changes import FACTORS, PigmentEditor, fit_slope, remove_colour
from benchmarks.reader import NetworkReader
from benchmarks.repeated_faces import RepeatedFaces, render_changed
from benchmarks.second_source import DEGRADATIONS, degrade
from benchmarks.skin_readings import SkinReading, compute_angles
from benchmarks.synthetic_constancy import (
    correlate_errors,
    fuse,
    fuse_people,
    measure_coverage,
    score_fused,
)
from benchmarks.white_balances import balance_to_grey
from skinnet.images import resize, srgb_to_linear
from skinnet.network import SkinAutoencoder
from skinnet.physics import SkinDecoder


@pytest.fixture(scope="module")
def reader() -> NetworkReader:
    return NetworkReader(SkinAutoencoder.from_pretrained())


def test_the_linear_map_recovers_what_is_linear_and_ignores_what_is_missing() -> None:
    rng = np.random.default_rng(0)
    features = rng.normal(0, 1, (400, 6))
    target = features @ [1, -2, 0.5, 0, 0, 0] + 3
    features[::2, 5] = np.nan
    fitted = LinearMap(features, target)
    assert np.abs(fitted(features) - target).max() < 0.05


def test_the_linear_map_shrinks_noise_to_the_mean() -> None:
    rng = np.random.default_rng(0)
    fitted = LinearMap(rng.normal(0, 1, (100, 60)), rng.normal(5, 1, 100))
    guess = fitted(rng.normal(0, 1, (100, 60)))
    assert guess.std() < 0.3 and guess.mean() == pytest.approx(5, abs=0.3)


def test_the_map_predicts_the_other_photograph() -> None:
    rng = np.random.default_rng(0)
    features = rng.normal(0, 1, (200, 2, 3))
    target = features[:, ::-1, 0]
    guess = map_to_other((features, target), features)
    assert guess == pytest.approx(features[..., 0], abs=0.05)


def test_slopes_are_those_of_logarithms() -> None:
    read = 0.7 * np.log(FACTORS) - 2
    assert fit_slope(read) == pytest.approx(0.7)
    assert np.log(FACTORS).sum() == pytest.approx(0)


def test_precise_shots_count_more() -> None:
    pigments = np.log([[[0.1, 0.1], [0.2, 0.2]], [[0.1, 0.1], [np.nan, np.nan]]])
    sd = np.array([[[0.1, 1.0], [1.0, 0.1]]] * 2)
    fused = np.exp(fuse(SkinReading(pigments, sd, {})))
    assert fused[0] == pytest.approx([0.1, 0.2], rel=0.02)
    assert fused[1] == pytest.approx([0.1, 0.1])


def test_people_are_fused_with_intervals_that_cover() -> None:
    rng = np.random.default_rng(0)
    truth = np.log(0.05) + 0.5 * rng.standard_normal((4000, 2))
    sd = np.full((4000, 5, 2), 0.2)
    shared = np.sqrt([0.45, 0.65]) * rng.standard_normal((4000, 1, 2))
    own = np.sqrt([0.55, 0.35]) * rng.standard_normal((4000, 5, 2))
    reading = SkinReading(truth[:, None] + sd * (shared + own), sd, {})
    colours = rng.uniform(-9, 9, (4000, 5, 2))
    for index, (fused, correlation) in enumerate(
        zip(fuse_people(reading, colours), (0.45, 0.65), strict=True)
    ):
        assert fused.value == pytest.approx(fuse(reading)[:, index])
        assert 0.89 < measure_coverage(fused, truth[:, index]) < 0.95
        found = correlate_errors(reading.pigments[..., index], sd[..., index], truth[:, index])
        assert found == pytest.approx(correlation, abs=0.03)
    scores = score_fused(reading, colours, truth)
    assert scores["melanin"]["r_log"] > 0.9 and 0.89 < scores["melanin"]["coverage"] < 0.95
    together = fuse_people(reading, np.zeros((4000, 5, 2)))
    assert (together[0].sd >= 0.2 - 1e-9).all()


def test_the_spread_within_people_ignores_that_between_them() -> None:
    rng = np.random.default_rng(0)
    described = 9 * rng.normal(0, 1, (3000, 1, 3)) + rng.normal(0, (0.2, 0.3, 0.4), (3000, 2, 3))
    found = measure_spreads(described)
    assert list(found.values()) == pytest.approx([0.2, 0.3, 0.4], rel=0.05)


def test_angles_are_those_of_the_skin_that_is_read() -> None:
    pigments = np.log([[[0.02, 0.04], [0.2, 0.04]], [[0.05, 0.04], [np.nan, np.nan]]])
    angles = compute_angles(pigments, SkinDecoder())
    assert angles.shape == (2, 2) and np.isnan(angles[1, 1])
    assert angles[0, 0] > angles[1, 0] > angles[0, 1]


def test_grey_world_makes_the_mean_grey() -> None:
    mean = srgb_to_linear(balance_to_grey(astronaut() // 2)).mean((0, 1))
    assert mean == pytest.approx(mean.mean(), rel=0.03)


def test_grey_pictures_keep_their_luminance() -> None:
    grey = remove_colour(astronaut())
    assert (grey == grey[..., :1]).all()
    weights = [0.2126, 0.7152, 0.0722]
    before, after = (srgb_to_linear(one) @ weights for one in (astronaut(), grey))
    assert np.abs(before - after).max() < 0.01


def test_degraded_photographs_are_small_and_differ() -> None:
    shapes = []
    for kind in DEGRADATIONS:
        first, again = (degrade(astronaut(), kind, np.random.default_rng(3)) for _ in range(2))
        assert (first == again).all()
        shapes.append(first.shape)
    assert shapes == [(96, 96, 3), (200, 200, 3)]


def test_a_face_has_places_and_regions() -> None:
    face = find_face(astronaut())
    assert face is not None
    places = measure_places(face)
    assert places.shape == (3 * PLACES,) and np.isfinite(places).mean() > 0.9
    regions = face.find_regions()
    assert set(regions) == set(REGIONS)
    assert all(one.shape == face.crop.shape[:2] and one.any() for one in regions.values())
    assert describe_colour(np.array([0.4, 0.2, 0.1])) == pytest.approx(np.log([2, 0.5, 0.2]))


def test_more_melanin_makes_skin_darker_and_leaves_the_rest(reader: NetworkReader) -> None:
    face = find_face(astronaut())
    assert face is not None
    crop = face.crop
    darker = PigmentEditor(crop, reader)({"melanin": 2.0})
    skin = reader(crop)[0].mask[0].numpy()
    assert darker[skin > 0.9].mean() < 0.95 * crop[skin > 0.9].mean()
    assert (darker[skin < 0.05] == crop[skin < 0.05]).mean() > 0.9


def test_only_the_pigment_changes_in_rendered_faces(tmp_path: Path) -> None:
    settings = RepeatedFaces(
        **{"people": 1, "shots": 2, "changed": 1, "heads": 1, "size": 32, "ict": None},
        geometry=str(tmp_path),
    )
    for name, shots in render_changed(settings, (0.5, 1.0)):
        index = ("melanin", "hemoglobin").index(name)
        change = shots[1].truth - shots[0].truth
        assert change[index] == pytest.approx(np.log(2), rel=0.05)
        assert change[1 - index] == pytest.approx(0, abs=1e-6)
        half, whole = (one.photograph[~one.skin].astype(int) for one in shots)
        assert np.median(abs(half - whole)) <= 2


def test_the_results_have_the_agreed_keys(tmp_path: Path) -> None:
    folder = tmp_path / "congress_pairs"
    folder.mkdir()
    for name in ("london", "congress"):
        (tmp_path / name).mkdir()
    people = [f"p{number}" for number in range(3)]
    small = resize(astronaut(), 256, 256)
    for number, person in enumerate(people):
        for shot, step in (("a", 0), ("b", 8)):
            photo = (small * (1 - 0.15 * number)).astype(np.uint8)[: 150 + step]
            Image.fromarray(photo).save(folder / f"{person}_{shot}.jpg", quality=90)
    with (folder / "index.csv").open("w", newline="") as file:
        rows = csv.writer(file)
        rows.writerow(("person", "first", "second"))
        rows.writerows((one, f"{one}_a.jpg", f"{one}_b.jpg") for one in people)
    settings = RepeatedFaces(
        **{"people": 4, "shots": 2, "changed": 1, "heads": 1, "size": 32, "ict": None},
        geometry=str(tmp_path / "geometry"),
    )
    torch.manual_seed(0)
    found = constancy.measure(folder=tmp_path, synthetic=settings)
    for name in ("melanin", "hemoglobin", "angle"):
        assert {"icc", "within_sd", "between_sd", "icc_interval"} <= set(found["pairs"][name])
    assert {"coverage", "stated_sd"} < set(found["pairs"]["melanin"])
    assert {"uncorrected", "grey_world", "learned_white_balance", "linear_map", "fourth"} == set(
        found["baselines"]
    )
    assert set(found["guards"]) == {"grey", "slope", "slope_by_fourth", "slope_synthetic"}
    assert set(found["captures"]) == {"pairs", "wide"}
    assert set(found["synthetic"]) == {"pairs", "single", "fused2"}
    assert {"coverage", "error_correlation"} < set(found["synthetic"]["fused2"]["melanin"])
