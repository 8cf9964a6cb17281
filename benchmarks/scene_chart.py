"""A colour chart in the light of a rendered scene, and what it tells of the capture."""

import numpy as np
import torch
from jaxtyping import Float
from kornia.color import rgb_to_linear_rgb
from torch import Tensor

from benchmarks.chart_pictures import load_patches
from skinnet.errors import InputError
from skinnet.inference._references.chart import load_chart
from skinnet.inference._references.chart_reading import ChartReading, read_samples
from skinnet.inference._references.patch_samples import _CLIPPED, PatchSamples
from skinnet.inference._references.tone_curve import ToneCurve
from skinnet.inference.capture_profile import CaptureProfile
from skinnet.physics import SpectralCamera
from train.synthetic.photography.simulated_camera import BRIGHTEST, process, simulate_sensor
from train.synthetic.scene import SceneParameters

_NOISE, _SPREAD = 0.003, 0.01
"""Standard deviation of the error of a patch's mean colour in display sRGB, and the relative spread
of brightness within a patch."""


def read_scene_chart(
    scene: SceneParameters, model: SpectralCamera, split: str, seed: int
) -> CaptureProfile | None:
    """Read the classic chart that is held beside the face in a scene.

    Its light is as much brighter or darker than that on the face as that on the white reference.
    Where its white would be overexposed, it has a darker picture of its own, and the exposure of
    the face is not known.

    Args:
        scene: A batch of one scene, whose exposure does not depend on what is seen.
        model: Statistical model of cameras.
        split: Train, val or test, each with its own cameras.
        seed: Seed of the noise.

    Returns:
        What it tells; None where it is refused.
    """
    camera = scene.camera
    matrix, _ = simulate_sensor(scene.light, camera, model, split)
    light = camera.exposure * camera.known.light_error.exp()
    white = light * matrix[0].sum(0).max()
    gain = white.clamp_max(BRIGHTEST) / white
    patches = torch.from_numpy(load_patches()).to(matrix) @ matrix[0]
    linear = (gain * light * patches).clamp_min(0)
    samples = _sample(process(camera, linear.mT[None, :, None])[0, :, 0].mT, seed)
    try:
        reading = read_samples(samples, load_chart("classic"), "The chart")
    except InputError:
        return None
    return _make_profile(reading, same_exposure=bool(gain == 1))


def _make_profile(reading: ChartReading, same_exposure: bool) -> CaptureProfile:
    told, straight = (
        one if same_exposure else one._replace(exposure=None)
        for one in (reading.capture, reading.linear_capture)
    )
    if reading.tone == ToneCurve():
        return CaptureProfile(told)
    return CaptureProfile(told, straight, reading.tone)


def _sample(display: Float[Tensor, "patches 3"], seed: int) -> PatchSamples:
    noise = np.random.default_rng([seed, 24]).normal(0, _NOISE, tuple(display.shape))
    noisy = (display + torch.from_numpy(noise).to(display)).clamp(0, 1)
    linear = rgb_to_linear_rgb(noisy.mT[None, :, None])[0, :, 0].mT.double().numpy()
    clipped = (linear >= _CLIPPED).any(-1)
    return PatchSamples(linear, np.full(len(linear), _SPREAD), clipped)
