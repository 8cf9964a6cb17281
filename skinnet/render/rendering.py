"""Pictures of meshes under lights."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float, Shaped, UInt8

from skinnet.images.srgb import linear_to_srgb, to_uint8
from skinnet.mesh.mesh import Mesh
from skinnet.render._shading import shade
from skinnet.render.lights import Light
from skinnet.render.scene import Scene
from skinnet.render.views import View
from skinnet.render.visibility import trace_geometry

SKIN_SPECULAR = 0.028
"""Reflectance of skin at normal incidence, for a refractive index of 1.4."""


def render(
    mesh: Mesh | Scene,
    albedo: Shaped[np.ndarray, "rows columns 3"] | Float[np.ndarray, "3"],
    lights: Sequence[Light],
    view: View,
    samples: int = 2,
    shadows: bool = True,
    specular: float = 0.0,
    background: tuple[float, float, float] = (1.0, 1.0, 1.0),
) -> UInt8[np.ndarray, "height width 3"]:
    """Render a diffuse mesh, with highlights if asked for, as an sRGB picture.

    It needs no extra renderer and draws a face in a fraction of a second. Its light is linear sRGB;
    for light of a given spectrum see `skinnet.material.MitsubaCapture`.

    Args:
        mesh: A mesh, or a `Scene` of it to share between several pictures.
        albedo: Linear sRGB, a texture for the mesh's texture coordinates or one colour.
        lights: Their contributions are added. Radiance above 1 is clipped.
        view: Where the picture is taken from.
        samples: Samples of a pixel along either side, averaged in linear light.
        shadows: Whether the mesh casts shadows on itself.
        specular: Reflectance of the highlights of directional lights, e.g. `SKIN_SPECULAR`.
        background: Linear sRGB behind the mesh.

    Returns:
        The picture.

    Raises:
        InputError: For an albedo texture and a mesh without texture coordinates.

    Example:
        >>> import numpy as np
        >>> from skinnet.mesh import Mesh
        >>> from skinnet.render import SphericalHarmonics, frame_face, render
        >>> square = np.array([[-1.0, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]])
        >>> mesh = Mesh(square, np.array([[0, 1, 2], [0, 2, 3]]))
        >>> lights = [SphericalHarmonics.sky((1.0, 1.0, 1.0), (1.0, 1.0, 1.0))]
        >>> picture = render(mesh, np.array([1.0, 0.5, 0.0]), lights, frame_face(square, (8, 8)))
        >>> picture[4, 4]
        array([255, 188,   0], dtype=uint8)
    """
    shaded = shade(trace_geometry(mesh, view, samples), albedo, lights, shadows, specular)
    behind = (1 - shaded.alpha)[..., None] * np.array(background)
    return to_uint8(linear_to_srgb(shaded.image + behind))
