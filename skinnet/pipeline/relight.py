"""Lights and camera of the faces that a command renders."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float32, UInt8

from skinnet.errors import InputError
from skinnet.inference._tiles import TILE
from skinnet.mesh.mesh import Mesh
from skinnet.render.lights import DirectionalLight, Light, SphericalHarmonics
from skinnet.render.rendering import SKIN_SPECULAR, render
from skinnet.render.scene import Scene
from skinnet.render.views import frame_face

TILE_SIZE = TILE
"""Pixels along a side of the faces on panels and figures."""

Direction = tuple[float, float, float]


@dataclass(frozen=True)
class RelightSettings:
    """Lights and camera of a rendered face.

    Args:
        lamps: Direction to each distant lamp (x to the face's left, y up, z forward).
        strengths: Radiance of a white surface that faces the lamp, for each lamp.
        width: Angular diameter of the lamps in degrees; 0 gives hard shadows.
        above: Radiance of the sky straight above.
        below: Radiance of the sky straight below.
        harmonics: Nine spherical-harmonic coefficients of grey light that replaces the sky.
        shadows: Whether the face casts shadows on itself.
        gloss: Whether the skin has highlights.
        yaw: Angle in degrees by which the camera moves around to the face's left.
        pitch: Angle in degrees by which the camera moves up.
        size: Pixels along a side of the picture.

    Raises:
        InputError: If the strengths do not match the lamps, the harmonics are not nine, or the size
            is out of range.

    Example:
        >>> len(RelightSettings(lamps=((0.0, 0.0, 1.0),), strengths=(1.0,)).lights())
        2
    """

    lamps: tuple[Direction, ...] = ((-0.45, 0.55, 0.75),)
    strengths: tuple[float, ...] = (0.75,)
    width: float = 6.0
    above: float = 0.55
    below: float = 0.2
    harmonics: tuple[float, ...] | None = None
    shadows: bool = True
    gloss: bool = True
    yaw: float = 0.0
    pitch: float = 0.0
    size: int = 600

    def __post_init__(self) -> None:
        if len(self.lamps) != len(self.strengths):
            raise InputError(
                f"There are {len(self.lamps)} lamps and {len(self.strengths)} strengths; give one "
                "strength for each lamp."
            )
        if self.harmonics is not None and len(self.harmonics) != 9:
            raise InputError(
                f"harmonics are nine coefficients, degrees 0 to 2; got {len(self.harmonics)}."
            )
        if not 16 <= self.size <= 8192:
            raise InputError(f"size is a number of pixels from 16 to 8192; got {self.size}.")

    def lights(self) -> Sequence[Light]:
        """Make the lamps and the sky.

        Returns:
            The lights for `render`.
        """
        lamps = [
            DirectionalLight(direction, strength, self.width)
            for direction, strength in zip(self.lamps, self.strengths, strict=True)
        ]
        if self.harmonics is not None:
            return [*lamps, SphericalHarmonics(np.array(self.harmonics))]
        return [*lamps, SphericalHarmonics.sky((self.above,) * 3, (self.below,) * 3)]

    def render(
        self, mesh: Mesh | Scene, albedo: Float32[np.ndarray, "size size 3"]
    ) -> UInt8[np.ndarray, "h w 3"]:
        """Render a face.

        Args:
            mesh: The face, upright, its front towards +z, with texture coordinates; or a `Scene` of
                it, to share between several pictures.
            albedo: Linear RGB over the texture coordinates.

        Returns:
            The picture, uint8 sRGB.
        """
        vertices = mesh.mesh.vertices if isinstance(mesh, Scene) else mesh.vertices
        view = frame_face(vertices, (self.size, self.size), self.yaw, self.pitch)
        gloss = SKIN_SPECULAR if self.gloss else 0.0
        grey = (0.75, 0.75, 0.75)
        return render(mesh, albedo, self.lights(), view, 2, self.shadows, gloss, background=grey)
