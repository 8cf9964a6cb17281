"""The dynamic model: what it promises, what a fit recovers, and its files."""

import itertools
import pickle
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy import ndimage
from skimage.data import astronaut

from skinnet.appearance import BloodSequence, DynamicModel
from skinnet.appearance._dynamic_file import SHIPPED
from skinnet.appearance._local_statistics import measure_local
from skinnet.errors import InputError
from skinnet.images import find_faces
from skinnet.inference import Decomposer, Decomposition

SIDE, SIZE = 64, 32
STATES = (
    *("flush", "pallor", "exertion", "smile", "frown", "surprise", "disgust", "anger", "pulse"),
)


@pytest.fixture(scope="module")
def model() -> DynamicModel:
    return DynamicModel.load()


@pytest.fixture
def rest() -> np.ndarray:
    return make_rest(0, 90, 70)


def make_rest(seed: int, *shape: int) -> np.ndarray:
    """Hemoglobin with smooth and fine structure."""
    noise = np.random.default_rng(seed).standard_normal(shape)
    smooth = ndimage.gaussian_filter(noise, 6)
    return (0.04 * np.exp(0.15 * smooth / smooth.std() + 0.1 * noise)).astype(np.float32)


def draw(column: float, row: float, width: float, size: int) -> np.ndarray:
    """A smooth field with 1 at a place of the chart."""
    x, y = np.meshgrid(*[(np.arange(size) + 0.5) / size] * 2)
    return np.exp(-((x - column) ** 2 + (y - row) ** 2) / (2 * width**2))


TRUE = {"a": (0.8, 0.4, 0.4, 0.3), "b": (-0.5, 0.6, 0.6, -0.4)}
"""Change of mean and place of each cause, and of the spread there."""


def make_sequence(seed: int, lag: float = 0.0, frames: int = 40) -> BloodSequence:
    """A sequence of a known linear model, with noise."""
    rng = np.random.default_rng(seed)
    rest = make_rest(seed, SIDE, SIDE).astype(float)
    times = np.arange(frames) * 0.5
    causes = {name: np.repeat(rng.uniform(0, 1, frames // 8), 8) for name in TRUE}
    local, _ = measure_local(np.log(rest), np.ones_like(rest), 0.03 * SIDE)
    change = np.zeros((frames, SIDE, SIDE))
    for name, (mean, column, row, spread) in TRUE.items():
        amount = causes[name].copy()
        for frame in range(1, frames) if lag else ():
            keep = np.exp(-0.5 / lag)
            amount[frame] = keep * amount[frame - 1] + (1 - keep) * causes[name][frame]
        place = draw(column, row, 0.15, SIDE)
        each = mean * place + spread * place * (np.log(rest) - local)
        change += amount[:, None, None] * each
    noise = 0.01 * rng.standard_normal(change.shape)
    return BloodSequence(rest, rest * np.exp(change + noise), times, causes)


@pytest.fixture(scope="module")
def fitted() -> DynamicModel:
    sequences = [make_sequence(seed) for seed in range(4)]
    return DynamicModel.fit(sequences, seconds={}, size=SIZE)


def test_it_has_the_named_states_and_says_where_they_are_from(model: DynamicModel) -> None:
    assert tuple(model.states) == STATES
    assert {"flush", "pallor", "exertion", "expressions", "origin"} <= {*model.sources}
    assert model.errors["rmse"] < model.errors["rest_rmse"] / 2
    assert "flush" in repr(model)


def test_the_shipped_file_is_small() -> None:
    assert SHIPPED.stat().st_size < 100_000


def test_nothing_changes_at_rest(model: DynamicModel, rest: np.ndarray) -> None:
    for state in STATES:
        assert np.array_equal(model.sample(rest, {state: 0.0}), rest)
    assert np.array_equal(model.sample(rest, {}), rest)


@pytest.mark.parametrize(("state", "sign"), [("flush", 1), ("exertion", 1), ("pallor", -1)])
@pytest.mark.parametrize("shape", [(33, 47), (160, 160)])
def test_more_of_a_state_is_more_of_its_change(
    model: DynamicModel, state: str, sign: int, shape: tuple[int, int]
) -> None:
    rest = make_rest(1, *shape)
    maps = [model.sample(rest, {state: amount}) for amount in (0, 0.3, 0.7, 1)]
    for less, more in itertools.pairwise(maps):
        assert (sign * (more - less) >= 0).all() and sign * (more - less).max() > 0
        assert more.shape == shape and more.dtype == np.float32


def test_it_stays_within_the_range_of_the_skin_model(model: DynamicModel) -> None:
    rest = np.linspace(0, 0.2, 64 * 64, dtype=np.float32).reshape(64, 64)
    for amounts in ({"flush": 1.0, "exertion": 1.0}, {"pallor": 1.0}):
        changed = model.sample(rest, amounts)
        assert (changed >= 0).all() and (changed <= np.maximum(rest, 0.15)).all()


def test_skin_alone_changes(model: DynamicModel, rest: np.ndarray) -> None:
    skin = np.zeros_like(rest)
    skin[:45] = 1
    changed = model.sample(rest, {"flush": 1.0}, skin=skin)
    assert np.array_equal(changed[45:], rest[45:]) and (changed[:45] > rest[:45]).any()


def test_a_flush_is_strongest_on_the_cheeks_and_weak_at_the_mouth(model: DynamicModel) -> None:
    face = find_faces(astronaut())[0]
    flat = np.full((512, 512), 0.03, np.float32)
    changed = model.sample(flat, {"flush": 1.0}, face.landmarks)
    cheek, nose, brow, chin = (
        changed[tuple(face.landmarks[number, ::-1].astype(int))] for number in (50, 4, 151, 164)
    )
    assert cheek > nose > chin > 0.03 and cheek > brow > chin


def test_the_change_follows_the_face(model: DynamicModel) -> None:
    face = find_faces(astronaut())[0]
    flat = np.full((512, 512), 0.03, np.float32)
    half = model.sample(flat[::2, ::2], {"flush": 1.0}, face.landmarks / 2)
    whole = model.sample(flat, {"flush": 1.0}, face.landmarks)
    averaged = whole.reshape(256, 2, 256, 2).mean((1, 3))
    assert np.abs(half - averaged).max() < 0.003


def test_local_distributions_are_matched(fitted: DynamicModel) -> None:
    """Means and deviations in windows are those at rest, moved and stretched as is asked."""
    noise = np.random.default_rng(0).standard_normal((200, 200))
    trend = np.linspace(-0.3, 0.3, 200)
    rest = (0.04 * np.exp(trend + 0.3 * ndimage.gaussian_filter(noise, 1))).astype(np.float32)
    flat = np.ones((SIZE, SIZE), np.float32)
    model = replace(fitted, mean=np.stack([0.4 * flat, flat]), spread=np.stack([0.5 * flat] * 2))
    model = replace(model, landmarks=DynamicModel.load().landmarks)
    changed = model.sample(rest, {"a": 1.0})
    ones, inner = np.ones_like(rest), np.s_[40:-40, 40:-40]
    (mean_0, sd_0), (mean_1, sd_1) = (
        measure_local(np.log(each), ones, 6.0) for each in (rest, changed)
    )
    assert np.abs(mean_1 - mean_0 - 0.4)[inner].max() < 0.03
    assert np.abs(sd_1 / sd_0 - 1.5)[inner].max() < 0.04


def test_a_fit_recovers_a_known_model(fitted: DynamicModel) -> None:
    for index, (name, (mean, column, row, spread)) in enumerate(TRUE.items()):
        assert fitted.names[index] == name
        place = draw(column, row, 0.15, SIZE)
        assert np.abs(fitted.mean[index] - mean * place).max() < 0.05
        assert np.corrcoef(fitted.spread[index].ravel(), spread * place.ravel())[0, 1] > 0.9
        assert fitted.spread[index][place > 0.8].mean() == pytest.approx(spread, abs=0.15)
    assert fitted.errors["r"] > 0.98 and fitted.errors["frames"] == 40
    assert fitted.errors["rmse"] < 0.2 * fitted.errors["rest_rmse"]


def test_a_fit_finds_the_lag() -> None:
    model = DynamicModel.fit([make_sequence(seed, lag=4.0) for seed in range(2)], size=SIZE)
    assert model.seconds.tolist() == [4.0, 4.0]


def test_bad_frames_do_little_harm(fitted: DynamicModel) -> None:
    sequences = [make_sequence(seed) for seed in range(4)]
    for each in sequences:
        each.maps[3, 10:40, 10:40] *= 4
        each.maps[9, 30:] = np.nan
    model = DynamicModel.fit(sequences, seconds={}, size=SIZE)
    assert np.abs(model.mean - fitted.mean).max() < 0.05


def test_amounts_are_found_again(fitted: DynamicModel) -> None:
    sequence = make_sequence(9)
    found = fitted.explain(sequence, ["a", "b"])
    for name, amounts in found.items():
        assert np.abs(amounts - sequence.coefficients[name]).max() < 0.1
        assert (amounts >= 0).all() and (amounts <= 1).all()
    sequence.maps[3] = np.nan
    assert not any(amounts[3] for amounts in fitted.explain(sequence, ["a", "b"]).values())


def test_flush_and_pallor_do_not_cancel(model: DynamicModel) -> None:
    rest = make_rest(2, 96, 96)
    maps = np.stack([model.sample(rest, each) for each in ({}, {"flush": 0.6}, {"pallor": 0.4})])
    sequence = BloodSequence(rest, maps, np.arange(3.0), {})
    found = model.explain(sequence, ["flush", "pallor"])
    assert found["flush"].tolist() == pytest.approx([0, 0.6, 0], abs=0.05)
    assert found["pallor"].tolist() == pytest.approx([0, 0, 0.4], abs=0.05)


def test_time_brings_lag_and_pulse(model: DynamicModel, rest: np.ndarray) -> None:
    steady = model.sample(rest, {"flush": 0.5})
    assert np.array_equal(model.sample(rest, {"flush": 0.5}, time=0.0), rest)
    early, late = (model.sample(rest, {"flush": 0.5}, time=time) for time in (2.0, 500.0))
    assert rest.mean() < early.mean() < late.mean() and np.allclose(late, steady, rtol=1e-5)
    beats = [model.sample(rest, {"pulse": 1.0}, time=time, rate=60).mean() for time in (0, 0.3, 1)]
    assert beats[0] == pytest.approx(beats[2]) and beats[1] > 1.01 * beats[0]
    course = model.follow({"flush": np.array([0, 1.0, 1.0])}, np.array([0, 8.0, 16.0]))
    assert course["flush"].tolist() == pytest.approx([0, 1 - np.exp(-1), 1 - np.exp(-2)])
    with pytest.raises(InputError, match="one for each of the 3 times"):
        model.follow({"flush": np.zeros(2)}, np.arange(3.0))


@pytest.mark.parametrize(
    ("amounts", "sentence"),
    [
        ({"flus": 0.5}, "no state 'flus'; it has flush, pallor"),
        ({"flush": 1.1}, r"from 0 \(at rest\) to 1 .*; got 1.1"),
        ({"flush": -0.1}, "got -0.1"),
        ({"flush": float("nan")}, "got nan"),
    ],
)
def test_amounts_that_cannot_be_are_refused(
    model: DynamicModel, rest: np.ndarray, amounts: dict[str, float], sentence: str
) -> None:
    with pytest.raises(InputError, match=sentence):
        model.sample(rest, amounts)


def test_maps_of_other_shapes_are_refused(model: DynamicModel) -> None:
    with pytest.raises(InputError, match="is a map"):
        model.sample(np.ones(5, np.float32), {"flush": 0.5})


def test_files_hold_all_of_it(fitted: DynamicModel, tmp_path: Path) -> None:
    path = tmp_path / "a.npz"
    named = replace(fitted, states={"both": {"a": 1.0, "b": 0.5}}, sources={"both": "ours"})
    named.save(path)
    found = DynamicModel.load(path)
    for name in ("mean", "spread", "landmarks", "seconds"):
        assert np.array_equal(getattr(found, name), getattr(named, name))
        assert getattr(found, name).dtype == np.float32
    for name in ("names", "states", "sources", "errors", "window"):
        assert getattr(found, name) == getattr(named, name)
    found.save(tmp_path / "b.npz")
    with np.load(path) as one, np.load(tmp_path / "b.npz") as other:
        assert all(np.array_equal(one[name], other[name]) for name in one)


def test_files_that_are_none_are_refused(fitted: DynamicModel, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="There is no file"):
        DynamicModel.load(tmp_path / "absent.npz")
    text = tmp_path / "text.npz"
    text.write_text("no model")
    with pytest.raises(InputError, match="is not a complete file of skinnet's"):
        DynamicModel.load(text)
    path = tmp_path / "a.npz"
    fitted.save(path)
    path.write_bytes(path.read_bytes()[:-200])
    with pytest.raises(InputError, match="is not a complete file of skinnet's"):
        DynamicModel.load(path)
    with pytest.raises(InputError, match=r"does not end in \.npz"):
        fitted.save(tmp_path / "a.json")


@pytest.mark.parametrize(
    "change",
    [
        {"mean": np.zeros((2, 4, 4), np.float32)},
        {"landmarks": np.zeros((3, 2), np.float32)},
        {"seconds": np.array([np.nan, 0], np.float32)},
        {"states": {"c": {"c": 1.0}}},
        {"states": {"c": {"a": float("nan")}}},
        {"window": float("inf")},
        {"names": ()},
    ],
)
def test_arrays_that_do_not_match_are_refused(
    fitted: DynamicModel, tmp_path: Path, change: dict[str, object]
) -> None:
    replace(fitted, **change).save(tmp_path / "a.npz")  # type: ignore[arg-type]
    with pytest.raises(InputError, match="is not a complete file"):
        DynamicModel.load(tmp_path / "a.npz")


def test_photographs_take_a_state(model: DynamicModel, tmp_path: Path) -> None:
    photo, decomposer = astronaut()[:256, 90:346], Decomposer()
    change = pickle.loads(pickle.dumps(model.change({"flush": 1.0})))
    flushed = decomposer.edit(photo, state=change)
    redness = [each[..., 0].astype(int) - each[..., 1] for each in (photo, flushed)]
    cheek = tuple(find_faces(photo)[0].landmarks[50, ::-1].astype(int))
    assert redness[1][cheek] - redness[0][cheek] > 5
    assert np.array_equal(flushed[:20], photo[:20])
    assert np.array_equal(decomposer.edit(photo, state=model.change({"flush": 0.0})), photo)
    face = decomposer(photo)
    face.save(tmp_path / "face.npz")
    for one in (face, Decomposition.load(tmp_path / "face.npz")):
        assert np.array_equal(one.edit(state=change), flushed)
    both = decomposer.edit(photo, hemoglobin=0.5, state=change)
    assert not np.array_equal(both, flushed)


def test_it_needs_neither_torch_nor_jaxtyping() -> None:
    code = (
        "import sys; from skinnet.appearance import DynamicModel; DynamicModel.load()\n"
        "assert not {'torch', 'jaxtyping', 'trimesh'} & {*sys.modules}"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
