"""Six skin tones, and how each looks with less and with more melanin or blood.

    python -m examples.tones [-o demo/tones.png] [--size 300]

One measured skin stands for each group of the typology angle, that of ISSA's spectra which is
nearest to the mean colour of its group. Its colour under D65 is inverted to melanin, blood and the
offset that they leave; a synthetic face gets these, times the pattern of its texture. Brows, lashes
and whatever else is not skin keep their colours. A row shows one skin, a column one edit. A caption
in brackets marks an edit that leads beyond the fractions of skin.
"""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from benchmarks.edits import compute_lab, invert_colours, load_colours, make_colour
from examples._command import check_number, check_picture, run, write_picture
from examples.lightstage import paint_person
from skinnet.appearance import PigmentEdit, SkinColour, SkinTexture, edit_texture
from skinnet.images import resize
from skinnet.inference._tiles import draw_grid, draw_picture
from skinnet.mesh import Mesh
from skinnet.physics import F_BLOOD_RANGE, F_MEL_RANGE
from skinnet.pipeline import RelightSettings
from skinnet.render import Scene
from skinnet.shape import load_shape_model

TARGET = Path("demo/tones.png")
ANGLES = (55, 41, 28, 10, -30)
"""Typology angles in degrees that part very light, light, intermediate, tan, brown and dark."""

GROUPS = ("very light", "light", "intermediate", "tan", "brown", "dark")
EDITS = (
    *(("melanin", factor) for factor in (1, 0.4, 0.7, 1.5, 2, 4)),
    *(("blood", factor) for factor in (0.25, 0.5, 2, 4)),
)
MOST = F_MEL_RANGE[1], F_BLOOD_RANGE[1]
"""Largest fractions of melanin and blood that skin is taken to have."""

PATTERN = 3
"""Number of the synthetic person whose freckles, lips and cheeks all six share."""


def choose_skins(colour: SkinColour) -> list[tuple[float, float, NDArray[np.float32]]]:
    """Choose one measured skin of each group: f_mel, f_blood and offset, palest first."""
    colours = load_colours()
    lab, skins = compute_lab(colours), invert_colours(colours, colour)
    angle = np.degrees(np.arctan2(lab[:, 0] - 50, lab[:, 2]))
    group = np.searchsorted(-np.array(ANGLES), -angle)
    maps = [one[skins.mask] for one in (skins.f_mel, skins.f_blood, skins.offset)]
    chosen = []
    for number in range(len(GROUPS)):
        members = np.flatnonzero(group == number)
        distances = np.linalg.norm(lab[members] - lab[members].mean(0), axis=1)
        nearest = members[distances.argmin()]
        chosen.append((float(maps[0][nearest]), float(maps[1][nearest]), maps[2][nearest]))
    return chosen


class Face:
    """A synthetic face that wears any skin.

    Args:
        texels: Texels along a side of its texture.
        size: Pixels along a side of its pictures.
        colour: Light and camera of the skin.
    """

    def __init__(self, texels: int, size: int, colour: SkinColour) -> None:
        painted = paint_person(PATTERN, 25, texels)
        self.cover = painted["cover"][..., None]
        self.paint = np.moveaxis(painted["paint"], 0, -1)
        bare = painted["cover"] < 0.01
        self.melanin, self.blood = (
            painted[name] / np.median(painted[name][bare]) for name in ("f_mel", "f_blood")
        )
        self.colour, self.light = colour, RelightSettings(size=size)
        self.scene = Scene(_build_head())

    def wear(self, f_mel: float, f_blood: float, offset: NDArray[np.float32]) -> SkinTexture:
        """Make the texture of a skin whose typical texel has these fractions."""
        melanin, blood = (
            (pattern * fraction).clip(0, 1).astype(np.float32)
            for pattern, fraction in ((self.melanin, f_mel), (self.blood, f_blood))
        )
        whole = np.broadcast_to(offset, (*melanin.shape, 3)).astype(np.float32)
        return SkinTexture(melanin, blood, whole, np.ones(melanin.shape, bool))

    def draw(self, texture: SkinTexture) -> NDArray[np.uint8]:
        """Render the face with a texture of skin."""
        skin = texture.albedo(self.colour).clip(0, 1)
        albedo = (1 - self.cover) * skin + self.cover * self.paint
        return self.light.render(self.scene, np.ascontiguousarray(albedo, np.float32))


def _build_head() -> Mesh:
    """Build the procedural head in its mean shape."""
    model = load_shape_model()
    return model.build_mesh(np.zeros(len(model.variances)))


def draw_sheet(
    texels: int, size: int, edits: Sequence[tuple[str, float]] = EDITS
) -> NDArray[np.uint8]:
    """Draw six rows of skins with a column for each edit, at half the size of the tiles."""
    colour = make_colour("measured")
    face, tiles = Face(texels, size, colour), list[Image.Image]()
    for name, skin in zip(GROUPS, choose_skins(colour), strict=True):
        texture = face.wear(*skin)
        print(f"{name:12} melanin {skin[0]:.3f}, blood {skin[1]:.3f}")
        for pigment, factor in edits:
            edit, none = PigmentEdit(float(factor)), PigmentEdit()
            pair = (edit, none) if pigment == "melanin" else (none, edit)
            edited = edit_texture(texture, colour, *pair)
            tiles.append(draw_picture(_caption(name, pigment, factor, skin), face.draw(edited)))
    sheet = draw_grid(tiles, len(edits))
    return resize(sheet, sheet.shape[1] // 2, sheet.shape[0] // 2)


def _caption(
    name: str, pigment: str, factor: float, skin: tuple[float, float, NDArray[np.float32]]
) -> str:
    if factor == 1:
        return name
    caption = f"{pigment} x {factor:g}"
    f_mel, f_blood, _ = skin
    beyond = factor * f_mel > MOST[0] if pigment == "melanin" else factor * f_blood > MOST[1]
    return f"({caption})" if beyond else caption


def main(arguments: list[str] | None = None) -> int:
    """Draw the sheet and write it; return 2 for arguments that cannot be used."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("-o", "--output", type=Path, default=TARGET)
    parser.add_argument("--texels", type=int, default=512)
    parser.add_argument("--size", type=int, default=300, help="pixels along a side of a face")
    options = parser.parse_args(arguments)

    def draw() -> None:
        check_number("texels", options.texels, 4, 8192)
        check_number("size", options.size, 16, 8192)
        check_picture(options.output, TARGET, "tones")
        write_picture(options.output, draw_sheet(options.texels, options.size), "tones")

    return run(draw)


if __name__ == "__main__":
    sys.exit(main())
