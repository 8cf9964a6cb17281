"""The colour of skin under one light, in a picture by one calibrated camera."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import torch
from jaxtyping import Float, Float32
from torch import Tensor, nn

from skinnet.physics.camera import SpectralCamera
from skinnet.physics.lookup import SkinLookup
from skinnet.physics.reflectance import SkinReflectance

_NODES = (256, 256)
"""Nodes of the look-up table in f_mel and f_blood, as many as inverse rendering uses."""

CHANNELS = ("f_blood", "f_mel", "offset_r", "offset_g", "offset_b")
"""Order of the features of a texel (Equation 9 of Alotaibi & Smith 2017)."""


class SkinColour(nn.Module):
    """Decodes the features of texels to linear RGB: A = i(f_mel, f_blood, e, S) + delta.

    Light, camera and calibration are fixed, so the colours of skin are a look-up table.

    Args:
        matrix: Takes a reflectance spectrum [33], 400 to 720 nm, to linear RGB [3] under the light
            and the camera; None: daylight D65 and the mean of the measured cameras.
        calibration: Colour transform that multiplies this RGB from the left (section 4.3); None:
            the identity.
        optics: Name of a `SkinOptics` preset.
        nodes: Nodes of the look-up table in f_mel and f_blood.
        light: Name of the light, kept in files.
        camera: Name of the camera, kept in files.

    Source:
        Equation 11 of Alotaibi & Smith 2017.

    Example:
        >>> import torch
        >>> colour = SkinColour(nodes=(32, 32))
        >>> features = torch.tensor([0.05, 0.03, 0.0, 0.0, 0.0])[:, None]
        >>> [round(channel, 2) for channel in colour(features)[:, 0].tolist()]
        [0.6, 0.39, 0.34]
    """

    table: Tensor
    lookup: SkinLookup

    def __init__(
        self,
        matrix: Float[np.ndarray, "wavelength 3"] | None = None,
        calibration: Float[np.ndarray, "3 3"] | None = None,
        optics: str = "measured",
        nodes: tuple[int, int] = _NODES,
        light: str = "D65",
        camera: str = "mean",
    ) -> None:
        super().__init__()
        self.matrix = (
            _compute_standard_matrix() if matrix is None else np.asarray(matrix, np.float64)
        )
        self.calibration = np.eye(3) if calibration is None else np.asarray(calibration, np.float64)
        self.optics, self.light, self.camera = optics, light, camera
        self.lookup = SkinLookup(SkinReflectance(optics, dtype=torch.float64), nodes)
        contracted = torch.from_numpy(self.matrix @ self.calibration.T)
        table = self.lookup.colours(contracted[None]).to(torch.get_default_dtype())
        self.register_buffer("table", table, persistent=False)

    def forward(
        self, features: Float[Tensor, "*batch 5 texels"]
    ) -> Float[Tensor, "*batch 3 texels"]:
        """Decode features in the order of `CHANNELS` (Equation 11 of Alotaibi & Smith 2017).

        A fraction outside [0, 1] is clamped, and its gradient is zero. Offsets are added unchanged.

        Args:
            features: Volume fractions of blood and melanosomes, then the linear RGB offset.

        Returns:
            Linear RGB.
        """
        return self.skin(features[..., 1, :], features[..., 0, :]) + features[..., 2:, :]

    def skin(
        self, f_mel: Float[Tensor, "*batch texels"], f_blood: Float[Tensor, "*batch texels"]
    ) -> Float[Tensor, "*batch 3 texels"]:
        """Decode pigments alone, without an offset.

        Args:
            f_mel: Volume fraction of melanosomes; clamped to [0, 1].
            f_blood: Volume fraction of blood; clamped to [0, 1].

        Returns:
            Linear RGB of skin.
        """
        texels = f_mel.shape[-1]
        flat = [fraction.clamp(0, 1).reshape(-1, 1, texels) for fraction in (f_mel, f_blood)]
        table = self.table.to(f_mel).expand(len(flat[0]), -1, -1, -1)
        return self.lookup.sample(table, *flat).reshape(*f_mel.shape[:-1], 3, texels)

    @torch.no_grad()
    def decode(
        self, features: Float32[np.ndarray, "*batch 5 texels"]
    ) -> Float32[np.ndarray, "*batch 3 texels"]:
        """Decode features that are arrays; see `forward`.

        Args:
            features: Volume fractions of blood and melanosomes, then the linear RGB offset.

        Returns:
            Linear RGB.
        """
        decoded: Float32[np.ndarray, "*batch 3 texels"] = self(torch.from_numpy(features)).numpy()
        return decoded

    def to_record(self) -> dict[str, Any]:
        """Describe the light, camera and calibration in JSON's types, for `from_record`.

        Returns:
            The record.
        """
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
        """Make a `SkinColour` from the record that `to_record` gave.

        Args:
            record: The record.

        Returns:
            The light, camera and calibration.

        Raises:
            KeyError: If an entry is missing.
            TypeError: If an entry has another type.
            ValueError: If an entry has another shape or value.
        """
        matrix, calibration = (np.array(record[name], float) for name in ("matrix", "calibration"))
        if matrix.shape != (33, 3) or calibration.shape != (3, 3):
            raise ValueError(f"matrix {matrix.shape} and calibration {calibration.shape}")
        mel, blood = (int(count) for count in record["nodes"])
        names = (str(record[name]) for name in ("light", "camera"))
        return cls(matrix, calibration, str(record["optics"]), (mel, blood), *names)

    @staticmethod
    def share_outside(features: Float[np.ndarray, "*batch 5 texels"]) -> float:
        """Compute the share of texels that have a fraction outside [0, 1].

        Args:
            features: Volume fractions of blood and melanosomes, then the linear RGB offset.

        Returns:
            The share, from 0 to 1.
        """
        fractions = features[..., :2, :]
        return float(((fractions < 0) | (fractions > 1)).any(-2).mean())


def _compute_standard_matrix() -> Float[np.ndarray, "wavelength 3"]:
    camera = SpectralCamera(dtype=torch.float64)
    matrix: Float[np.ndarray, "wavelength 3"] = camera.matrix(camera.standard()).numpy()
    return matrix
