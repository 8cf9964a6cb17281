"""The verb `shader`, with options that are parsed."""

import argparse
import json
import os
import re
from pathlib import Path
from typing import Any

from skinnet.errors import InputError
from skinnet.files import make_folder, write_atomically, write_together
from skinnet.inference._messages import note, print_line
from skinnet.material._blend_file import find_blender, write_blend
from skinnet.material._shader_flags import TARGETS
from skinnet.material._shader_maps import describe_maps
from skinnet.material._shader_sources import NAME, TABLE, WRITERS, ShaderSource
from skinnet.material._skin_table import tabulate_skin
from skinnet.material._table_files import write_table_exr, write_table_png

_NO_BLENDER = (
    "skin.blend is not written, since there is no Blender on the PATH (--blender PROGRAM names "
    "one); skin_blender.py makes the same in Blender."
)


def shader(options: argparse.Namespace) -> None:
    """Write the table, and the shader of each target."""
    targets = [each for each in TARGETS if each in (options.target or TARGETS)]
    blender = find_blender(options.blender) if "blender" in targets else ()
    source, notes = _make_source(options)
    files = _list_files(source.folder, targets, bool(blender))
    _refuse_existing(files, options.overwrite)
    make_folder(source.folder, "choose another folder with -o")
    _write(source, targets)
    if "blender" in targets and not blender:
        notes.append(_NO_BLENDER)
    if blender and (fault := _make_blend(source, blender, asked=options.blender is not None)):
        notes.append(fault)
        files.remove(source.folder / f"{NAME}.blend")
    _print(source, files, targets, notes, options.json)


def _make_blend(source: ShaderSource, blender: tuple[str, ...], asked: bool) -> str | None:
    """Make the .blend; where the user did not name a Blender, a fault is a sentence alone."""
    try:
        with write_atomically(source.folder / f"{NAME}.blend") as part:
            write_blend(part, blender, source.folder / WRITERS["blender"][0])
    except InputError as error:
        if asked:
            raise
        return str(error)
    return None


def _make_source(options: argparse.Namespace) -> tuple[ShaderSource, list[str]]:
    """Make what is written, and sentences about it."""
    found = describe_maps(options.maps, options.original)
    record = found.record
    light = options.light or (record.light if record else "D65")
    camera = options.camera or (record.camera if record else "observer")
    maps, notes, transform = found.maps, [], record.transform if record else None
    if record and (light, camera) != (record.light, record.camera):
        maps = [each for each in maps if each.input not in ("Original", "Offset")]
        transform = None
        notes.append(
            f"The maps were made for light {record.light} and camera {record.camera}, and the "
            f"table is for {light} and {camera}: it shows skin alone, without the texture's offset "
            "and colour transform, which hold for the maps' light."
        )
    table = tabulate_skin(light, camera, options.size, transform)
    return ShaderSource(table, _shorten(light), _shorten(camera), maps, options.output), notes


def _shorten(name: str) -> str:
    """A name that may stand in a comment of any language."""
    return re.sub(r"[^\w .-]|-(?=-)", "_", Path(name).name)


def _list_files(folder: Path, targets: list[str], blend: bool) -> list[Path]:
    names = [f"{TABLE}.exr", f"{TABLE}.png", *(WRITERS[each][0] for each in targets)]
    return [folder / name for name in [*names, *([f"{NAME}.blend"] if blend else [])]]


def _refuse_existing(files: list[Path], overwrite: bool) -> None:
    there = [each for each in files if os.path.lexists(each)]
    if there and not overwrite:
        raise InputError(
            f"{there[0]} exists; choose another folder with -o, or replace what is there with "
            "--overwrite."
        )


def _write(source: ShaderSource, targets: list[str]) -> None:
    with write_together() as temporary:
        write_table_exr(temporary(source.folder / f"{TABLE}.exr"), source.table)
        write_table_png(temporary(source.folder / f"{TABLE}.png"), source.table)
        for name, write in (WRITERS[each] for each in targets):
            temporary(source.folder / name).write_text(write(source), encoding="utf-8")


def _print(
    source: ShaderSource, files: list[Path], targets: list[str], notes: list[str], as_json: bool
) -> None:
    for sentence in notes:
        note(sentence)
    if as_json:
        print_line(json.dumps(_summarise(source, files, targets, notes), allow_nan=False))
        return
    maps = f" of {len(source.maps)} maps" if source.maps else ""
    print_line(f"shader{maps}: {', '.join(str(each) for each in files)}")


def _summarise(
    source: ShaderSource, files: list[Path], targets: list[str], notes: list[str]
) -> dict[str, Any]:
    table = source.table
    return {
        "output": str(source.folder),
        "files": [str(each) for each in files],
        "targets": targets,
        "light": source.light,
        "camera": source.camera,
        "table": {
            "columns": table.melanin.nodes,
            "rows": table.hemoglobin.nodes,
            "melanin_spacing": table.melanin.spacing,
            "hemoglobin_spacing": table.hemoglobin.spacing,
        },
        "maps": {each.input.lower(): str(each.path) for each in source.maps},
        "notes": notes,
    }
