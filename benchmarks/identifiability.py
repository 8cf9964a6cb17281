"""What the colour of one pixel can tell of its pigments, under what the twin leaves unknown.

    python -m benchmarks.identifiability [--json]

No picture is drawn: a patch of skin with the twin's own base pigments is seen by its lights,
cameras, white balance and tone curves, in shading of unknown strength under a little gloss, in
eight bits. A network of two layers is trained on 60,000 such colours to give the pigments, and
scored on 10,000 others: about the best that a reader without context can do. `told` is the same
reader that is also given the error of the white balance, as the rest of a picture might. What is
unknown is taken away step by step; RMSE is relative to that of the mean.
"""

from collections.abc import Callable

import numpy as np
import torch
from torch import Tensor, nn
from torch.utils.data import default_collate

from benchmarks.report import Results, main
from skinnet.camera import spectrum_to_srgb
from skinnet.decoder import SkinDecoder
from train.twin.camera import pictured, toned
from train.twin.lot import HEMOGLOBIN, MELANIN, draw_camera, draw_light

DRAWN, SCORED, STEPS, BATCH = 70_000, 10_000, 1500, 4096
GLOSS = 0.02
"""Linear light of gloss over the skin."""

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
    found: Results = {}
    for name, (change, measured) in cases.items():
        seen = colours(change(lot), decoder, measured)
        told = torch.cat([seen, lot["white_balance"]], 1)
        found[name] = {"colour": score(lot, seen), "told": score(lot, told)}
    return found


def draw(count: int) -> Lot:
    """Lots of a patch: pigments, shading, light and camera."""
    rng = np.random.default_rng(0)
    lots = [draw_light(rng) | draw_camera(rng, 1) for _ in range(count)]
    names = ("light", "temperature", "pick", "white_balance", "tone")
    lot = default_collate([{name: np.float32(one[name]) for name in names} for one in lots])
    for name, limits in (("f_mel", MELANIN), ("f_blood", HEMOGLOBIN)):
        lot[name] = torch.from_numpy(np.exp(rng.uniform(*np.log(limits), count))).float()
    lot["shading"] = torch.from_numpy(np.exp(rng.normal(-0.4, 0.5, count))).float()
    return lot


def _even(lot: Lot) -> Lot:
    return lot | {"tone": torch.zeros_like(lot["tone"])}


def _daylight(lot: Lot) -> Lot:
    light = torch.zeros_like(lot["light"])
    light[:, 0] = 1
    return lot | {"light": light, "temperature": torch.full_like(lot["temperature"], 6504.0)}


def colours(lot: Lot, decoder: SkinDecoder, measured: bool) -> Tensor:
    """Log linear sRGB [count, 3] of the patches in eight bits, by measured cameras or the mean."""
    if measured:
        matrix, _ = pictured(lot, decoder.camera, "train")
    else:
        camera = decoder.camera
        red, blue = lot["white_balance"].unbind(-1)
        gain = torch.stack([red, torch.zeros_like(red), blue], -1).exp()
        light = camera.light(lot["light"], lot["temperature"])
        matrix = spectrum_to_srgb(
            light, camera.mean.expand(len(light), -1, -1), camera.observer, gain
        )
    skin = decoder.skin(lot["f_mel"][:, None, None], lot["f_blood"][:, None, None], matrix)
    linear = ((skin[:, :, 0, 0] + GLOSS) * lot["shading"][:, None]).clamp_min(0)
    display = (toned(lot, linear[..., None, None])[..., 0, 0] * 255).round() / 255
    return torch.log(display.clamp_min(0.5 / 255))


def score(lot: Lot, seen: Tensor) -> dict[str, float]:
    """How well a network gives both pigments from what is seen."""
    truth = torch.stack([lot["f_mel"], lot["f_blood"]], 1)
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
