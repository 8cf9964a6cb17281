"""Sources of the shader for each renderer, from templates."""

import json
import os
from collections.abc import Callable, Sequence
from pathlib import Path
from string import Template
from typing import Any, NamedTuple

from skinnet._version import __version__
from skinnet.material._map_records import ShaderMap
from skinnet.material._skin_table import SkinTable

NAME = "skin"
"""Stem of the shader's files."""

TABLE = f"{NAME}_table"
"""Stem of the table's files."""

_SPACES = {"raw": "none", "srgb": "srgb_texture", "linear": "lin_rec709"}
"""Colour spaces in MaterialX."""

_TEMPLATES = Path(__file__).parent / "shaders"

_USUAL = {"melanin": 0.05, "hemoglobin": 0.05}
"""Volume fractions of medium skin, for inputs without a map."""


class ShaderSource(NamedTuple):
    """What the sources of a shader are written from.

    Args:
        table: The table of colours.
        light: Name of the light.
        camera: Name of the camera.
        maps: The maps that it reads; empty: sliders alone.
        folder: Folder of its files, to which the paths of the maps are relative.
    """

    table: SkinTable
    light: str
    camera: str
    maps: Sequence[ShaderMap]
    folder: Path

    @property
    def constants(self) -> dict[str, Any]:
        """Numbers and names that all templates share."""
        rows, columns = self.table.colours.shape[:2]
        return {
            "version": __version__,
            "light": self.light,
            "camera": self.camera,
            "table": TABLE,
            "columns": columns,
            "rows": rows,
            "melanin_spacing": self.table.melanin.spacing,
            "hemoglobin_spacing": self.table.hemoglobin.spacing,
            **_USUAL,
        }

    def relative(self, path: Path) -> str:
        """The path of a map from the folder, with slashes; absolute on another drive."""
        try:
            return Path(os.path.relpath(path.absolute(), self.folder.absolute())).as_posix()
        except ValueError:
            return path.absolute().as_posix()


def write_glsl(source: ShaderSource) -> str:
    """Write a GLSL function."""
    return _fill("skin.glsl", source.constants)


def write_osl(source: ShaderSource) -> str:
    """Write an OSL shader."""
    return _fill("skin.osl", source.constants)


def write_blender(source: ShaderSource) -> str:
    """Write a script that makes a node group and a material in Blender."""
    maps = [each._asdict() | {"file": source.relative(each.path)} for each in source.maps]
    for each in maps:
        del each["path"]
    settings = {"name": "Skin", **source.constants, "table": f"{TABLE}.exr", "maps": maps}
    text = (_TEMPLATES / "skin_blender.py").read_text(encoding="utf-8")
    return text.replace('"{}"', f'r"""{json.dumps(settings, indent=2)}"""')


def write_materialx(source: ShaderSource) -> str:
    """Write a MaterialX document: the node, its graph, and a material with it."""
    nodes, connections = [], []
    for each in source.maps:
        name = each.input.lower()
        kind = "color3" if name in ("original", "offset") else "float"
        nodes.append(_write_map(name, kind, source.relative(each.path), each))
        connections.append(f'      <input name="{name}" type="{kind}" nodename="{name}_value" />\n')
        if name == "original":
            connections.append('      <input name="keep" type="float" value="1" />\n')
    more = {"maps": "".join(nodes), "connections": "".join(connections)}
    return _fill("skin.mtlx", source.constants | _scale_axes(source) | more)


WRITERS: dict[str, tuple[str, Callable[[ShaderSource], str]]] = {
    "blender": (f"{NAME}_blender.py", write_blender),
    "materialx": (f"{NAME}.mtlx", write_materialx),
    "glsl": (f"{NAME}.glsl", write_glsl),
    "osl": (f"{NAME}.osl", write_osl),
}
"""Name of the file, and writer of its text, of each target."""


def _fill(name: str, values: dict[str, Any]) -> str:
    return Template((_TEMPLATES / name).read_text(encoding="utf-8")).substitute(values)


def _scale_axes(source: ShaderSource) -> dict[str, float]:
    """Factors and terms of ln(1 + f / spacing) that give coordinates of the table."""
    table, (rows, columns) = source.table, source.table.colours.shape[:2]
    return {
        "inverse_melanin_spacing": 1 / table.melanin.spacing,
        "inverse_hemoglobin_spacing": 1 / table.hemoglobin.spacing,
        "u_scale": 1 / (table.melanin.step * columns),
        "v_scale": 1 / (table.hemoglobin.step * rows),
        "u_shift": 0.5 / columns,
        "v_shift": 0.5 / rows,
    }


def _write_map(name: str, kind: str, file: str, settings: ShaderMap) -> str:
    space = _SPACES[settings.space]
    return f"""\
    <image name="{name}_map" type="{kind}">
      <input name="file" type="filename" value="{_escape(file)}" colorspace="{space}" />
    </image>
    <multiply name="{name}_scaled" type="{kind}">
      <input name="in1" type="{kind}" nodename="{name}_map" />
      <input name="in2" type="float" value="{settings.scale!r}" />
    </multiply>
    <add name="{name}_value" type="{kind}">
      <input name="in1" type="{kind}" nodename="{name}_scaled" />
      <input name="in2" type="float" value="{settings.offset!r}" />
    </add>
"""


def _escape(text: str) -> str:
    from xml.sax.saxutils import escape

    return escape(text, {'"': "&quot;"})
