"""Lights, and the irradiance of a surface under them.

Irradiance is divided by pi: it is then the radiance of a white diffuse surface, and the radiance of
any diffuse surface is its albedo times that.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np
from jaxtyping import Float

from skinnet.errors import InputError
from skinnet.mesh._vectors import normalise
from skinnet.render._harmonics import COSINE_LOBE, evaluate_harmonics
from skinnet.render.visibility import GeometryBuffers

_Illumination = tuple[Float[np.ndarray, "hits 3"], Float[np.ndarray, "3"] | None]
"""Irradiance over pi at each hit, and the unit vector to the light; None without a direction."""


@runtime_checkable
class Light(Protocol):
    """What `render` needs of a light."""

    def illuminate(self, buffers: GeometryBuffers, shadows: bool) -> _Illumination:
        """Compute the irradiance over pi at each hit.

        Args:
            buffers: The surface.
            shadows: Whether the mesh occludes the light.

        Returns:
            Irradiance over pi, linear sRGB, and the unit vector to the light; None in place of the
            vector for light from all around.
        """
        ...


@dataclass(frozen=True)
class DirectionalLight:
    """A distant light.

    Args:
        direction: Vector to the light, of any length.
        colour: Radiance of a white diffuse surface that faces the light, one number or linear sRGB.
        angle: Angular diameter of the light in degrees; above 0 shadows are soft.
        rays: Shadow rays per pixel for a soft shadow.

    Example:
        >>> import numpy as np
        >>> from skinnet.mesh import Mesh
        >>> from skinnet.render import DirectionalLight, frame_face, trace_geometry
        >>> square = np.array([[-1.0, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]])
        >>> mesh = Mesh(square, np.array([[0, 1, 2], [0, 2, 3]]))
        >>> buffers = trace_geometry(mesh, frame_face(square, (8, 8)))
        >>> irradiance, direction = DirectionalLight((0.0, 3.0, 4.0)).illuminate(buffers, True)
        >>> irradiance[0].round(3), direction
        (array([0.8, 0.8, 0.8]), array([0. , 0.6, 0.8]))
    """

    direction: tuple[float, float, float] | Float[np.ndarray, "3"]
    colour: float | tuple[float, float, float] | Float[np.ndarray, "3"] = 1.0
    angle: float = 0.0
    rays: int = 32

    def illuminate(self, buffers: GeometryBuffers, shadows: bool) -> _Illumination:
        """Compute the irradiance over pi at each hit, colour max(n . l, 0).

        Args:
            buffers: The surface.
            shadows: Whether to multiply it by the visible share of the light.

        Returns:
            Irradiance over pi, linear sRGB, and the unit vector to the light.

        Raises:
            InputError: For a direction of length 0, or one that is not finite.
        """
        direction = np.asarray(self.direction, np.float64)
        if not (np.isfinite(direction).all() and direction.any()):
            raise InputError(
                f"The direction of a light is a finite vector of any length above 0; got "
                f"{self.direction}."
            )
        direction = normalise(direction)
        cosine = (buffers.normal @ direction).clip(0)
        if shadows:
            cosine = cosine * buffers.light_visibility(direction, self.angle, self.rays)
        colour = np.broadcast_to(np.asarray(self.colour, np.float64), 3)
        return cosine[:, None] * colour, direction


@dataclass(frozen=True)
class SphericalHarmonics:
    """Light from all around, as spherical harmonics of its radiance up to degree 2.

    The harmonics are real and orthonormal, of the direction (x, y, z) that the light comes from, in
    the order (0, 0), (1, -1), (1, 0), (1, 1), (2, -2) ... (2, 2) of degree and order. It casts no
    shadows; instead it is multiplied by the sky visibility.

    Args:
        coefficients: Nine coefficients, grey [9] or linear sRGB [9, 3]. For a constant radiance L
            the first is sqrt(4 pi) L and the others are 0.

    Source:
        Ramamoorthi & Hanrahan 2001, "An efficient representation for irradiance environment maps".

    Example:
        >>> import numpy as np
        >>> from skinnet.render import SphericalHarmonics
        >>> sky = SphericalHarmonics.sky((1.0, 1.0, 1.0), (0.0, 0.0, 0.0))
        >>> sky.irradiance(np.array([[0.0, 1, 0], [1, 0, 0]])).round(3)
        array([[0.833, 0.833, 0.833],
               [0.5  , 0.5  , 0.5  ]])
    """

    coefficients: Float[np.ndarray, "9"] | Float[np.ndarray, "9 3"]

    @classmethod
    def project(
        cls, radiance: Callable[[Float[np.ndarray, "points 3"]], Float[np.ndarray, "points 3"]]
    ) -> "SphericalHarmonics":
        """Project any radiance onto the nine harmonics.

        Args:
            radiance: Function of unit directions that gives linear sRGB.

        Returns:
            The light.
        """
        height, weight = np.polynomial.legendre.leggauss(64)
        angle = np.arange(128) * (2 * np.pi / 128)
        y, azimuth = np.repeat(height, 128), np.tile(angle, 64)
        ring = np.sqrt(1 - y * y)
        directions = np.stack([ring * np.sin(azimuth), y, ring * np.cos(azimuth)], 1)
        area = np.repeat(weight, 128) * (2 * np.pi / 128)
        return cls((evaluate_harmonics(directions) * area[:, None]).T @ radiance(directions))

    @classmethod
    def sky(
        cls, above: tuple[float, float, float], below: tuple[float, float, float]
    ) -> "SphericalHarmonics":
        """Make a sky whose radiance changes linearly with height.

        Args:
            above: Radiance from straight above (+y), linear sRGB.
            below: Radiance from straight below.

        Returns:
            The light.
        """
        top, bottom = np.array(above, np.float64), np.array(below, np.float64)
        coefficients = np.zeros((9, 3))
        coefficients[0] = np.sqrt(4 * np.pi) * (top + bottom) / 2
        coefficients[1] = np.sqrt(4 * np.pi / 3) * (top - bottom) / 2
        return cls(coefficients)

    def irradiance(self, normals: Float[np.ndarray, "points 3"]) -> Float[np.ndarray, "points 3"]:
        """Compute the irradiance of surfaces that nothing occludes.

        Args:
            normals: Unit normals of the surfaces.

        Returns:
            Irradiance over pi, linear sRGB. Nine coefficients can describe a light whose
            irradiance is negative somewhere; it is clipped to 0 there.
        """
        coefficients = np.broadcast_to(self.coefficients.reshape(9, -1), (9, 3))
        convolved: Float[np.ndarray, "points 3"] = (
            evaluate_harmonics(normals) * COSINE_LOBE @ coefficients
        )
        return convolved.clip(0)

    def illuminate(self, buffers: GeometryBuffers, shadows: bool) -> _Illumination:
        """Compute the irradiance over pi at each hit.

        Args:
            buffers: The surface.
            shadows: Whether to multiply it by the sky visibility.

        Returns:
            Irradiance over pi, linear sRGB, and None, since the light has no single direction.
        """
        irradiance = self.irradiance(buffers.normal)
        return irradiance * buffers.sky_visibility()[:, None] if shadows else irradiance, None
