"""`skinnet export-face`: a fitted face as GLB or USDZ, for Blender and other tools."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any, Literal

import numpy as np
from jsonargparse import ArgumentParser, Namespace

from skinnet.appearance.maps_file import load_maps
from skinnet.errors import InputError
from skinnet.files import READ_ERRORS, write_atomically
from skinnet.images._result_names import choose_stem, compute_digest
from skinnet.inference._messages import log
from skinnet.mesh.mesh import Mesh
from skinnet.mesh.mesh_file import read_mesh
from skinnet.mesh.repair import repair_mesh
from skinnet.pipeline._fit_archive import load_fit
from skinnet.pipeline._head import Head, make_head
from skinnet.pipeline._head_gltf import write_glb
from skinnet.pipeline._head_usd import check_usd, write_usdz
from skinnet.pipeline._output import (
    MAPS_END,
    add_end,
    add_json,
    add_output,
    make_output_folder,
    print_result,
)
from skinnet.pipeline._source import Source

_VERB = "export-face"
_HEIGHTS = (0.05, 0.6)
"""Heights in metres of what can be a face or a head."""

_WRITERS: dict[str, Callable[[Path, Head], None]] = {"glb": write_glb, "usdz": write_usdz}


def add_arguments(parser: ArgumentParser) -> None:
    """Add the options for maps, format, unit, scan and output."""
    parser.add_argument("maps", type=Path, help="A NAME_maps.npz file, with its NAME_face.obj.")
    parser.add_argument(
        "--format",
        type=Literal["glb", "usdz"],
        default="glb",
        help="glb is glTF 2.0 in one file, usdz is USD in one file.",
    )
    parser.add_argument(
        "--scan",
        type=Path | None,
        default=None,
        help="Scan whose detail the normal map gets; by default the one that was fitted.",
    )
    parser.add_argument(
        "--millimetres",
        type=float | None,
        default=None,
        help="Millimetres of one unit of the face; by default those that the fit has found.",
    )
    add_output(parser, "the folder of the maps")
    add_json(parser, "What was made")


def run(config: Namespace) -> int:
    """Write NAME_head.glb or NAME_head.usdz, in metres, y up, looking along z."""
    if config.format == "usdz":
        check_usd()
    texture, colour = load_maps(config.maps)
    name = config.maps.name.removesuffix(MAPS_END).removesuffix(".npz")
    mesh_file = config.maps.with_name(f"{name}_face.obj")
    if not mesh_file.is_file():
        raise InputError(
            f"There is no {mesh_file} that the maps of {config.maps} belong to; give maps of "
            "skinnet maps or edit-maps, with the files beside them."
        )
    shape = _find_shape(config.maps.parent, name)
    place = _make_placement(shape, config.millimetres, mesh_file)
    scan_file = config.scan or _find_scan(shape)
    if scan_file is None:
        log(f"The scan of {config.maps} is not found, so that the normal map is flat; see --scan.")
    scan = None if scan_file is None else place(repair_mesh(read_mesh(scan_file)).mesh)
    source = Source.read([config.maps])
    mark = source.make_mark(_VERB, "head").to_text()
    head = make_head(place(read_mesh(mesh_file)), texture, colour, scan, mark)
    height = float(np.ptp(head.positions[:, 1]))
    if not _HEIGHTS[0] <= height <= _HEIGHTS[1]:
        raise InputError(
            f"{mesh_file} would be {height:.3g} m high, which no face is; give the length of its "
            "unit with --millimetres."
        )
    end = f"_head.{config.format}"
    folder = make_output_folder(config.output or config.maps.parent)
    path = add_end(folder / choose_stem(folder, name, [end], source.owns), end)
    with write_atomically(path) as part:
        _WRITERS[config.format](Path(part), head)
    record = {"height_m": height, "triangles": len(head.triangles), "texels": len(texture.mask)}
    line = f"{config.maps}: a face of {100 * height:.1f} cm; {path}"
    print_result(line, record, [path], config.json)
    return 0


def _find_shape(folder: Path, name: str) -> Path | None:
    """Find the fit that a face came from; an edited face has that of the one it was made from."""
    names = [name, name.partition("_edited")[0]]
    files = [folder / f"{each}_shape.npz" for each in names]
    return next((file for file in files if file.is_file()), None)


def _make_placement(
    shape: Path | None, millimetres: float | None, mesh_file: Path
) -> Callable[[Mesh], Mesh]:
    """Make the map from the scan's frame to metres in the model's frame."""
    rotation, translation = np.eye(3), np.zeros(3)
    if shape is not None:
        fit = load_fit(shape)
        rotation, translation = fit.pose.rotation, fit.pose.translation
        millimetres = fit.millimetres if millimetres is None else millimetres
    if millimetres is None:
        raise InputError(
            f"Nothing says how long a unit of {mesh_file} is, since its _shape.npz is missing; "
            "give --millimetres, such as 10 for centimetres."
        )
    if not (np.isfinite(millimetres) and millimetres > 0):
        raise InputError(f"millimetres is a length above 0; got {millimetres:g}.")

    def place(mesh: Mesh) -> Mesh:
        vertices = (mesh.vertices - translation) @ rotation * (millimetres / 1000)
        return Mesh(vertices, mesh.triangles, mesh.uv, mesh.uv_triangles, mesh.texture, mesh.name)

    return place


def _find_scan(shape: Path | None) -> Path | None:
    """Find the scan that a fit names, if its content is still the same."""
    if shape is None:
        return None
    try:
        record: Any = json.loads(shape.with_suffix(".json").read_text(encoding="utf-8"))
        path = shape.parent / record["input"]["path"]
        same = path.is_file() and compute_digest(path) == record["input"]["sha256"]
    except (*READ_ERRORS, TypeError):
        return None
    return path if same else None
