"""Errors of other people's models that recover spectra from the same colours.

BioSkin (Aliaga et al. 2023, doi 10.1111/cgf.14887) is run where its code and weights are at hand;
otherwise its published figures are given. Nothing of its code is part of this project.
"""

import contextlib
import importlib
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import torch
from jaxtyping import Float
from torch import Tensor

from benchmarks.report import Results
from skinnet.errors import InputError
from skinnet.physics import WAVELENGTHS, load_light, load_observer, spectrum_to_srgb

PUBLISHED: Results = {
    "bioskin": {"median": 0.0153, "p95": 0.0337, "published": True},
    "six_parameters": {
        "median": 0.0094,
        "p95": 0.0209,
        "ciede2000": {"A": 0.36, "FL11": 0.66, "LED-B3": 0.28},
        "published": True,
    },
}
"""RMSE of spectra that are recovered from linear sRGB under D65, on 300 other spectra of ISSA; and
median colour differences under other lights. The best known has six parameters with a prior, and
their posterior."""

NETWORKS = {"bioskin": "BioSkin", "bioskin_occlusion": "BioSkinAO"}
"""BioSkin's spectral networks by their file names; the second has a factor of occlusion too."""

CODE, WEIGHTS = "bioskin/bioskin.py", "pretrained_models"
SEED, SAMPLES = 0, 2000


def score_peers(
    directory: Path | None,
    rgb: Float[Tensor, "people 3"],
    target: Float[Tensor, "people wavelength"],
) -> Results:
    """Score peers against measured spectra.

    Args:
        directory: Checkout of github.com/facebookresearch/BioSkin with its weights; without it
            the published figures stand, which are of other spectra.
        rgb: Colours of the spectra, linear sRGB under D65, in [0, 1].
        target: Measured reflectance at the bands of `WAVELENGTHS`, in [0, 1]; NaN is left out.

    Returns:
        Median and 95th percentile of the RMSE of each peer; `published` marks figures that were
        not measured here.

    Raises:
        InputError: The directory is no such checkout, or a package that it needs is missing.
    """
    results = dict(PUBLISHED)
    if directory is None:
        return results
    for name, network in NETWORKS.items():
        recovered = recover_with_bioskin(directory, rgb, network)
        errors = (recovered - target).square().nanmean(-1).sqrt()
        median, p95 = errors.quantile(0.5).item(), errors.quantile(0.95).item()
        results[name] = {"median": median, "p95": p95, "published": False}
    return results


def recover_with_bioskin(
    directory: Path, rgb: Float[Tensor, "people 3"], network: str = "BioSkin"
) -> Float[Tensor, "people wavelength"]:
    """Recover spectra from linear sRGB under D65 by BioSkin, on the bands of `WAVELENGTHS`."""
    with contextlib.redirect_stdout(sys.stderr), torch.no_grad():
        model = _load_bioskin(directory, network)
        resample = _make_resampling(model)
        own = rgb.double() @ _fit_own_colours(model, resample)
        spectra: Tensor = model.reconstruct(own.clamp(0, 1).float().flip(-1))[1]
    return spectra.double() @ resample


def _load_bioskin(directory: Path, network: str) -> Any:
    files = (CODE, f"{WEIGHTS}/{network}.json", f"{WEIGHTS}/{network}.pt")
    missing = [file for file in files if not (directory / file).is_file()]
    if missing:
        raise InputError(
            f"{directory} lacks {', '.join(missing)}: --peers takes a checkout of "
            "github.com/facebookresearch/BioSkin with its weights, and no other peer."
        )
    weights = directory / WEIGHTS / network
    return _import_bioskin(directory).BioSkinInference(str(weights), torch.device("cpu"))


def _import_bioskin(directory: Path) -> ModuleType:
    # An earlier import may be of another checkout.
    for name in [name for name in sys.modules if name.split(".")[0] == "bioskin"]:
        del sys.modules[name]
    importlib.invalidate_caches()
    sys.path.insert(0, str(directory))
    try:
        return importlib.import_module("bioskin.bioskin")
    except ImportError as error:
        raise InputError(
            f"BioSkin in {directory} cannot be imported ({error}); install what it imports "
            "(opencv-python-headless and pandas are not among the packages of this project)."
        ) from error
    finally:
        sys.path.remove(str(directory))


def _make_resampling(model: Any) -> Float[Tensor, "channel wavelength"]:
    settings, count = model.model_params, model.visible_range_limit
    grid = settings.wavelength_begin + settings.spectral_resolution * np.arange(count)
    bands = WAVELENGTHS.numpy()
    return torch.tensor(np.array([np.interp(bands, grid, unit) for unit in np.eye(count)]))


def _fit_own_colours(model: Any, resample: Tensor) -> Float[Tensor, "3 3"]:
    # BioSkin's colours are blue, green, red, and those of a light of equal energy without white
    # balance. Its own spectra say which colours of D65 they are; no measured spectrum is used.
    rng = torch.Generator().manual_seed(SEED)
    properties = torch.rand(SAMPLES, model.latent_size, generator=rng)
    spectra, colours, *_ = model.skin_props_to_reflectance(properties)
    d65 = spectrum_to_srgb(load_light("D6504K"), load_observer(), load_observer()).double()
    solution: Tensor
    solution, *_ = torch.linalg.lstsq(spectra.double() @ resample @ d65, colours.double().flip(-1))
    return solution
