"""Calibrates the uncertainty of a trained model: `python -m train.calibrate MODEL -o MODEL`.

On synthetic validation faces in wide captures, half of which tell something of their capture, the
standard deviations of pixels and of faces are scaled so that 90 % of the errors lie within the 90 %
intervals, in each of six groups of the faces' true melanin. The factors depend on the melanin that
is read. The share of the pixels' own variance that remains in the mean of a region is measured on
squares of an eighth of the picture.
"""

import argparse
import sys
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import NamedTuple

import torch
import torch.nn.functional as F
from jaxtyping import Float
from torch import Tensor

from skinnet.errors import InputError
from skinnet.network import SkinAutoencoder
from skinnet.network._means import log_fraction, log_mean
from skinnet.network._tone_factors import find_factors, measure_tone
from train.batch import Batch
from train.residuals import Residuals, join_residuals
from train.synthetic.faces import SyntheticFaces

_LEAST_SKIN = 0.9
"""Share of a square that is skin, for the square to count as a region."""


class Evidence(NamedTuple):
    """Residuals of pixels, faces and regions; a region's deviation is its pixels' root mean."""

    pixel: Residuals
    face: Residuals
    region: Residuals
    region_face: Float[Tensor, "2 count"]


@torch.no_grad()
def calibrate(model: SkinAutoencoder, batches: Iterable[Batch]) -> None:
    """Set `sd_scale`, `sd_by_tone` and `region_share` of a model, in place.

    Args:
        model: A trained model.
        batches: Rendered pictures that training did not see.
    """
    model.sd_scale.fill_(1)
    model.sd_by_tone.fill_(0)
    found = join([collect_evidence(model, batch) for batch in batches])
    scales, by_tone = zip(*(one.find_scale() for one in (found.pixel, found.face)), strict=True)
    model.sd_scale.copy_(torch.stack(scales))
    model.sd_by_tone.copy_(torch.stack(by_tone))
    factors = find_factors(found.region.tone, model.sd_scale, model.sd_by_tone)
    pixel, face = factors[0] * found.region.deviation, factors[1] * found.region_face
    excess = (pixel**2 - face**2).clamp_min(0)
    observed = _squash(found.region.error) - face**2
    model.region_share.copy_(((observed * excess).sum(1) / (excess**2).sum(1)).clamp(0, 1))


def _squash(error: Float[Tensor, "2 count"]) -> Float[Tensor, "2 count"]:
    """Squared errors, of which those beyond four median errors count as four."""
    most = 4 * error.abs().median(dim=1, keepdim=True).values
    return error.abs().minimum(most) ** 2


def collect_evidence(model: SkinAutoencoder, batch: Batch) -> Evidence:
    """Compare what a model states with the truth of rendered pictures."""
    assert batch.truth is not None
    maps, _, uncertainty = model.encode(batch.photograph, batch.known)
    mask, skin = batch.mask, batch.mask > 0.5
    pairs = list(zip(maps[:2], batch.truth[:2], strict=True))
    error = torch.stack([log_fraction(a) - log_fraction(b) for a, b in pairs])
    spread = torch.stack(uncertainty[:2])
    means = [log_mean(a, mask) - log_mean(b, mask) for a, b in pairs]
    tones = torch.stack(
        [measure_tone(maps.melanin, maps.mask), log_mean(batch.truth.melanin, mask)]
    )
    shown = skin.sum((-2, -1)) > 50
    pixel = tones[:, :, None, None].expand(-1, *skin.shape)[:, skin][:, ::97]
    return Evidence(
        Residuals(error[:, skin][:, ::97], spread[:, skin][:, ::97], *pixel),
        Residuals(torch.stack(means)[:, shown], uncertainty.face.mT[:, shown], *tones[:, shown]),
        *_collect_regions(error, spread, skin, torch.cat([tones, uncertainty.face.mT])),
    )


def _collect_regions(
    error: Tensor, spread: Tensor, skin: Tensor, of_faces: Float[Tensor, "4 batch"]
) -> tuple[Residuals, Tensor]:
    """Residuals of squares of skin, and the deviations of their faces.

    `of_faces` holds both tones of each face, and both of its deviations.
    """
    side = skin.shape[-1] // 8
    whole = F.avg_pool2d(skin[:, None].float(), side)[:, 0] > _LEAST_SKIN
    mean_error = F.avg_pool2d(error, side)[:, whole]
    mean_spread = F.avg_pool2d(spread**2, side).sqrt()[:, whole]
    own = of_faces[:, :, None, None].expand(-1, -1, *whole.shape[1:])[:, whole]
    return Residuals(mean_error, mean_spread, *own[:2]), own[2:]


def join(parts: Sequence[Evidence]) -> Evidence:
    """Join the evidence of several batches."""
    return Evidence(
        join_residuals([part.pixel for part in parts]),
        join_residuals([part.face for part in parts]),
        join_residuals([part.region for part in parts]),
        torch.cat([part.region_face for part in parts], 1),
    )


def main(argv: Sequence[str] | None = None) -> int:
    """Calibrate a model.

    Args:
        argv: Arguments of the command; None means those of the process.

    Returns:
        The exit code, 2 for bad input.
    """
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("model", type=Path, help=".safetensors, or .ckpt of training")
    parser.add_argument("-o", "--output", type=Path, required=True, help=".safetensors to write")
    parser.add_argument("--ict", help="ICT-FaceKit's model as .npz")
    parser.add_argument("--geometry", default="runs/geometry", help="Folder of the cast heads.")
    parser.add_argument("--heads", type=int, default=64, help="Heads of the validation set.")
    parser.add_argument("--samples", type=int, default=768, help="Pictures.")
    given = parser.parse_args(argv)
    try:
        _check_counts(given.heads, given.samples)
        model = SkinAutoencoder.from_pretrained(given.model)
        calibrate(model, render_faces(model, given))
        model.save_pretrained(given.output)
    except InputError as error:
        print(error, file=sys.stderr)
        return 2
    print(
        f"{given.output}: scales {model.sd_scale.tolist()}, regions {model.region_share.tolist()}"
    )
    return 0


def _check_counts(heads: int, samples: int) -> None:
    if min(heads, samples) < 1:
        raise InputError(
            f"Calibration needs a head and a picture or more; got --heads {heads} and --samples "
            f"{samples}."
        )


def render_faces(model: SkinAutoencoder, given: argparse.Namespace) -> Iterable[Batch]:
    """Render the validation faces."""
    data = SyntheticFaces(
        model.config.working_size,
        val_heads=given.heads,
        val_samples=given.samples,
        ict=given.ict,
        geometry=given.geometry,
        optics=model.config.optics,
        captures="wide",
    )
    data.setup("validate")
    return (data.render(scenes, "val") for scenes in data.val_dataloader())


if __name__ == "__main__":
    sys.exit(main())
