"""The colour of skin under one light, as seen by one calibrated camera."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import torch
from jaxtyping import Float, Float32
from torch import Tensor, nn

from skinnet.physics.camera import SpectralCamera
from skinnet.physics.lookup import SkinLookup
from skinnet.physics.reflectance import SkinReflectance

NODES = (256, 256)
"""Nodes of the table in f_mel and f_blood: those of the inverse rendering."""

CHANNELS = ("f_blood", "f_mel", "offset_r", "offset_g", "offset_b")
"""Order of the features of a texel (equation 9)."""


class SkinColour(nn.Module):
    """Features of texels to linear RGB: A = i(f_mel, f_blood, e, S) + delta (equation 11).

    `matrix` [33, 3] takes a spectrum to linear RGB under the light and the camera, and
    `calibration` [3, 3] multiplies that RGB from the left (section 4.3); both are fixed, so skin is
    a table of colours. By default the light is D65 and the camera the mean of those measured.
    `optics` is a preset's name. `light` and `camera` are names for the record.
    """

    table: Tensor
    lookup: SkinLookup

    def __init__(
        self,
        matrix: Float[np.ndarray, "wavelength 3"] | None = None,
        calibration: Float[np.ndarray, "3 3"] | None = None,
        optics: str = "calibrated",
        nodes: tuple[int, int] = NODES,
        light: str = "D65",
        camera: str = "mean",
    ):
        super().__init__()
        self.matrix = _standard() if matrix is None else np.asarray(matrix, np.float64)
        self.calibration = np.eye(3) if calibration is None else np.asarray(calibration, np.float64)
        self.optics, self.light, self.camera = optics, light, camera
        self.lookup = SkinLookup(SkinReflectance(optics, dtype=torch.float64), nodes)
        contracted = torch.from_numpy(self.matrix @ self.calibration.T)
        table = self.lookup.colours(contracted[None]).to(torch.get_default_dtype())
        self.register_buffer("table", table, persistent=False)

    def forward(
        self, features: Float[Tensor, "*batch 5 texels"]
    ) -> Float[Tensor, "*batch 3 texels"]:
        """Linear RGB of features in the order of `CHANNELS`.

        A fraction outside [0, 1] counts as the nearer of the two, and its gradient is zero;
        `outside` says for how many texels. Offsets are added as they are.
        """
        return self.skin(features[..., 1, :], features[..., 0, :]) + features[..., 2:, :]

    def skin(
        self, f_mel: Float[Tensor, "*batch texels"], f_blood: Float[Tensor, "*batch texels"]
    ) -> Float[Tensor, "*batch 3 texels"]:
        """Linear RGB of skin alone."""
        texels = f_mel.shape[-1]
        flat = [fraction.clamp(0, 1).reshape(-1, 1, texels) for fraction in (f_mel, f_blood)]
        table = self.table.to(f_mel).expand(len(flat[0]), -1, -1, -1)
        return self.lookup.sample(table, *flat).reshape(*f_mel.shape[:-1], 3, texels)

    @torch.no_grad()
    def decode(
        self, features: Float32[np.ndarray, "*batch 5 texels"]
    ) -> Float32[np.ndarray, "*batch 3 texels"]:
        """`forward` for arrays."""
        decoded: Float32[np.ndarray, "*batch 3 texels"] = self(torch.from_numpy(features)).numpy()
        return decoded

    def to_record(self) -> dict[str, Any]:
        """What JSON can hold of it, for `from_record`."""
        return {
            "optics": self.optics,
            "light": self.light,
            "camera": self.camera,
            "nodes": list(self.lookup.nodes),
            "matrix": self.matrix.tolist(),
            "calibration": self.calibration.tolist(),
        }

    @classmethod
    def from_record(cls, record: Mapping[str, Any]) -> "SkinColour":
        """The one that was recorded. Raises `KeyError`, `TypeError` or `ValueError` for others."""
        matrix, calibration = (np.array(record[name], float) for name in ("matrix", "calibration"))
        if matrix.shape != (33, 3) or calibration.shape != (3, 3):
            raise ValueError(f"matrix {matrix.shape} and calibration {calibration.shape}")
        mel, blood = (int(count) for count in record["nodes"])
        names = (str(record[name]) for name in ("light", "camera"))
        return cls(matrix, calibration, str(record["optics"]), (mel, blood), *names)


def outside(features: Float[np.ndarray, "*batch 5 texels"]) -> float:
    """Share of texels with a fraction outside [0, 1]."""
    fractions = features[..., :2, :]
    return float(((fractions < 0) | (fractions > 1)).any(-2).mean())


def _standard() -> Float[np.ndarray, "wavelength 3"]:
    camera = SpectralCamera(dtype=torch.float64)
    matrix: Float[np.ndarray, "wavelength 3"] = camera.matrix(camera.standard()).numpy()
    return matrix
