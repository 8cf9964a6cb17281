"""What stands between a texture's colours and the model's: light, camera, and a calibration."""

import json
from collections.abc import Callable
from dataclasses import asdict, dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import torch
from jaxtyping import Float

from skinnet.appearance.colour import SkinColour
from skinnet.calibration.colour_transform import calibrate
from skinnet.calibration.exposure import exposure
from skinnet.errors import InputError
from skinnet.images.srgb import srgb_to_linear
from skinnet.physics.inversion import SkinInverse
from skinnet.physics.optics import SkinOptics
from skinnet.physics.reflectance import SkinReflectance
from skinnet.physics.sources import load_spectrum_to_srgb
from skinnet.pipeline._progress import log

WAYS = ("exposure", "common", "full", "none")
NODES = (256, 256)
FEW = 5
"""Scans below which a full calibration cannot be trusted to have seen all kinds of skin."""

LOOSE = 0.03
"""Relative standard error of a transform that is worth a word."""

SAMPLE = 100_000
"""Colours of all scans together that a calibration of all of them is given."""

Samples = list[Float[np.ndarray, "_ 3"]]
Matrix = Float[np.ndarray, "wavelength 3"]


@dataclass(frozen=True)
class ColourSettings:
    """How colours become pigments (sections 4.3 and 4.4).

    Args:
        light: name of the light of the scans, or a CSV of wavelength in nm and power.
        camera: name of the camera, or a CSV of wavelength in nm and three sensitivities.
        optics: preset of the skin's constants.
        calibration: exposure (one factor a scan), common (one factor for all scans, of one light
            and camera setting), full (the paper's 3 x 3 transform, for scans of all kinds of skin
            in one light), none, or a _calibration.json written before.
        white: sRGB, 0 to 255, of something white or grey in the textures; their colours are divided
            by its tint. Without it they are taken to be balanced.
        f_mel: range of melanin in which is looked.
        f_blood: range of hemoglobin in which is looked.
        refine: go on from the nearest node of the table to a continuous answer; the paper does not.
        seed: of the colours that a calibration looks at.
    """

    light: str = "D65"
    camera: str = "mean"
    optics: str = "calibrated"
    calibration: str = "exposure"
    white: tuple[int, int, int] | None = None
    f_mel: tuple[float, float] = (0.0, 0.43)
    f_blood: tuple[float, float] = (0.0, 0.15)
    refine: bool = True
    seed: int = 0

    def check(self) -> None:
        """Raise `InputError` for names and files that cannot be used, before long work begins."""
        load_spectrum_to_srgb(self.light, self.camera)
        SkinOptics.preset(self.optics)
        self.balance()
        if self.calibration not in WAYS:
            self._from_file([])

    def calibrated(self, samples: Samples) -> "Colours":
        """The calibration of some scans together, each given by its linear RGB colours [n, 3]."""
        samples = [self.balance() * one for one in samples]
        matrix = load_spectrum_to_srgb(self.light, self.camera).numpy()
        ways: dict[str, Callable[[], Calibrated]] = {
            "exposure": lambda: self._exposures(matrix, samples),
            "common": lambda: self._common(matrix, samples),
            "full": lambda: self._full(matrix, samples),
            "none": lambda: Calibrated(np.eye(3), [1.0] * len(samples), {}),
        }
        way = ways.get(self.calibration, lambda: self._from_file(samples))
        found = way()
        log(f"calibration ({self.calibration}): {found.told()}")
        colour = self._colour(matrix, found.transform)
        return Colours(self, colour, found)

    def balance(self) -> Float[np.ndarray, "3"]:
        """What the channels of a texture are multiplied by so that `white` becomes grey."""
        if self.white is None:
            return np.ones(3)
        if not all(0 < value <= 255 for value in self.white):
            raise InputError(f"white is three numbers from 1 to 255; got {list(self.white)}.")
        linear = srgb_to_linear(np.array(self.white, np.uint8))
        return np.asarray(linear[1] / linear, np.float64)

    def _exposures(self, matrix: Matrix, samples: Samples) -> "Calibrated":
        model = self._model_colours(matrix).reshape(-1, 3)
        return Calibrated(np.eye(3), [exposure(one, model, self.seed) for one in samples], {})

    def _common(self, matrix: Matrix, samples: Samples) -> "Calibrated":
        model = self._model_colours(matrix).reshape(-1, 3)
        factor = exposure(self._pooled(samples), model, self.seed)
        return Calibrated(np.eye(3), [factor] * len(samples), {})

    def _pooled(self, samples: Samples) -> Float[np.ndarray, "colours 3"]:
        """Some colours of every scan, as many of each."""
        draw = np.random.default_rng(self.seed)
        most = max(SAMPLE // len(samples), 1)
        return np.concatenate([draw.permutation(one)[:most] for one in samples])

    def _full(self, matrix: Matrix, samples: Samples) -> "Calibrated":
        if len(samples) < FEW:
            log(
                f"{len(samples)} scans hardly show all kinds of skin; the transform they give may "
                "stretch one person over all of them."
            )
        found = calibrate(self._pooled(samples), self._model_colours(matrix), self.seed)
        if found.uncertainty > LOOSE:
            log(
                f"these colours fix the transform to {found.uncertainty:.0%} only, however well "
                "they fit it; take scans of more kinds of skin, or one exposure a scan "
                "(--colour.calibration exposure)."
            )
        log(
            f"the transform is tied to {found.edges} stretches of the edge of the model's colours; "
            "if these skins end inside the range of --colour.f_mel and --colour.f_blood instead, "
            "it is wrong by as much."
        )
        record = {name: value for name, value in asdict(found).items() if name != "transform"}
        return Calibrated(found.transform, [1.0] * len(samples), record)

    def _from_file(self, samples: Samples) -> "Calibrated":
        path = Path(self.calibration)
        try:
            transform = np.array(json.loads(path.read_text(encoding="utf-8"))["transform"], float)
        except (OSError, ValueError, KeyError, TypeError) as error:
            raise InputError(
                f"calibration is exposure, common, full, none, or a .json written by skinnet maps; "
                f"got {self.calibration!r}."
            ) from error
        if transform.shape != (3, 3) or not np.isfinite(transform).all():
            raise InputError(f"{path} has no 3 x 3 transform.")
        return Calibrated(transform, [1.0] * len(samples), {"file": str(path)})

    def _colour(self, matrix: Matrix, transform: Float[np.ndarray, "3 3"]) -> SkinColour:
        return SkinColour(matrix, transform, self.optics, NODES, self.light, self.camera)

    def _model_colours(self, matrix: Matrix) -> Float[np.ndarray, "mel blood 3"]:
        """Colours over the ranges that are looked in, a few thousand."""
        axes = [
            torch.linspace(low**0.5, high**0.5, 64, dtype=torch.float64) ** 2
            for low, high in (self.f_mel, self.f_blood)
        ]
        f_mel, f_blood = (axis.ravel() for axis in torch.meshgrid(*axes, indexing="ij"))
        reflectance = SkinReflectance(self.optics, dtype=torch.float64)
        colours = reflectance(f_mel, f_blood).numpy() @ matrix
        return np.asarray(colours.reshape(*(len(axis) for axis in axes), 3))


@dataclass(frozen=True)
class Calibrated:
    """A transform of the model's colours, and the factor by which each scan's are multiplied."""

    transform: Float[np.ndarray, "3 3"]
    exposures: list[float]
    record: dict[str, Any]

    def told(self) -> str:
        """One line on it."""
        factors = ", ".join(f"{one:.3g}" for one in self.exposures)
        rows = "; ".join(" ".join(f"{value:.3f}" for value in row) for row in self.transform)
        return f"transform [{rows}], colours times {factors}"


@dataclass(frozen=True)
class Colours:
    """A calibrated light and camera, ready to invert colours."""

    settings: ColourSettings
    colour: SkinColour
    found: Calibrated

    @cached_property
    def inverse(self) -> SkinInverse:
        """The look-up from colours to fractions."""
        matrix = torch.from_numpy(self.colour.matrix @ self.colour.calibration.T)
        settings = self.settings
        return self.colour.lookup.inverse(matrix, NODES, settings.f_mel, settings.f_blood)
