"""Fits the preset `measured` and its `SkinPrior` to measured spectra: `python -m tools.fit_skin`.

It takes under a minute on one core. First the constants: least squares on 100 forearms (NIST) and
348 skins of many peoples (ISSA), both of the same total weight, two numbers a spectrum, with the
literature as normal priors. Then the distribution of skins. `--json` prints one JSON object;
`--write` writes `skinnet/physics/tables/prior.json`. Constants are typed into
`skinnet/physics/optics.py` by hand, rounded.
"""

import argparse
import json
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import torch
from jaxtyping import Float
from torch import Tensor

from benchmarks.recovered_spectra import FittedSkin
from benchmarks.skin_spectra import load_forearms, load_issa
from skinnet.files import write_atomically
from skinnet.physics import R_SURFACE, SkinOptics, SkinPrior
from tools.joint_fit import Fit
from tools.prior_fit import fit_prior
from tools.skin_constants import (
    CONSTANTS,
    CONVENTIONS,
    fit_constants,
    make_optics,
    read_constants,
    round_constants,
)

PRIOR_FILE = Path(__file__).parents[1] / "skinnet" / "physics" / "tables" / "prior.json"


def fit_skin(
    forearms: Float[Tensor, "people wavelength"], issa: Float[Tensor, "record wavelength"]
) -> FittedSkin:
    """Fit constants and prior to two sets of measured spectra; missing bands are NaN."""
    constants = read_constants(fit_constants(forearms, issa).shared)
    optics, r_surface = make_optics(constants), constants["r_surface"]
    prior, reference = fit_prior(optics, r_surface, forearms, issa)
    return FittedSkin(optics, r_surface, SkinPrior(prior), SkinPrior(reference))


def describe_constants(fit: Fit) -> list[dict[str, Any]]:
    """List each constant: its prior, its value, its shift, and how far the data narrow it."""
    exact = read_constants(fit.shared)
    rounded = round_constants(exact)
    narrowed = fit.covariance.diagonal().sqrt()
    return [
        {
            "name": one.name,
            "unit": one.unit,
            "prior": one.mean,
            "sd": one.sd,
            "logarithmic": one.logarithmic,
            "value": rounded[one.name],
            "exact": exact[one.name],
            "shift": shift,
            "sd_ratio": ratio,
            "source": one.source,
        }
        for one, shift, ratio in zip(CONSTANTS, fit.shared.tolist(), narrowed.tolist(), strict=True)
    ]


def format_constants(rows: list[dict[str, Any]]) -> Iterator[str]:
    """Format the constants as a table, and then what is convention."""
    yield (
        f"{'constant':10} {'unit':14} {'prior':>8} {'sd':>9} {'value':>9} {'shift/sd':>8} "
        f"{'sd after/before':>15}  source of the prior"
    )
    for row in rows:
        sd = f"ln {row['sd']:g}" if row["logarithmic"] else f"{row['sd']:g}"
        yield (
            f"{row['name']:10} {row['unit']:14} {row['prior']:8.3g} {sd:>9} {row['value']:9.3g} "
            f"{row['shift']:8.2f} {row['sd_ratio']:15.2f}  {row['source']}"
        )
    yield "\nConvention, not data:"
    yield from CONVENTIONS


def round_record(values: Any) -> Any:
    """Round the numbers of a record to five digits."""
    if isinstance(values, dict):
        return {name: round_record(value) for name, value in values.items()}
    if isinstance(values, list):
        return [round_record(value) for value in values]
    return 0.0 if values == 0 else round(values, 4 - math.floor(math.log10(abs(values))))


def main(arguments: list[str] | None = None) -> None:
    """Print the constants, and write the prior where asked."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    parser.add_argument("--write", action="store_true", help=f"write {PRIOR_FILE.name}")
    given = parser.parse_args(arguments)
    torch.set_num_threads(1)
    forearms, issa = load_forearms(), load_issa()
    rows = describe_constants(fit_constants(forearms, issa))
    if given.json:
        print(json.dumps({"constants": rows, "conventions": CONVENTIONS}))
    else:
        print("\n".join(format_constants(rows)))
    if given.write:
        # For the constants as they are typed, not as they were fitted.
        record, _ = fit_prior(SkinOptics(), R_SURFACE, forearms, issa)
        with write_atomically(PRIOR_FILE) as path:
            path.write_text(json.dumps(round_record(record)) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
