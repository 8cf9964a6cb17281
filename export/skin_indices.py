"""Write the table of colours and instrument readings of skin that the package carries.

    python -m export.skin_indices

At each pair of fractions of melanin and blood, `skinnet/inference/tables/skin_indices.csv` has the
indices of the spectrum that `SkinPrior` expects of a skin with these pigments, as a
spectrophotometer measures it, and how far people with these pigments differ from it. So reading
photographs needs no torch.
"""

import argparse
import csv
import io
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import torch
from jaxtyping import Float
from numpy.typing import NDArray
from torch import Tensor

from skinnet.files import write_text
from skinnet.inference._index_definitions import (
    compute_erythema_index,
    compute_lab,
    compute_melanin_index,
    compute_typology_angle,
)
from skinnet.inference._index_table import COLUMNS, OPTICS, TABLE
from skinnet.physics import (
    F_BLOOD_RANGE,
    F_MEL_RANGE,
    Nuisance,
    SkinPrior,
    SkinReflectance,
    include_specular,
    load_light,
    load_observer,
    spectrum_to_srgb,
    srgb_to_xyz,
)

TARGET = Path(__file__).parents[1] / "skinnet" / "inference" / "tables" / f"{TABLE}.csv"

LEAST, NODES = (0.006, 0.006), (46, 34)
"""Least fractions of melanin and blood, and the number of nodes, evenly spaced in logarithms."""

SAMPLES, SEED = 512, 0
"""Skins of which the deviations at a node are computed, the same at all nodes; half of them are the
others with the sign changed."""

_HEAD = (
    "# indices of skin of the preset measured under D65, specular reflection included, and how far "
    "people with these pigments differ; python -m export.skin_indices, from SkinReflectance and "
    "SkinPrior (NIST, doi 10.18434/M38597; ISSA, doi 10.6084/m9.figshare.28228571.v4)\n"
)


def main(arguments: Sequence[str] | None = None) -> None:
    """Write the table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("-o", "--output", type=Path, default=TARGET, metavar="FILE")
    output: Path = parser.parse_args(arguments).output
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(COLUMNS)
    writer.writerows([f"{value:.5g}" for value in row] for row in tabulate())
    write_text(output, _HEAD + text.getvalue())


def tabulate() -> NDArray[np.float64]:
    """Compute the rows of the table, melanin the slower."""
    tops = F_MEL_RANGE[1], F_BLOOD_RANGE[1]
    axes = [
        torch.from_numpy(np.geomspace(low, top, count))
        for low, top, count in zip(LEAST, tops, NODES, strict=True)
    ]
    f_mel, f_blood = torch.cartesian_prod(*axes).unbind(-1)
    indices = compute_indices(expect_spectra(f_mel, f_blood))
    parts = zip(f_mel.split(NODES[1]), f_blood.split(NODES[1]), strict=True)
    sampled = np.concatenate([compute_indices(sample_spectra(*part)) for part in parts])
    sd = np.sqrt(np.mean((sampled - indices[:, None]) ** 2, 1))
    values = np.delete(indices, 3, 1)  # the angle is computed from the colour between nodes
    return np.column_stack([f_mel.numpy(), f_blood.numpy(), values, sd])


def compute_indices(spectra: Float[Tensor, "*shape wavelength"]) -> NDArray[np.float64]:
    """Compute L*, a*, b*, typology angle, melanin index and erythema index [*shape, 6]."""
    matrix = spectrum_to_srgb(load_light("D6504K"), load_observer(), load_observer())
    to_xyz = srgb_to_xyz()
    lab = compute_lab((spectra @ matrix @ to_xyz.mT / to_xyz.sum(-1)).numpy())
    reflectance = spectra.numpy()
    others = (f(reflectance) for f in (compute_melanin_index, compute_erythema_index))
    return np.stack([*np.moveaxis(lab, -1, 0), compute_typology_angle(lab), *others], -1)


def expect_spectra(
    f_mel: Float[Tensor, "skin"], f_blood: Float[Tensor, "skin"], prior: SkinPrior | None = None
) -> Float[Tensor, "skin wavelength"]:
    """Compute the spectrum that is expected of a skin with given pigments, specular included."""
    prior = prior or SkinPrior()
    mean, _, _ = prior.condition(f_mel, f_blood)
    return _measure(prior, f_mel, f_blood, mean)


def sample_spectra(
    f_mel: Float[Tensor, "skin"], f_blood: Float[Tensor, "skin"], prior: SkinPrior | None = None
) -> Float[Tensor, "skin sample wavelength"]:
    """Sample spectra of people whose skin has given pigments."""
    prior, rng = prior or SkinPrior(), torch.Generator().manual_seed(SEED)
    mean, covariance, leftover = prior.condition(f_mel, f_blood)
    deviations = torch.stack(list(mean), -1)[:, None] + _sample_normal(covariance, rng)
    nuisance = Nuisance(*deviations.unbind(-1))
    wide = (SAMPLES,)
    f_mel, f_blood = (f[:, None].expand(*f.shape, *wide) for f in (f_mel, f_blood))
    spectra = _measure(prior, f_mel, f_blood, nuisance) + _sample_normal(leftover, rng)
    return spectra.clamp_min(1e-3)


def _measure(prior: SkinPrior, f_mel: Tensor, f_blood: Tensor, nuisance: Nuisance) -> Tensor:
    skin = SkinReflectance(OPTICS, dtype=torch.float64)
    rest = prior.leftover_mean(f_mel, nuisance, f_blood)
    return include_specular(skin.bands(f_mel, f_blood, nuisance)) + rest


def _sample_normal(
    covariance: Float[Tensor, "skin size size"], rng: torch.Generator
) -> Float[Tensor, "skin sample size"]:
    half = torch.randn(SAMPLES // 2, covariance.shape[-1], generator=rng, dtype=covariance.dtype)
    root: Tensor = torch.linalg.cholesky(covariance)
    return torch.cat([half, -half]) @ root.mT


if __name__ == "__main__":
    main()
