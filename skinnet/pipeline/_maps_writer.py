"""Writer of one person's maps: numbers, pictures, a textured mesh and a panel."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from jaxtyping import Float32, UInt8
from PIL import Image

from skinnet.appearance.colour import SkinColour
from skinnet.appearance.edit import PigmentEdit, edit_texture
from skinnet.appearance.maps_file import save_maps
from skinnet.appearance.skin_texture import SkinTexture
from skinnet.images._png_file import write_png
from skinnet.images.srgb import linear_to_srgb, to_uint8
from skinnet.inference._tiles import (
    BLANK,
    draw_grid,
    draw_picture,
    draw_pigment_map,
)
from skinnet.mesh.mesh import Mesh
from skinnet.mesh.mesh_file import write_mesh
from skinnet.pipeline import relight
from skinnet.pipeline._output import MAPS_END, add_end
from skinnet.pipeline._source import Source
from skinnet.render.scene import Scene

_FLUSH, _TAN = 2.0, 1.5
"""Factors of hemoglobin and of melanin in Figure 6 of Alotaibi & Smith 2017."""

_UNKNOWN_ALBEDO = 0.6
"""Grey albedo of texels that a scan does not cover, in pictures only."""

_LEVELS = 65535
"""Largest number in a 16-bit PNG."""

MAPS_ENDS = (MAPS_END, "_melanin.png", "_hemoglobin.png", "_face.obj", "_panel.png")
"""Ends of the names of the files that `write_maps` writes."""


def write_maps(
    stem: Path, texture: SkinTexture, colour: SkinColour, face: Mesh, source: Source
) -> list[Path]:
    """Write NAME_maps.npz, NAME_melanin.png, NAME_hemoglobin.png, NAME_face.obj and a panel."""
    marks = {part: source.make_mark("maps", part).to_text() for part in ("map", "face", "panel")}
    files = [add_end(stem, end) for end in MAPS_ENDS]
    maps, melanin, hemoglobin, mesh, panel = files
    save_maps(maps, texture, colour, source.describe("maps", "maps", stem.parent))
    write_fraction(melanin, texture, "f_mel", marks["map"])
    write_fraction(hemoglobin, texture, "f_blood", marks["map"])
    albedo = texture.albedo(colour)
    write_mesh(mesh, add_texture(face, show_albedo(albedo, texture)), marks["face"])
    write_png(panel, draw_maps_panel(texture, colour, face), marks["panel"])
    return files


def add_texture(face: Mesh, texture: UInt8[np.ndarray, "h w 3"]) -> Mesh:
    """Put a picture over the texture coordinates of a mesh."""
    return Mesh(face.vertices, face.triangles, face.uv, face.uv_triangles, texture, face.name)


def write_fraction(path: Path, texture: SkinTexture, name: str, text: Mapping[str, str]) -> None:
    """Write a map to a 16-bit PNG with fraction = scale * pixel; a text chunk holds the scale."""
    values = np.where(texture.mask, getattr(texture, name), 0)
    scale = float(values.max()) / _LEVELS or 1.0
    pixels = np.rint(values / scale).astype(np.uint16)
    note = {"map": name, "scale": repr(scale), "offset": "0.0", "unit": "volume fraction"}
    write_png(path, pixels, note | dict(text))


def show_albedo(
    albedo: Float32[np.ndarray, "size size 3"], texture: SkinTexture
) -> UInt8[np.ndarray, "size size 3"]:
    """Convert an albedo to uint8 sRGB, blank where it is unknown."""
    colours = to_uint8(linear_to_srgb(albedo))
    return np.where(texture.mask[..., None], colours, np.array(BLANK, np.uint8))


def fill_albedo(
    albedo: Float32[np.ndarray, "size size 3"], texture: SkinTexture
) -> Float32[np.ndarray, "size size 3"]:
    """Fill the unknown texels of an albedo with grey, to render it."""
    return np.where(texture.mask[..., None], albedo, np.float32(_UNKNOWN_ALBEDO))


def draw_maps_panel(
    texture: SkinTexture, colour: SkinColour, face: Mesh
) -> UInt8[np.ndarray, "h w 3"]:
    """Draw the texture and its maps above, and the face relit, flushed and tanned below.

    The panel follows Figures 4 and 6 of Alotaibi & Smith 2017.
    """
    settings, scene = relight.RelightSettings(size=relight.TILE_SIZE), Scene(face)
    flushed = edit_texture(texture, colour, PigmentEdit(), PigmentEdit(_FLUSH))
    tanned = edit_texture(texture, colour, PigmentEdit(_TAN), PigmentEdit())
    faces = {
        "relit": texture,
        f"hemoglobin x {_FLUSH:g}": flushed,
        f"melanin x {_TAN:g}": tanned,
    }
    plain = SkinTexture(
        texture.f_mel, texture.f_blood, np.zeros_like(texture.offset), texture.mask, texture.name
    )
    tiles = [
        draw_picture("texture", show_albedo(texture.albedo(colour), texture)),
        *draw_pigments(texture),
        draw_picture("skin without offset", show_albedo(plain.albedo(colour), texture)),
        *(
            draw_picture(name, settings.render(scene, fill_albedo(one.albedo(colour), one)))
            for name, one in faces.items()
        ),
    ]
    return draw_grid(tiles, 4)


def draw_pigments(texture: SkinTexture) -> list[Image.Image]:
    """Draw tiles of melanin and hemoglobin."""
    mask = texture.mask.astype(np.float64)
    return [
        draw_pigment_map("melanin", texture.f_mel, mask),
        draw_pigment_map("hemoglobin", texture.f_blood, mask),
    ]
