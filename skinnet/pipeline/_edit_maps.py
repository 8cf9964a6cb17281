"""`skinnet edit-maps`: scale, add to or paint pigments, and render the face again."""

from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path

import numpy as np
from jaxtyping import Float
from jsonargparse import ArgumentParser, Namespace
from PIL import Image

from skinnet.appearance.colour import SkinColour
from skinnet.appearance.edit import PigmentEdit, edit_texture
from skinnet.appearance.maps_file import load_maps, save_maps
from skinnet.appearance.skin_texture import SkinTexture
from skinnet.errors import InputError
from skinnet.images._png_file import write_png
from skinnet.images._result_names import choose_stem
from skinnet.images.photograph import read_photo
from skinnet.inference._messages import log
from skinnet.inference._tiles import draw_grid, draw_picture
from skinnet.mesh.mesh_file import read_mesh, write_mesh
from skinnet.pipeline._maps_writer import (
    add_texture,
    draw_pigments,
    fill_albedo,
    show_albedo,
)
from skinnet.pipeline._output import (
    EDIT_ENDS,
    MAPS_END,
    add_end,
    add_json,
    add_output,
    make_output_folder,
    print_result,
)
from skinnet.pipeline._source import Source
from skinnet.pipeline.relight import RelightSettings
from skinnet.render.scene import Scene

RENAMED = {
    "relight.turn": "relight.yaw",
    "relight.tilt": "relight.pitch",
    "turn": "yaw",
    "tilt": "pitch",
}
"""Flags and keys of earlier versions, and their new names; YAML errors give keys without group."""

_VERB = "edit-maps"
_PIGMENTS = ("melanin", "hemoglobin")


def add_arguments(parser: ArgumentParser) -> None:
    """Add the options for maps, edits, light and output."""
    parser.add_argument("maps", type=Path, help="A NAME_maps.npz file.")
    for name in _PIGMENTS:
        parser.add_argument(f"--{name}", type=float, default=1.0, help="Factor from 0 to 10.")
        parser.add_argument(
            f"--{name}_add", type=float, default=0.0, help="Volume fraction added after scaling."
        )
        parser.add_argument(
            f"--{name}_paint",
            type=float | None,
            default=None,
            help="Volume fraction that replaces the map, usually inside a mask.",
        )
    parser.add_argument(
        "--mask",
        type=Path | None,
        default=None,
        help="Picture over the texture space: white texels are edited, black ones are not.",
    )
    parser.add_class_arguments(RelightSettings, "relight")
    add_output(parser, "the folder of the maps")
    add_json(parser, "What was made")


def run(config: Namespace) -> int:
    """Write NAME_edited_maps.npz, _albedo.png, _panel.png and, with NAME_face.obj, _render.png."""
    before, colour = load_maps(config.maps)
    melanin, hemoglobin = (
        PigmentEdit(config[name], config[f"{name}_add"], config[f"{name}_paint"])
        for name in _PIGMENTS
    )
    _refuse_no_change(melanin, hemoglobin, config.relight)
    after = edit_texture(before, colour, melanin, hemoglobin, _read_mask(config.mask))
    name = config.maps.name.removesuffix(MAPS_END).removesuffix(".npz")
    source = Source.read([config.maps])
    folder = make_output_folder(config.output or config.maps.parent)
    stem = folder / choose_stem(folder, f"{name}_edited", EDIT_ENDS, source.owns)
    text = source.make_mark(_VERB, "edited-maps").to_text()
    save_maps(add_end(stem, MAPS_END), after, colour, source.describe(_VERB, "maps", folder))
    write_png(add_end(stem, "_albedo.png"), show_albedo(after.albedo(colour), after), text)
    rows = _draw_rows(before, after, colour)
    ends = [MAPS_END, "_albedo.png", "_panel.png"]
    mesh = config.maps.with_name(f"{name}_face.obj")
    if mesh.is_file():
        for row, rendered in zip(
            rows,
            _write_faces(mesh, stem, (before, after), colour, config.relight, text),
            strict=True,
        ):
            row.append(rendered)
        ends += [end for end in EDIT_ENDS if end not in ends]
    else:
        log(f"There is no {mesh} to render on; the albedo alone is written.")
    panel = draw_grid([tile for row in rows for tile in row], len(rows[0]))
    write_png(add_end(stem, "_panel.png"), panel, text)
    record = {
        **source.describe(_VERB, "edit", folder),
        "melanin": asdict(melanin),
        "hemoglobin": asdict(hemoglobin),
    }
    line = f"{config.maps}: {stem}_maps.npz, _albedo.png, _panel.png"
    print_result(line, record, [add_end(stem, end) for end in ends], config.json)
    return 0


def _refuse_no_change(
    melanin: PigmentEdit, hemoglobin: PigmentEdit, relight: RelightSettings
) -> None:
    """Refuse what neither edits nor relights: a mere copy would replace an earlier edit."""
    if melanin == hemoglobin == PigmentEdit() and relight == RelightSettings():
        raise InputError(
            "Nothing is edited: all factors are 1, nothing is added or painted, and light and "
            "camera are the usual ones. Give an edit, such as --melanin=1.5."
        )


def _read_mask(path: Path | None) -> Float[np.ndarray, "h w"] | None:
    return None if path is None else np.asarray(read_photo(path).mean(-1) / 255)


def _draw_rows(
    before: SkinTexture, after: SkinTexture, colour: SkinColour
) -> list[list[Image.Image]]:
    """Draw albedo and pigments before and after."""
    rows = []
    for when, texture in (("before", before), ("after", after)):
        albedo = draw_picture(f"albedo {when}", show_albedo(texture.albedo(colour), texture))
        rows.append([albedo, *draw_pigments(texture)])
    return rows


def _write_faces(
    mesh: Path,
    stem: Path,
    textures: tuple[SkinTexture, SkinTexture],
    colour: SkinColour,
    relight: RelightSettings,
    text: Mapping[str, str],
) -> list[Image.Image]:
    """Write the edited face as a mesh and as a picture; draw tiles of it before and after."""
    face, after = read_mesh(mesh), textures[1]
    albedos = [fill_albedo(one.albedo(colour), one) for one in textures]
    scene = Scene(face)
    pictures = [relight.render(scene, albedo) for albedo in albedos]
    write_png(add_end(stem, "_render.png"), pictures[1], text)
    textured = add_texture(face, show_albedo(after.albedo(colour), after))
    write_mesh(add_end(stem, "_face.obj"), textured, text)
    return [draw_picture("relit", picture) for picture in pictures]
