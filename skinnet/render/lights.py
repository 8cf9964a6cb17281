"""Lights, and what of them reaches a surface.

Light is counted as the radiance that a white diffuse surface sends out under it, its irradiance
over pi, so that an albedo times it is what the camera sees.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple, Protocol, runtime_checkable

import numpy as np
from jaxtyping import Float

from skinnet.errors import InputError
from skinnet.mesh.normals import normalise
from skinnet.render.visibility import GeometryBuffers

CONVOLUTION = np.repeat([1, 2 / 3, 1 / 4], [1, 3, 5])
"""A_l / pi, the clamped cosine in spherical harmonics of degree 0, 1 and 2 (Ramamoorthi &
Hanrahan 2001, equation 8), for each of the nine."""


class Arrival(NamedTuple):
    """Irradiance over pi at each hit, and the direction it comes from if it is one."""

    irradiance: Float[np.ndarray, "hits 3"]
    direction: Float[np.ndarray, "3"] | None


@runtime_checkable
class Light(Protocol):
    """Something that lights a surface."""

    def arrive(self, buffers: GeometryBuffers, shadows: bool) -> Arrival:
        """What reaches each hit, less what the mesh itself hides if `shadows`."""
        ...


@dataclass(frozen=True)
class DirectionalLight:
    """A distant light. `direction` points to it, of any length.

    `colour`, one number or three, is the radiance of a white diffuse surface that faces it: its
    irradiance is pi times that. `angle`, its width in degrees, makes shadows soft over `rays` rays
    a pixel.
    """

    direction: tuple[float, float, float] | Float[np.ndarray, "3"]
    colour: float | tuple[float, float, float] | Float[np.ndarray, "3"] = 1.0
    angle: float = 0.0
    rays: int = 32

    def arrive(self, buffers: GeometryBuffers, shadows: bool) -> Arrival:
        """colour max(n . l, 0), times the share of the light that is seen."""
        direction = np.asarray(self.direction, np.float64)
        if not (np.isfinite(direction).all() and direction.any()):
            raise InputError(f"A light's direction has a length; got {self.direction}.")
        direction = normalise(direction)
        cosine = (buffers.normal @ direction).clip(0)
        if shadows:
            cosine = cosine * buffers.lit(direction, self.angle, self.rays)
        colour = np.broadcast_to(np.asarray(self.colour, np.float64), 3)
        return Arrival(cosine[:, None] * colour, direction)


@dataclass(frozen=True)
class SphericalHarmonics:
    """Light from all around: nine coefficients of its radiance, grey [9] or in colour [9, 3].

    Real orthonormal harmonics of the direction (x, y, z) it comes from, in the order of degree and
    order (0, 0), (1, -1), (1, 0), (1, 1), (2, -2) ... (2, 2); a constant radiance L has the first
    coefficient sqrt(4 pi) L. In place of shadows it is dimmed by the share of the sky that a vertex
    sees.
    """

    coefficients: Float[np.ndarray, "9"] | Float[np.ndarray, "9 3"]

    @classmethod
    def project(
        cls, radiance: Callable[[Float[np.ndarray, "points 3"]], Float[np.ndarray, "points 3"]]
    ) -> "SphericalHarmonics":
        """The nine coefficients of any radiance [.., 3] given over unit directions [.., 3]."""
        height, weight = np.polynomial.legendre.leggauss(64)
        angle = np.arange(128) * (2 * np.pi / 128)
        y, turn = np.repeat(height, 128), np.tile(angle, 64)
        ring = np.sqrt(1 - y * y)
        directions = np.stack([ring * np.sin(turn), y, ring * np.cos(turn)], 1)
        area = np.repeat(weight, 128) * (2 * np.pi / 128)
        return cls((evaluate_harmonics(directions) * area[:, None]).T @ radiance(directions))

    @classmethod
    def sky(
        cls, above: tuple[float, float, float], below: tuple[float, float, float]
    ) -> "SphericalHarmonics":
        """Radiance that goes evenly from `below`, straight down, to `above`."""
        top, bottom = np.array(above, np.float64), np.array(below, np.float64)
        coefficients = np.zeros((9, 3))
        coefficients[0] = np.sqrt(4 * np.pi) * (top + bottom) / 2
        coefficients[1] = np.sqrt(4 * np.pi / 3) * (top - bottom) / 2
        return cls(coefficients)

    def irradiance(self, normals: Float[np.ndarray, "points 3"]) -> Float[np.ndarray, "points 3"]:
        """Irradiance over pi of surfaces with these unit normals; never below 0, where nine
        coefficients can take it."""
        coefficients = np.broadcast_to(self.coefficients.reshape(9, -1), (9, 3))
        folded: Float[np.ndarray, "points 3"] = (
            evaluate_harmonics(normals) * CONVOLUTION @ coefficients
        )
        return folded.clip(0)

    def arrive(self, buffers: GeometryBuffers, shadows: bool) -> Arrival:
        """The irradiance, times the share of the sky that is seen."""
        irradiance = self.irradiance(buffers.normal)
        return Arrival(irradiance * buffers.openness()[:, None] if shadows else irradiance, None)


def evaluate_harmonics(directions: Float[np.ndarray, "points 3"]) -> Float[np.ndarray, "points 9"]:
    """The nine real spherical harmonics up to degree 2 of unit directions."""
    x, y, z = directions.T
    one = np.sqrt(3 / (4 * np.pi))
    two = np.sqrt(15 / (4 * np.pi))
    return np.stack(
        [
            np.full_like(x, np.sqrt(1 / (4 * np.pi))),
            *(one * y, one * z, one * x),
            *(two * x * y, two * y * z, np.sqrt(5 / (16 * np.pi)) * (3 * z * z - 1)),
            *(two * x * z, two / 2 * (x * x - y * y)),
        ],
        1,
    )
