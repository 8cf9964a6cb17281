"""The verbs of textures and materials: what each does, its examples, its flags and its function."""

import argparse
from pathlib import Path
from typing import Any

from skinnet.inference._command.photo_verbs import PhotoVerb
from skinnet.inference._command.shared_arguments import (
    add_folder,
    add_json,
    read_texture_folder,
)
from skinnet.material._shader_flags import add_shader

_MATERIAL = "skinnet.material"
_PRESET_NAMES = ("blush", "tan", "pallor", "vitiligo")


class _Once(argparse.Action):
    """A flag of which a second one would silently replace the first."""

    def __call__(
        self,
        parser: argparse.ArgumentParser,
        namespace: argparse.Namespace,
        values: Any,
        option_string: str | None = None,
    ) -> None:
        if getattr(namespace, self.dest) is not None:
            raise argparse.ArgumentError(
                self, "it is given twice; give one, and what it lacks by factors and brushes"
            )
        setattr(namespace, self.dest, values)


def _add_texture(verb: argparse.ArgumentParser, what: str) -> None:
    verb.add_argument("texture", type=Path, help=what)
    group = verb.add_argument_group("the colours of the texture")
    group.add_argument(
        "--space",
        choices=("sRGB", "linear"),
        help="how its values are stored; by default as the file states, else sRGB, and linear in "
        "EXR",
    )
    group.add_argument(
        "--light",
        default="D65",
        metavar="NAME|FILE.csv",
        help="the light that its colours are of: D65 by default, D5500K, A, FL11, LED-B3, or a CSV",
    )
    group.add_argument(
        "--camera",
        default="observer",
        metavar="NAME|FILE.csv",
        help="what saw the colours: observer (CIE 1931) by default, a camera such as 'Nikon D200', "
        "mean for the mean of the measured cameras, or a CSV of its sensitivities",
    )
    group.add_argument(
        "--calibration",
        default="none",
        metavar="none|exposure|full|FILE.json",
        help="fit one factor (exposure) or the paper's 3 x 3 (full) between model and texture, or "
        "take the transform of a file that skinnet wrote; by default none",
    )
    verb.add_argument("--partial", action="store_true", help="accept a UDIM set with missing tiles")


def _add_output(verb: argparse.ArgumentParser, usual: str) -> None:
    add_folder(verb, usual, read_texture_folder)
    add_json(verb, "what was made")


def _add_invert(verb: argparse.ArgumentParser) -> None:
    _add_texture(
        verb, "albedo: PNG, TIFF, EXR or JPEG, a pattern such as 'face.<UDIM>.png', or one tile"
    )
    _add_output(verb, "skinmaps beside the texture")


def _add_edit(verb: argparse.ArgumentParser) -> None:
    _add_texture(verb, "albedo, pattern or tile as of invert, or the NAME_maps.json that it wrote")
    group = verb.add_argument_group("the edit")
    for name, most in (("melanin", 0.5), ("hemoglobin", 0.25)):
        group.add_argument(
            f"--{name}", type=float, metavar="X", help="factor, 0 to 10; 1 by default"
        )
        group.add_argument(
            f"--{name}-add",
            type=float,
            default=0.0,
            metavar="F",
            help="volume fraction that is added after that",
        )
        group.add_argument(
            f"--{name}-paint",
            metavar="F|FILE",
            help="volume fraction that replaces the map, or a painted map, as invert writes it: "
            f"white is {most:g}",
        )
    group.add_argument(
        "--mask",
        type=Path,
        metavar="FILE",
        help="picture of the texture's size: white is edited, grey partly, black is not; a "
        "pattern for UDIM sets",
    )
    group.add_argument(
        "--preset",
        action=_Once,
        choices=_PRESET_NAMES,
        help="an edit with a name; docs/albedo.md has their numbers and sources",
    )
    group.add_argument(
        "--brush",
        action="append",
        default=[],
        metavar="NAME[:KEY=VALUE,...]",
        help="freckles, moles, flush, tan-line or patches, such as freckles:count=300,u=0.5,v=0.6,"
        "radius=0.2,seed=1; u and v from the lower left corner, sizes in widths of the texture; "
        "may be given several times",
    )
    _add_output(verb, "the folder of the texture, or of NAME_maps.json")


MATERIAL_VERBS: dict[str, PhotoVerb] = {
    "invert": PhotoVerb(
        "make melanin, hemoglobin and offset maps of an albedo texture, with their spread",
        _add_invert,
        f"{_MATERIAL}._invert_verb:invert",
        (
            ("skinnet invert albedo.png", "maps in the folder skinmaps beside it"),
            ("skinnet invert 'face.<UDIM>.exr'", "all tiles of a set"),
            ("skinnet invert albedo.tif --light A --calibration full", "a fitted 3 x 3"),
        ),
    ),
    "edit-albedo": PhotoVerb(
        "edit the pigments of an albedo texture: factors, masks, painted maps, brushes, presets",
        _add_edit,
        f"{_MATERIAL}._edit_verb:edit",
        (
            ("skinnet edit-albedo albedo.png --melanin 1.5", "tanned, as albedo_edited.png"),
            ("skinnet edit-albedo albedo.png --preset blush --mask cheeks.png", "flushed cheeks"),
            ("skinnet edit-albedo skinmaps/albedo_maps.json --brush freckles", "from its maps"),
        ),
    ),
    "shader": PhotoVerb(
        "write the skin model for Blender, MaterialX, GLSL and OSL",
        add_shader,
        "skinnet.material._shader_verb:shader",
        (
            ("skinnet shader", "a table and shaders with sliders, in the folder skinshader"),
            ("skinnet shader a_melanin.png a_hemoglobin.png", "a material that reads these maps"),
            ("skinnet shader --target blender -o skin", "the node group of Blender alone"),
        ),
        "It writes colours by melanin and hemoglobin as a table, EXR and 16-bit PNG, and what "
        "looks them up: sliders scale and add both pigments, flush skin, and let the pulse show.",
    ),
}
"""The verbs, in the order in which the help lists them; each needs the extra `textures`, and
`shader` the extra `torch` alone."""
