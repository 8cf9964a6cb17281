"""Pictures of the synthetic renderer are what the physics makes of their truth."""

import pytest
import torch
from kornia.color import rgb_to_linear_rgb
from torch.utils.data import default_collate

from skinnet.network import losses
from skinnet.network.autoencoder import F_BLOOD_MAX, F_MEL_MAX
from skinnet.physics import SkinDecoder, SpectralCamera, load_cameras, to_display
from train.batch import Batch
from train.synthetic.faces import SyntheticFaces, SyntheticScenes
from train.synthetic.photography import simulated_camera
from train.synthetic.scene import SceneParameters

PLAIN = {"blur": 0.05, "noise": 0.0, "quality": 0.0, "tone": 0.0, "mirror": 0.0}
"""A camera that changes linear light as little as it can."""


@pytest.fixture
def exact(monkeypatch: pytest.MonkeyPatch) -> None:
    """Lets every sensor be the basis's mean, which a capture can describe exactly."""
    means = dict.fromkeys(load_cameras(), SpectralCamera().mean)
    monkeypatch.setattr(simulated_camera, "load_cameras", lambda: means)


def render(data: SyntheticFaces, scene: SceneParameters, **camera: float) -> Batch:
    """Render with some of the camera's numbers changed."""
    changed = {
        name: torch.full_like(getattr(scene.camera, name), value) for name, value in camera.items()
    }
    return data.render(scene._replace(camera=scene.camera._replace(**changed)), "train")


def with_melanin(scene: SceneParameters, fraction: float) -> SceneParameters:
    melanin = scene.face.skin.melanin
    melanin = melanin._replace(fraction=torch.full_like(melanin.fraction, fraction))
    return scene._replace(face=scene.face._replace(skin=scene.face.skin._replace(melanin=melanin)))


@pytest.mark.usefixtures("exact")
def test_a_picture_is_what_the_decoder_makes_of_its_truth(
    data: SyntheticFaces, scene: SceneParameters
) -> None:
    plain = render(data, scene, **PLAIN)
    assert plain.truth is not None and plain.capture is not None
    again = to_display(SkinDecoder(fast=False).compose(*plain.truth[:5], plain.capture))
    close = (again - plain.photograph).abs().amax(1)
    # The lens blurs a little however sharp it is, and clipped light has no truth.
    assert close.median() < 0.004 and close.quantile(0.9) < 0.03


def test_truth_is_finite_and_in_range(data: SyntheticFaces, scene: SceneParameters) -> None:
    batch = render(data, scene)
    assert batch.truth is not None and batch.albedo is not None
    assert all(bool(value.isfinite().all()) for value in (*batch.truth, batch.albedo))
    assert 0 < batch.truth.melanin.min() and batch.truth.melanin.max() <= F_MEL_MAX * 1.001
    assert 0 < batch.truth.hemoglobin.min() and batch.truth.hemoglobin.max() <= F_BLOOD_MAX * 1.001
    assert batch.mask.min() >= 0 and batch.mask.max() <= 1
    assert batch.photograph.min() >= 0 and batch.photograph.max() <= 1
    share = batch.mask.mean((1, 2))
    assert share.min() > 0.05 and share.max() < 0.8


def test_what_is_not_skin_has_no_shading(data: SyntheticFaces, scene: SceneParameters) -> None:
    batch = render(data, scene, **PLAIN)
    assert batch.truth is not None
    background = batch.mask == 0
    assert batch.truth.shading[background].abs().max() == 0
    linear = rgb_to_linear_rgb(batch.photograph).movedim(1, -1)
    offset = batch.truth.offset.movedim(1, -1)
    assert (offset - linear)[background].abs().median() < 0.01


def test_albedo_is_the_colour_of_the_skin(data: SyntheticFaces, scene: SceneParameters) -> None:
    batch = render(data, scene, mirror=0.0)
    camera = data.decoder.camera
    matrix, _ = simulated_camera.simulate_sensor(scene.light, scene.camera, camera, "train")
    assert batch.truth is not None and batch.albedo is not None
    again = data.decoder.albedo(batch.truth.melanin, batch.truth.hemoglobin, matrix)
    assert torch.equal(again, batch.albedo)


def test_more_melanin_makes_a_darker_face(data: SyntheticFaces, scene: SceneParameters) -> None:
    pale, dark = (render(data, with_melanin(scene, f_mel), metering=0.0) for f_mel in (0.02, 0.2))
    skin = pale.mask > 0.5
    for one, other, where in zip(pale.photograph, dark.photograph, skin, strict=True):
        assert one[:, where].mean() > other[:, where].mean() + 0.05


def test_a_mirror_image_has_the_mirrored_truth(
    data: SyntheticFaces, scene: SceneParameters
) -> None:
    one = render(data, scene, **PLAIN)
    other = render(data, scene, **(PLAIN | {"mirror": 1.0}))
    assert one.truth is not None and other.truth is not None
    for a, b in zip((one.photograph, *one.truth), (other.photograph, *other.truth), strict=True):
        assert torch.equal(a.flip(-1), b)


def test_the_losses_have_the_spread_of_skin_and_light(data: SyntheticFaces) -> None:
    scenes = SyntheticScenes(data.buffers["train"], "train", 96, seed=0)
    batch = default_collate([scenes[index] for index in range(96)])
    truth = data.render(batch, "train").truth
    assert truth is not None
    skin = truth.mask > 0.5
    for values, spread in zip(truth[:2], losses.PIGMENT_SD, strict=True):
        assert values[skin].std().item() == pytest.approx(spread, rel=0.2)
    assert truth.shading[skin].mean().item() == pytest.approx(losses.MEAN_SHADING, rel=0.15)
