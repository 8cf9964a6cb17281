"""What stands between a texture's colours and the model's: light, camera, and a calibration."""

import json
import re
from collections.abc import Callable
from dataclasses import asdict, dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import torch
from jaxtyping import Float

from skinnet.appearance.colour import SkinColour
from skinnet.calibration._exposure import fit_exposure
from skinnet.calibration._model_colours import tabulate_model_colours
from skinnet.calibration.colour_transform import calibrate
from skinnet.errors import InputError, _check_count
from skinnet.files._reading import MOST_TEXT, read_file
from skinnet.images.srgb import srgb_to_linear
from skinnet.inference._messages import log
from skinnet.physics.inversion import SkinInverse, _check_axis
from skinnet.physics.optics import SkinOptics
from skinnet.physics.sources import load_spectrum_to_srgb

_LIGHT_WORDS = {"daylight": "D65", "flash": "D5500K", "tungsten": "A", "incandescent": "A"}
"""Lights by the names that photographers give them, as of `Capture.from_names`."""

_KELVIN = re.compile(r"\d{4,5}\s*k")

_WAYS = ("exposure", "common", "full", "none")
_NODES = (256, 256)
_FEW_SCANS = 5
"""Scans below which a full calibration is unlikely to have seen all kinds of skin."""

_UNCERTAIN = 0.03
"""Relative uncertainty of a transform above which the log says so."""

_MAX_COLOURS = 100_000
"""Colours of all scans together that one calibration is given."""

_Samples = list[Float[np.ndarray, "_ 3"]]
_Matrix = Float[np.ndarray, "wavelength 3"]


@dataclass(frozen=True)
class ColourSettings:
    """How colours become pigments (sections 4.3 and 4.4).

    Args:
        light: light of the scans, named as for photographs (D65, 5500K, flash, LED-B3), or a CSV
            of wavelength in nm and power.
        camera: name of the camera, or a CSV of wavelength in nm and three sensitivities.
        optics: preset of the skin's constants.
        calibration: exposure (one factor a scan), common (one factor for all scans, of one light
            and camera setting), full (the paper's 3 x 3 transform, for scans of all kinds of skin
            in one light), none, or a _calibration.json written before.
        white: sRGB, 0 to 255, of something white or grey in the textures; their colours are divided
            by its tint. Without it they are taken to be balanced.
        f_mel: range of melanin of the look-up table.
        f_blood: range of hemoglobin of the look-up table.
        refine: refine the nearest node of the table to a continuous answer; the paper does not.
        seed: seed of the subsample of colours that a calibration uses.
    """

    light: str = "D65"
    camera: str = "mean"
    optics: str = "measured"
    calibration: str = "exposure"
    white: tuple[int, int, int] | None = None
    f_mel: tuple[float, float] = (0.0, 0.43)
    f_blood: tuple[float, float] = (0.0, 0.15)
    refine: bool = True
    seed: int = 0

    @property
    def light_name(self) -> str:
        """The light by the name that `load_light` knows."""
        folded = self.light.strip().casefold()
        if _KELVIN.fullmatch(folded):
            return f"D{folded}"
        return _LIGHT_WORDS.get(folded, self.light)

    def check(self) -> None:
        """Raise `InputError` for names and files that cannot be used, before long work begins."""
        _check_count("seed", self.seed)
        for name in ("f_mel", "f_blood"):  # as the table does, which is made after the fits
            _check_axis(name, *getattr(self, name))
        load_spectrum_to_srgb(self.light_name, self.camera)
        SkinOptics.preset(self.optics)
        self.balance()
        if self.calibration not in _WAYS:
            self._read_transform([])

    def calibrate(self, samples: _Samples) -> "CalibratedColours":
        """Calibrate some scans together.

        Args:
            samples: Linear RGB colours of each scan.

        Returns:
            The calibrated colours, ready to be inverted.

        Raises:
            InputError: The colours do not determine the calibration that is asked for.
        """
        samples = [self.balance() * one for one in samples]
        matrix = load_spectrum_to_srgb(self.light_name, self.camera).numpy()
        ways: dict[str, Callable[[], _ScanCalibration]] = {
            "exposure": lambda: self._fit_exposures(matrix, samples),
            "common": lambda: self._fit_common_exposure(matrix, samples),
            "full": lambda: self._fit_transform(matrix, samples),
            "none": lambda: _ScanCalibration(np.eye(3), [1.0] * len(samples), {}),
        }
        way = ways.get(self.calibration, lambda: self._read_transform(samples))
        calibration = way()
        log(f"calibration ({self.calibration}): {calibration.describe()}")
        colour = self._make_colour(matrix, calibration.transform)
        return CalibratedColours(self, colour, calibration)

    def balance(self) -> Float[np.ndarray, "3"]:
        """Compute the factors of the channels of a texture that make `white` grey.

        Returns:
            Factors [3], relative to green; ones without `white`.

        Raises:
            InputError: `white` has a value outside 1 to 255.
        """
        if self.white is None:
            return np.ones(3)
        if not all(0 < value <= 255 for value in self.white):
            raise InputError(f"white is three numbers from 1 to 255; got {list(self.white)}.")
        linear = srgb_to_linear(np.array(self.white, np.uint8))
        return np.asarray(linear[1] / linear, np.float64)

    def _fit_exposures(self, matrix: _Matrix, samples: _Samples) -> "_ScanCalibration":
        model = self._tabulate_model(matrix).reshape(-1, 3)
        return _ScanCalibration(
            np.eye(3), [fit_exposure(one, model, self.seed) for one in samples], {}
        )

    def _fit_common_exposure(self, matrix: _Matrix, samples: _Samples) -> "_ScanCalibration":
        model = self._tabulate_model(matrix).reshape(-1, 3)
        factor = fit_exposure(self._pool(samples), model, self.seed)
        return _ScanCalibration(np.eye(3), [factor] * len(samples), {})

    def _pool(self, samples: _Samples) -> Float[np.ndarray, "colours 3"]:
        """Sample the same number of colours of every scan."""
        rng = np.random.default_rng(self.seed)
        count = max(_MAX_COLOURS // len(samples), 1)
        return np.concatenate([rng.permutation(one)[:count] for one in samples])

    def _fit_transform(self, matrix: _Matrix, samples: _Samples) -> "_ScanCalibration":
        if len(samples) < _FEW_SCANS:
            log(
                f"{len(samples)} scans hardly show all kinds of skin; the transform that fits them "
                "may be wrong for others."
            )
        found = calibrate(self._pool(samples), self._tabulate_model(matrix), self.seed)
        if found.uncertainty > _UNCERTAIN:
            log(
                f"these colours determine the transform only to {found.uncertainty:.0%}, however "
                "well it fits them; take scans of more kinds of skin, or one exposure a scan "
                "(--colour.calibration exposure)."
            )
        record = {name: value for name, value in asdict(found).items() if name != "transform"}
        return _ScanCalibration(found.transform, [1.0] * len(samples), record)

    def _read_transform(self, samples: _Samples) -> "_ScanCalibration":
        path = Path(self.calibration)
        try:
            transform = np.array(json.loads(read_file(path, MOST_TEXT))["transform"], float)
        except (OSError, ValueError, KeyError, TypeError) as error:
            raise InputError(
                f"calibration is exposure, common, full, none, or a .json written by skinnet maps; "
                f"got {self.calibration!r}."
            ) from error
        if transform.shape != (3, 3) or not np.isfinite(transform).all():
            raise InputError(f"{path} has no 3 x 3 transform.")
        return _ScanCalibration(transform, [1.0] * len(samples), {"file": str(path)})

    def _make_colour(self, matrix: _Matrix, transform: Float[np.ndarray, "3 3"]) -> SkinColour:
        return SkinColour(matrix, transform, self.optics, _NODES, self.light_name, self.camera)

    def _tabulate_model(self, matrix: _Matrix) -> Float[np.ndarray, "mel blood 3"]:
        return tabulate_model_colours(matrix, self.optics, self.f_mel, self.f_blood)


@dataclass(frozen=True)
class _ScanCalibration:
    """A transform of the model's colours, and the factor by which each scan's are multiplied."""

    transform: Float[np.ndarray, "3 3"]
    exposures: list[float]
    record: dict[str, Any]

    def describe(self) -> str:
        """Describe it in one line."""
        factors = ", ".join(f"{one:.3g}" for one in self.exposures)
        rows = "; ".join(" ".join(f"{value:.3f}" for value in row) for row in self.transform)
        return f"transform [{rows}], colours times {factors}"


@dataclass(frozen=True)
class CalibratedColours:
    """A calibrated light and camera, ready to invert colours.

    Attributes:
        settings: What was asked for.
        colour: From fractions to colours, with the transform.
        calibration: The transform, and the exposure of each scan.
    """

    settings: ColourSettings
    colour: SkinColour
    calibration: _ScanCalibration

    @cached_property
    def inverse(self) -> SkinInverse:
        """The look-up from colours to fractions."""
        matrix = torch.from_numpy(self.colour.matrix @ self.colour.calibration.T)
        settings = self.settings
        return self.colour.lookup.inverse(matrix, _NODES, settings.f_mel, settings.f_blood)
