"""`skinnet edit-maps`: pigments scaled, added or painted, and the face rendered again."""

from pathlib import Path

import numpy as np
from jaxtyping import Float
from jsonargparse import ArgumentParser, Namespace

from skinnet.appearance.edit import PigmentEdit, edit_texture
from skinnet.appearance.maps_file import load_maps, save_maps
from skinnet.appearance.skin_texture import SkinTexture
from skinnet.images.photograph import read_photo, write_png
from skinnet.inference.panel import draw_grid, draw_picture, round_up
from skinnet.mesh.mesh_file import read_mesh, write_mesh
from skinnet.pipeline._build_model import MAPS
from skinnet.pipeline._maps_writer import covered, pigment_tiles, shown, textured
from skinnet.pipeline._progress import log
from skinnet.pipeline.command import add_output, output_folder
from skinnet.pipeline.relight import RelightSettings

PIGMENTS = ("melanin", "hemoglobin")


def add_arguments(parser: ArgumentParser) -> None:
    """Maps, changes, light and output."""
    parser.add_argument("maps", type=Path, help="A NAME_maps.npz file.")
    for name in PIGMENTS:
        parser.add_argument(f"--{name}", type=float, default=1.0, help="Factor, 0 or more.")
        parser.add_argument(
            f"--{name}_add", type=float, default=0.0, help="Volume fraction added after it."
        )
        parser.add_argument(
            f"--{name}_paint",
            type=float | None,
            default=None,
            help="Volume fraction that takes the map's place, as a rule under a mask.",
        )
    parser.add_argument(
        "--mask",
        type=Path | None,
        default=None,
        help="Picture over the texture space: white takes the change, black does not.",
    )
    parser.add_class_arguments(RelightSettings, "relight")
    add_output(parser, "the folder of the maps")


def run(config: Namespace) -> int:
    """Write NAME_edited_maps.npz, _albedo.png, _panel.png and, with NAME_face.obj, _render.png."""
    before, colour = load_maps(config.maps)
    melanin, hemoglobin = (
        PigmentEdit(config[name], config[f"{name}_add"], config[f"{name}_paint"])
        for name in PIGMENTS
    )
    after = edit_texture(before, melanin, hemoglobin, _mask(config.mask))
    name = config.maps.name.removesuffix(MAPS).removesuffix(".npz")
    output = output_folder(config.output or config.maps.parent)
    stem = output / f"{name}_edited"
    albedo = shown(after.albedo(colour), after)
    save_maps(stem.with_name(f"{stem.name}_maps.npz"), after, colour)
    write_png(stem.with_name(f"{stem.name}_albedo.png"), albedo)
    tops = (_top(before, after, "f_mel"), _top(before, after, "f_blood"))
    rows = [
        [draw_picture(f"albedo {when}", shown(one.albedo(colour), one)), *pigment_tiles(one, tops)]
        for when, one in (("before", before), ("after", after))
    ]
    mesh = config.maps.with_name(f"{name}_face.obj")
    if mesh.is_file():
        face = read_mesh(mesh)
        albedos = [covered(one.albedo(colour), one) for one in (before, after)]
        pictures = [config.relight.picture(face, one) for one in albedos]
        write_png(stem.with_name(f"{stem.name}_render.png"), pictures[1])
        write_mesh(stem.with_name(f"{stem.name}_face.obj"), textured(face, albedo))
        for row, rendered in zip(rows, pictures, strict=True):
            row.append(draw_picture("relit", rendered))
    else:
        log(f"There is no {mesh} to render on; the albedo alone is written.")
    panel = draw_grid([tile for row in rows for tile in row], len(rows[0]))
    write_png(stem.with_name(f"{stem.name}_panel.png"), panel)
    print(f"{config.maps}: {stem}_maps.npz, _albedo.png, _panel.png", flush=True)
    return 0


def _mask(path: Path | None) -> Float[np.ndarray, "h w"] | None:
    return None if path is None else np.asarray(read_photo(path).mean(-1) / 255)


def _top(before: SkinTexture, after: SkinTexture, name: str) -> float:
    values = [np.percentile(getattr(one, name)[one.mask], 99) for one in (before, after)]
    return round_up(float(max(values)))
