"""The files of one person's maps: numbers, a textured mesh to open elsewhere, and a panel."""

from pathlib import Path

import numpy as np
from jaxtyping import Float32, UInt8
from PIL import Image

from skinnet.appearance.colour import SkinColour
from skinnet.appearance.edit import PigmentEdit, edit_texture
from skinnet.appearance.maps_file import save_maps
from skinnet.appearance.skin_texture import SkinTexture
from skinnet.images.photograph import write_png
from skinnet.images.srgb import linear_to_srgb, to_uint8
from skinnet.inference.panel import BLANK, TILE, draw_grid, draw_picture, draw_pigment_map
from skinnet.mesh.mesh import Mesh
from skinnet.mesh.mesh_file import write_mesh
from skinnet.pipeline.relight import RelightSettings

FLUSH, TAN = 2.0, 1.5
"""Factors of hemoglobin and of melanin in Figure 6."""

UNKNOWN = 0.6
"""Grey albedo of what a scan did not cover, in pictures only."""

_LEVELS = 65535


def write_maps(stem: Path, texture: SkinTexture, colour: SkinColour, face: Mesh) -> list[Path]:
    """Write NAME_maps.npz, NAME_melanin.png, NAME_hemoglobin.png, NAME_face.obj and a panel."""
    files = [stem.with_name(stem.name + end) for end in ENDS]
    maps, melanin, hemoglobin, mesh, panel = files
    save_maps(maps, texture, colour)
    write_fraction(melanin, texture, "f_mel")
    write_fraction(hemoglobin, texture, "f_blood")
    albedo = texture.albedo(colour)
    write_mesh(mesh, textured(face, shown(albedo, texture)))
    write_png(panel, maps_panel(texture, colour, face))
    return files


ENDS = ("_maps.npz", "_melanin.png", "_hemoglobin.png", "_face.obj", "_panel.png")


def textured(face: Mesh, texture: UInt8[np.ndarray, "h w 3"]) -> Mesh:
    """The mesh with a picture over its texture coordinates."""
    return Mesh(face.vertices, face.triangles, face.uv, face.uv_triangles, texture, face.name)


def write_fraction(path: Path, texture: SkinTexture, name: str) -> None:
    """A map as 16-bit PNG in which fraction = scale * pixel; its text says the scale."""
    values = np.where(texture.mask, getattr(texture, name), 0)
    scale = float(values.max()) / _LEVELS or 1.0
    pixels = np.rint(values / scale).astype(np.uint16)
    note = {"map": name, "scale": repr(scale), "offset": "0.0", "unit": "volume fraction"}
    write_png(path, pixels, note)


def shown(
    albedo: Float32[np.ndarray, "size size 3"], texture: SkinTexture
) -> UInt8[np.ndarray, "size size 3"]:
    """An albedo as uint8 sRGB, blank where nothing is known."""
    colours = to_uint8(linear_to_srgb(albedo))
    return np.where(texture.mask[..., None], colours, np.array(BLANK, np.uint8))


def covered(
    albedo: Float32[np.ndarray, "size size 3"], texture: SkinTexture
) -> Float32[np.ndarray, "size size 3"]:
    """An albedo to render with: plaster where nothing is known."""
    return np.where(texture.mask[..., None], albedo, np.float32(UNKNOWN))


def maps_panel(texture: SkinTexture, colour: SkinColour, face: Mesh) -> UInt8[np.ndarray, "h w 3"]:
    """Texture and maps above; the face relit, flushed and tanned below (Figures 4 and 6)."""
    relight = RelightSettings(size=TILE)
    flushed = edit_texture(texture, PigmentEdit(), PigmentEdit(FLUSH))
    tanned = edit_texture(texture, PigmentEdit(TAN), PigmentEdit())
    faces = {
        "relit": texture,
        f"hemoglobin x {FLUSH:g}": flushed,
        f"melanin x {TAN:g}": tanned,
    }
    plain = SkinTexture(
        texture.f_mel, texture.f_blood, np.zeros_like(texture.offset), texture.mask, texture.name
    )
    tiles = [
        draw_picture("texture", shown(texture.albedo(colour), texture)),
        *pigment_tiles(texture),
        draw_picture("skin without offset", shown(plain.albedo(colour), texture)),
        *(
            draw_picture(name, relight.picture(face, covered(one.albedo(colour), one)))
            for name, one in faces.items()
        ),
    ]
    return draw_grid(tiles, 4)


def pigment_tiles(
    texture: SkinTexture, tops: tuple[float | None, float | None] = (None, None)
) -> list[Image.Image]:
    """Tiles of melanin and hemoglobin."""
    mask = texture.mask.astype(np.float64)
    return [
        draw_pigment_map("melanin", texture.f_mel, mask, tops[0]),
        draw_pigment_map("hemoglobin", texture.f_blood, mask, tops[1]),
    ]
