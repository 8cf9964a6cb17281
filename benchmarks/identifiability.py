"""What the colours of a face can tell of its pigments, under what the twin leaves unknown.

    python -m benchmarks.identifiability [--json]

No picture is drawn: patches of skin with the twin's own pigments are seen by its lights, cameras,
white balance and tone curves, in shading of unknown strength under its gloss, in eight bits. A
network of two layers is trained on 60,000 such lots to give the mean pigments, and scored on
10,000 others by the test's cameras: about the best that a reader of colours alone can do. `patch`
sees the base of a skin, `face` its forehead, cheeks, nose, lids, lips and chin, each in shading of
its own. The `told` are also given the error of the white balance, exactly, as the rest of a
picture can only estimate it. What is unknown is taken away step by step; RMSE is relative to that
of the mean.
"""

from collections.abc import Callable

import numpy as np
import torch
from torch import Tensor, nn
from torch.utils.data import default_collate

from benchmarks.report import Results, main
from skinnet.physics import Capture, SkinDecoder, SpectralCamera
from train.synthetic.scene_sampling import (
    HEMOGLOBIN,
    MELANIN,
    draw_camera,
    draw_light,
    draw_regions,
)
from train.synthetic.simulated_camera import pictured, toned

DRAWN, SCORED, STEPS, BATCH = 70_000, 10_000, 1500, 4096
GLOSS = 0.032, 0.38
"""Median gloss of the twin's faces relative to their light, and the spread of its logarithm."""

Lot = dict[str, Tensor]
Change = Callable[[Lot], Lot]


def measure() -> Results:
    """Correlations and relative errors, from all that is unknown to nothing."""
    torch.manual_seed(0)
    lot = draw(DRAWN)
    decoder = SkinDecoder()
    cases: dict[str, tuple[Change, bool]] = {
        "everything_unknown": (lambda lot: lot, True),
        "no_tone_curve": (_even, True),
        "and_daylight_d65": (lambda lot: _daylight(_even(lot)), True),
        "and_mean_camera": (lambda lot: _daylight(_even(lot)), False),
    }
    return {
        name: read(change(lot), decoder, measured) for name, (change, measured) in cases.items()
    }


def read(lot: Lot, decoder: SkinDecoder, measured: bool) -> Results:
    """What readers of a patch and of a face make of a lot, told its white balance and not."""
    found: Results = {}
    for name, some in {"patch": slice(0, 1), "face": slice(1, None)}.items():
        part = lot | {key: lot[key][:, some] for key in ("f_mel", "f_blood", "shading")}
        truth = torch.stack([part["f_mel"].mean(1), part["f_blood"].mean(1)], 1)
        seen = colours(part, decoder, measured)
        told = torch.cat([seen, lot["white_balance"]], 1)
        found |= {name: score(truth, seen), f"{name}_told": score(truth, told)}
    return found


def draw(count: int) -> Lot:
    """Lots of a face: pigments and shading [count, 7] of its base and regions, light and camera."""
    rng = np.random.default_rng(0)
    lots = [draw_light(rng) | draw_camera(rng, 1) | draw_regions(rng) for _ in range(count)]
    names = ("light", "temperature", "pick", "white_balance", "tone")
    lot = default_collate([{name: np.float32(one[name]) for name in names} for one in lots])
    for name, limits, regions in (
        ("f_mel", MELANIN, "melanin_regions"),
        ("f_blood", HEMOGLOBIN, "blood_regions"),
    ):
        base = rng.uniform(*np.log(limits), (count, 1))
        factors = np.stack([one[regions] for one in lots])
        lot[name] = torch.from_numpy(np.exp(np.hstack([base, base + factors]))).float()
    lot["shading"] = torch.from_numpy(np.exp(rng.normal(-0.4, 0.5, (count, 7)))).float()
    lot["gloss"] = torch.from_numpy(np.exp(rng.normal(np.log(GLOSS[0]), GLOSS[1], count))).float()
    return lot


def _even(lot: Lot) -> Lot:
    return lot | {"tone": torch.zeros_like(lot["tone"])}


def _daylight(lot: Lot) -> Lot:
    light = torch.zeros_like(lot["light"])
    light[:, 0] = 1
    return lot | {"light": light, "temperature": torch.full_like(lot["temperature"], 6504.0)}


def colours(lot: Lot, decoder: SkinDecoder, measured: bool) -> Tensor:
    """Log sRGB [count, 3 patches] in eight bits, by measured cameras or the mean."""
    matrix = measured_matrix(lot, decoder.camera) if measured else mean_matrix(lot, decoder.camera)
    skin = decoder.albedo(lot["f_mel"][:, None], lot["f_blood"][:, None], matrix)[:, :, 0]
    linear = (skin + lot["gloss"][:, None, None]) * lot["shading"][:, None]
    display = (toned(lot, linear[:, :, None].clamp_min(0)) * 255).round() / 255
    return torch.log(display.clamp_min(0.5 / 255)).flatten(1)


def measured_matrix(lot: Lot, camera: SpectralCamera) -> Tensor:
    """From spectra to linear sRGB [count, 33, 3], the scored ones by the test's cameras."""
    parts = {"train": slice(None, -SCORED), "test": slice(-SCORED, None)}
    return torch.cat(
        [
            pictured({name: value[part] for name, value in lot.items()}, camera, split)[0]
            for split, part in parts.items()
        ]
    )


def mean_matrix(lot: Lot, camera: SpectralCamera) -> Tensor:
    """From spectra to linear sRGB [count, 33, 3] by the mean of all cameras."""
    mean = torch.zeros(len(lot["light"]), len(camera.basis))
    return camera.matrix(Capture(lot["light"], lot["temperature"], mean, lot["white_balance"]))


def score(truth: Tensor, seen: Tensor) -> dict[str, float]:
    """How well a network gives both pigments [count, 2] from what is seen."""
    guess = fitted(_standard(seen), _standard(truth.log())) * truth.log().std(0)
    guess = (guess + truth.log().mean(0)).exp()[-SCORED:]
    truth = truth[-SCORED:]
    found = {}
    for k, name in enumerate(("melanin", "hemoglobin")):
        both = torch.stack([guess[:, k], truth[:, k]])
        found[f"{name}_r"] = float(torch.corrcoef(both)[0, 1])
        rmse = ((guess[:, k] - truth[:, k]) ** 2).mean().sqrt()
        found[f"{name}_rmse_ratio"] = float(rmse / truth[:, k].std())
    return found


def fitted(seen: Tensor, wanted: Tensor) -> Tensor:
    """What a network says of all, trained on all but the scored."""
    network = nn.Sequential(
        *(nn.Linear(seen.shape[1], 64), nn.SiLU(), nn.Linear(64, 64), nn.SiLU(), nn.Linear(64, 2))
    )
    optimizer = torch.optim.Adam(network.parameters(), 1e-2)
    schedule = torch.optim.lr_scheduler.CosineAnnealingLR(optimizer, STEPS)
    for _ in range(STEPS):
        some = torch.randint(len(seen) - SCORED, (BATCH,))
        optimizer.zero_grad()
        ((network(seen[some]) - wanted[some]) ** 2).mean().backward()
        optimizer.step()
        schedule.step()
    with torch.no_grad():
        said: Tensor = network(seen)
    return said


def _standard(values: Tensor) -> Tensor:
    return (values - values.mean(0)) / values.std(0)


if __name__ == "__main__":
    main(measure, __doc__ or "")
