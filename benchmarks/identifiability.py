"""How well colours determine the pigments of a face, for the unknowns of the synthetic renderer.

    python -m benchmarks.identifiability [--json]

Patches of skin have the pigments, lights, cameras, white balances and tone curves of the synthetic
faces, a shading of unknown strength, specular reflection, and eight bits. A network of two layers
is trained on 60,000 such faces to predict the mean pigments, and scored on 10,000 others under the
cameras of the test split. This is about the best that can be reached from colours alone. `patch` is
given the base of a skin. `face` is given its forehead, cheeks, nose, lids, lips and chin, each in a
shading of its own. The rows `patch_told` and `face_told` are also given the exact error of the
white balance, which can only be estimated from the rest of a picture. The unknowns are removed step
by step. RMSE is relative to that of the mean.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import torch
from torch import Tensor, nn
from torch.utils.data import default_collate

from benchmarks.report import Results, main
from skinnet.physics import Capture, SkinDecoder, SpectralCamera
from train.synthetic.photography.simulated_camera import apply_tone_curve, simulate_sensor
from train.synthetic.sampling.face_sampling import HEMOGLOBIN_RANGE, MELANIN_RANGE, sample_regions
from train.synthetic.sampling.scene_sampling import sample_camera, sample_light
from train.synthetic.scene import CameraParameters, LightParameters, map_tensors

SAMPLES, SCORED, STEPS, BATCH = 70_000, 10_000, 1500, 4096
SPECULAR = 0.032, 0.38
"""Median specular reflection of synthetic faces, and the standard deviation of its logarithm."""


class Faces(NamedTuple):
    """Pigments and shading [count, patches], specular reflection [count], light and camera."""

    f_mel: Tensor
    f_blood: Tensor
    shading: Tensor
    specular: Tensor
    light: LightParameters
    camera: CameraParameters


Change = Callable[[Faces], Faces]


def measure() -> Results:
    """Measure correlations and relative errors, from all unknowns to none."""
    torch.manual_seed(0)
    faces = sample_faces(SAMPLES)
    # The ranges of the synthetic renderer's fractions are those of this preset.
    decoder = SkinDecoder("calibrated")
    cases: dict[str, tuple[Change, bool]] = {
        "everything_unknown": (lambda faces: faces, True),
        "no_tone_curve": (_remove_tone_curve, True),
        "and_daylight_d65": (lambda faces: _use_daylight(_remove_tone_curve(faces)), True),
        "and_mean_camera": (lambda faces: _use_daylight(_remove_tone_curve(faces)), False),
    }
    return {
        name: score_networks(change(faces), decoder, measured)
        for name, (change, measured) in cases.items()
    }


def score_networks(faces: Faces, decoder: SkinDecoder, measured: bool) -> Results:
    """Score networks that are given a patch or a face, with and without the white balance."""
    found: Results = {}
    for name, some in {"patch": slice(0, 1), "face": slice(1, None)}.items():
        part = faces._replace(
            f_mel=faces.f_mel[:, some],
            f_blood=faces.f_blood[:, some],
            shading=faces.shading[:, some],
        )
        truth = torch.stack([part.f_mel.mean(1), part.f_blood.mean(1)], 1)
        colours = render_colours(part, decoder, measured)
        with_balance = torch.cat([colours, faces.camera.white_balance], 1)
        found |= {
            name: score_network(truth, colours),
            f"{name}_told": score_network(truth, with_balance),
        }
    return found


def sample_faces(count: int) -> Faces:
    """Sample faces: pigments and shading [count, 7] of base and regions, light and camera."""
    rng = np.random.default_rng(0)
    samples = [
        (sample_light(rng), sample_camera(rng, 1), sample_regions(rng)) for _ in range(count)
    ]
    light, camera = default_collate([sample[:2] for sample in samples])
    pigments = []
    for number, limits in enumerate((MELANIN_RANGE, HEMOGLOBIN_RANGE)):
        base = rng.uniform(*np.log(limits), (count, 1))
        factors = np.stack([regions[number] for _, _, regions in samples])
        pigments.append(torch.from_numpy(np.exp(np.hstack([base, base + factors]))).float())
    shading = torch.from_numpy(np.exp(rng.normal(-0.4, 0.5, (count, 7)))).float()
    specular = np.exp(rng.normal(np.log(SPECULAR[0]), SPECULAR[1], count))
    return Faces(*pigments, shading, torch.from_numpy(specular).float(), light, camera)


def _remove_tone_curve(faces: Faces) -> Faces:
    camera = faces.camera
    return faces._replace(camera=camera._replace(tone=torch.zeros_like(camera.tone)))


def _use_daylight(faces: Faces) -> Faces:
    light = faces.light
    mixture = torch.zeros_like(light.mixture)
    mixture[:, 0] = 1
    temperature = torch.full_like(light.temperature, 6504.0)
    return faces._replace(light=light._replace(mixture=mixture, temperature=temperature))


def render_colours(faces: Faces, decoder: SkinDecoder, measured: bool) -> Tensor:
    """Render log sRGB [count, 3 patches] in eight bits, by measured cameras or the mean."""
    matrix = (
        compute_measured_matrix(faces, decoder.camera)
        if measured
        else compute_mean_matrix(faces, decoder.camera)
    )
    skin = decoder.albedo(faces.f_mel[:, None], faces.f_blood[:, None], matrix)[:, :, 0]
    linear = (skin + faces.specular[:, None, None]) * faces.shading[:, None]
    display = apply_tone_curve(faces.camera.tone, linear[:, :, None].clamp_min(0))
    display = (display * 255).round() / 255
    return torch.log(display.clamp_min(0.5 / 255)).flatten(1)


def compute_measured_matrix(faces: Faces, camera: SpectralCamera) -> Tensor:
    """Compute spectrum-to-sRGB matrices [count, 33, 3]; those scored are of test cameras."""
    matrices = []
    for split, part in {"train": slice(None, -SCORED), "test": slice(-SCORED, None)}.items():
        light, sensor = (
            map_tensors(lambda value, part=part: value[part], record)
            for record in (faces.light, faces.camera)
        )
        matrices.append(simulate_sensor(light, sensor, camera, split)[0])
    return torch.cat(matrices)


def compute_mean_matrix(faces: Faces, camera: SpectralCamera) -> Tensor:
    """Compute spectrum-to-sRGB matrices [count, 33, 3] of the mean camera."""
    light = faces.light
    mean = torch.zeros(len(light.mixture), len(camera.basis))
    balance = faces.camera.white_balance
    return camera.matrix(Capture(light.mixture, light.temperature, mean, balance))


def score_network(truth: Tensor, colours: Tensor) -> dict[str, float]:
    """Score a network that predicts both pigments [count, 2] from colours."""
    guess = fit_network(_standardise(colours), _standardise(truth.log())) * truth.log().std(0)
    guess = (guess + truth.log().mean(0)).exp()[-SCORED:]
    truth = truth[-SCORED:]
    found = {}
    for k, name in enumerate(("melanin", "hemoglobin")):
        both = torch.stack([guess[:, k], truth[:, k]])
        found[f"{name}_r"] = float(torch.corrcoef(both)[0, 1])
        rmse = ((guess[:, k] - truth[:, k]) ** 2).mean().sqrt()
        found[f"{name}_rmse_ratio"] = float(rmse / truth[:, k].std())
    return found


def fit_network(colours: Tensor, target: Tensor) -> Tensor:
    """Train a network on all but the scored samples, and return its predictions for all."""
    network = nn.Sequential(
        *(
            nn.Linear(colours.shape[1], 64),
            nn.SiLU(),
            nn.Linear(64, 64),
            nn.SiLU(),
            nn.Linear(64, 2),
        )
    )
    optimizer = torch.optim.Adam(network.parameters(), 1e-2)
    schedule = torch.optim.lr_scheduler.CosineAnnealingLR(optimizer, STEPS)
    for _ in range(STEPS):
        some = torch.randint(len(colours) - SCORED, (BATCH,))
        optimizer.zero_grad()
        ((network(colours[some]) - target[some]) ** 2).mean().backward()
        optimizer.step()
        schedule.step()
    with torch.no_grad():
        predictions: Tensor = network(colours)
    return predictions


def _standardise(values: Tensor) -> Tensor:
    return (values - values.mean(0)) / values.std(0)


if __name__ == "__main__":
    main(measure, __doc__ or "")
