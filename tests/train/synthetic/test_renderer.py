"""The twin's pictures are what the physics makes of their truth."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import torch
from kornia.color import rgb_to_linear_rgb
from torch.utils.data import default_collate

from skinnet.network import losses
from skinnet.network.autoencoder import F_BLOOD_MAX, F_MEL_MAX
from skinnet.physics import SkinDecoder, SpectralCamera, load_cameras, to_display
from train.batch import Batch
from train.synthetic import simulated_camera as camera
from train.synthetic.face_painting import paint_skin
from train.synthetic.faces import Lots, SyntheticFaces
from train.synthetic.scene_sampling import MELANIN, WIDE_MELANIN, draw_lot
from train.synthetic.shading import shade

COUNT = 6
PLAIN = {"blur": 0.05, "noise": 0.0, "quality": 0.0, "tone": 0.0, "flip": 0.0}

Lot = dict[str, torch.Tensor]
Made = Callable[..., Batch]


@pytest.fixture(scope="module")
def data(casts: Path) -> SyntheticFaces:
    made = SyntheticFaces(size=32, heads=2, val_heads=1, test_heads=1, geometry=str(casts))
    for stage in ("fit", "test"):
        made.setup(stage)
    return made


@pytest.fixture(scope="module")
def lot(data: SyntheticFaces) -> Lot:
    lots = Lots(data.buffers["train"], "train", COUNT, seed=3)
    drawn: Lot = default_collate([lots[index] for index in range(COUNT)])
    return drawn


@pytest.fixture(scope="module")
def made(data: SyntheticFaces, lot: Lot) -> Made:
    """Renders the lots with some of their numbers changed."""
    return lambda **changes: data.render(lot | changed(lot, changes), "train")


@pytest.fixture
def exact(monkeypatch: pytest.MonkeyPatch) -> None:
    """Lets every camera be the basis's mean, which a capture can say exactly."""
    means = dict.fromkeys(load_cameras(), SpectralCamera().mean)
    monkeypatch.setattr(camera, "load_cameras", lambda: means)


def changed(lot: Lot, changes: dict[str, float]) -> Lot:
    return {name: torch.full_like(lot[name], value) for name, value in changes.items()}


@pytest.mark.usefixtures("exact")
def test_a_picture_is_what_the_decoder_makes_of_its_truth(made: Made) -> None:
    plain = made(**PLAIN)
    assert plain.truth is not None and plain.capture is not None
    again = to_display(SkinDecoder(fast=False).compose(*plain.truth[:5], plain.capture))
    close = (again - plain.photograph).abs().amax(1)
    # The lens blurs a little however sharp it is, and clipped light has no truth.
    assert close.median() < 0.004 and close.quantile(0.9) < 0.03


def test_a_capture_is_close_to_the_measured_camera(
    made: Made, data: SyntheticFaces, lot: Lot
) -> None:
    matrix, capture = camera.pictured(lot, data.decoder.camera, "train")
    f_mel, f_blood = (lot[name][:, None, None] for name in ("f_mel", "f_blood"))
    measured, said = (
        data.decoder.albedo(f_mel, f_blood, one)
        for one in (matrix, data.decoder.camera.matrix(capture))
    )
    assert (measured / said).log().abs().max() < 0.15


def test_truth_is_finite_and_in_range(made: Made) -> None:
    batch = made()
    assert batch.truth is not None and batch.albedo is not None
    assert all(bool(value.isfinite().all()) for value in (*batch.truth, batch.albedo))
    assert 0 < batch.truth.melanin.min() and batch.truth.melanin.max() <= F_MEL_MAX * 1.001
    assert 0 < batch.truth.hemoglobin.min() and batch.truth.hemoglobin.max() <= F_BLOOD_MAX * 1.001
    assert batch.mask.min() >= 0 and batch.mask.max() <= 1
    assert batch.photograph.min() >= 0 and batch.photograph.max() <= 1
    share = batch.mask.mean((1, 2))
    assert share.min() > 0.05 and share.max() < 0.8


def test_what_is_not_skin_has_no_shading(made: Made) -> None:
    batch = made(**PLAIN)
    assert batch.truth is not None
    elsewhere = batch.mask == 0
    assert batch.truth.shading[elsewhere].abs().max() == 0
    linear = rgb_to_linear_rgb(batch.photograph).movedim(1, -1)
    offset = batch.truth.offset.movedim(1, -1)
    assert (offset - linear)[elsewhere].abs().median() < 0.01


def test_albedo_is_the_colour_of_the_skin(made: Made, lot: Lot, data: SyntheticFaces) -> None:
    batch = made(flip=0.0)
    matrix, _ = camera.pictured(lot, data.decoder.camera, "train")
    assert batch.truth is not None and batch.albedo is not None
    again = data.decoder.albedo(batch.truth.melanin, batch.truth.hemoglobin, matrix)
    assert torch.equal(again, batch.albedo)


def test_more_melanin_makes_a_darker_face(made: Made) -> None:
    pale, dark = (made(f_mel=f_mel, metering=0.0) for f_mel in (0.02, 0.2))
    skin = pale.mask > 0.5
    for one, other, where in zip(pale.photograph, dark.photograph, skin, strict=True):
        assert one[:, where].mean() > other[:, where].mean() + 0.05


def test_what_no_lamp_reaches_is_darker(lot: Lot) -> None:
    normal = torch.tensor([0.0, 0, 1])[None, :, None, None].expand(COUNT, -1, 4, 4)
    whole = torch.ones(COUNT, 1, 4, 4)
    seen = torch.full((COUNT, 4, 4), -1)
    bright, dark = (shade(lot, normal, whole, bits, whole) for bits in (seen, seen * 0))
    assert (dark.diffuse < bright.diffuse).all() and (dark.specular < bright.specular).all()
    assert (dark.diffuse > 0).all()


def test_a_mirror_image_has_the_mirrored_truth(made: Made) -> None:
    one, other = made(**PLAIN), made(**(PLAIN | {"flip": 1.0}))
    assert one.truth is not None and other.truth is not None
    for a, b in zip((one.photograph, *one.truth), (other.photograph, *other.truth), strict=True):
        assert torch.equal(a.flip(-1), b)


def test_the_same_index_is_the_same_picture_in_its_split_alone(data: SyntheticFaces) -> None:
    first, again = (Lots(data.buffers["train"], "train", 4, seed=0)[2] for _ in range(2))
    other = Lots(data.buffers["train"], "val", 4, seed=0)[2]
    assert all(np.array_equal(first[name], again[name]) for name in first)
    assert first["f_mel"] != other["f_mel"]


def test_training_alone_sees_the_darkest_and_shiniest_skin(casts: Path) -> None:
    data = SyntheticFaces(64, 4, heads=4, val_heads=4, val_samples=80, geometry=str(casts))
    data.setup("fit")
    lots, fixed = data.stream(20, None).dataset, data.val_dataloader().dataset
    trained, kept = ([some[index] for index in range(80)] for some in (lots, fixed))
    melanin = np.array([one["f_mel"] for one in trained])
    assert melanin.min() < 0.02 and MELANIN[1] < melanin.max() <= WIDE_MELANIN[1]
    assert max(one["f_mel"] for one in kept) <= MELANIN[1]
    shine, usual = (np.mean([one["oil"] for one in some]) for some in (trained, kept))
    assert shine > 1.2 * usual


def test_splits_have_heads_of_their_own(data: SyntheticFaces) -> None:
    heads = [data.buffers[split]["normal"][0] for split in ("train", "val", "test")]
    assert not any(np.array_equal(heads[k], heads[k - 1]) for k in range(3))


def test_the_test_has_cameras_of_its_own() -> None:
    train, val, test = (set(camera.numbers(split)) for split in ("train", "val", "test"))
    assert train == val and not train & test and len(test) == camera.HELD_OUT


def test_white_stays_white_under_a_perfect_balance(lot: Lot) -> None:
    balanced = lot | changed(lot, {"white_balance": 0.0})
    matrix, _ = camera.pictured(balanced, SpectralCamera(), "train")
    white = matrix.sum(-2)
    torch.testing.assert_close(white, torch.ones_like(white), atol=2e-3, rtol=0)


@pytest.mark.parametrize("size", [(17, 40), (32, 32)])
def test_the_camera_keeps_shape_and_range(lot: Lot, size: tuple[int, int]) -> None:
    linear = 1.5 * torch.rand(COUNT, 3, *size, generator=torch.Generator().manual_seed(0))
    coded = lot | {"quality": torch.full((COUNT,), 40.0), "grain": torch.zeros_like(linear)}
    shown = camera.photographed(coded, linear)
    assert shown.shape == linear.shape and shown.min() >= 0 and shown.max() <= 1
    assert torch.equal((shown * 255).round() / 255, shown)


def test_the_tone_curve_rises(lot: Lot) -> None:
    ramp = torch.linspace(0, 1, 64).expand(COUNT, 3, 8, 64)
    toned = camera.toned(lot, ramp)
    assert toned.shape == ramp.shape and (toned.diff(dim=-1) >= -1e-6).all()


def test_paint_covers_shares_of_the_chart(lot: Lot) -> None:
    paint = paint_skin(lot)
    assert paint.cover.min() >= 0 and paint.cover.max() <= 1
    assert paint.paint.min() >= 0 and paint.oil.min() > 0


def test_the_losses_know_the_spread_of_skin_and_its_light(data: SyntheticFaces) -> None:
    lots = Lots(data.buffers["train"], "train", 96, seed=0)
    truth = data.render(default_collate([lots[index] for index in range(96)]), "train").truth
    assert truth is not None
    skin = truth.mask > 0.5
    for values, spread in zip(truth[:2], losses.PIGMENT_SD, strict=True):
        assert values[skin].std().item() == pytest.approx(spread, rel=0.2)
    assert truth.shading[skin].mean().item() == pytest.approx(losses.MEAN_SHADING, rel=0.15)


def test_lots_cover_pale_and_dark_skin_evenly() -> None:
    low, high = np.log(MELANIN)
    drawn = [np.log(draw_lot(np.random.default_rng(n), 2)["f_mel"]) for n in range(100)]
    assert 0.38 < np.mean(np.array(drawn) < (low + high) / 2) < 0.62
