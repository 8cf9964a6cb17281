"""Scans: their files, options, repairs and landmarks."""

import glob
import os
from collections.abc import Callable
from dataclasses import dataclass, fields
from pathlib import Path

import numpy as np
from jaxtyping import Float
from jsonargparse import ArgumentParser, Namespace

from skinnet.errors import InputError
from skinnet.images._result_names import OUTPUT, choose_stem
from skinnet.inference._messages import log, report
from skinnet.mesh.mesh import Mesh
from skinnet.mesh.mesh_file import read_mesh
from skinnet.mesh.repair import repair_mesh
from skinnet.pipeline._output import SCAN_ENDS, add_json, add_output, make_output_folder
from skinnet.pipeline._source import Source, find_result_verb
from skinnet.shape._landmark_check import check_landmarks
from skinnet.shape.landmarks import read_landmarks
from skinnet.shape.model import ShapeModel
from skinnet.shape.model_formats import load_shape_model

RENAMED = {"model_landmarks": "shape_landmarks", "model": "shape"}
"""Flags and keys of earlier versions, and their new names."""

_LANDMARK_ENDS = (".ljson", ".pp", "_landmarks.csv", "_landmarks.json")
"""Ends of the names of landmark files beside NAME.obj."""


@dataclass(frozen=True)
class ScanOptions:
    """The shape model, and the files that belong to a scan.

    Args:
        shape: Shape model: ICT-FaceKit (folder or .npz), Basel Face Model (.mat, .h5),
            skinnet's .npz, or a folder of registered meshes; by default the procedural face.
        shape_landmarks: .json of names and vertex numbers, for a model without landmarks.
        landmarks: Points of the scan (.ljson, .csv, .json, .pp); by default NAME.ljson, NAME.pp,
            NAME_landmarks.csv or .json beside it. Without landmarks, the face is detected in a
            picture from the front.
        texture: The scan's picture, if the mesh does not name it.
    """

    shape: Path | None = None
    shape_landmarks: Path | None = None
    landmarks: Path | None = None
    texture: Path | None = None

    def load_model(self) -> ShapeModel:
        """Load the shape model."""
        return load_shape_model(self.shape, self.shape_landmarks)


@dataclass(frozen=True)
class Scan:
    """A checked mesh, its landmarks if known, and notes on its repairs."""

    path: Path
    mesh: Mesh
    landmarks: dict[str, Float[np.ndarray, "3"]] | None
    notes: tuple[str, ...]


def load_scan(path: Path, model: ShapeModel, options: ScanOptions, textured: bool = False) -> Scan:
    """Read, check and repair a scan. Its landmarks are those given, those beside it, or none.

    Raises:
        InputError: If the scan cannot be read or repaired, is a result, or its landmarks are wrong.
    """
    if (verb := find_result_verb(path)) is not None:
        raise InputError(
            f"{path} is a result of skinnet {verb}, not a scan; give the scan that it was made "
            "from."
        )
    mesh = read_mesh(path, options.texture)
    # Before the checks: what was assumed explains why one fails.
    for note in mesh.notes:
        log(note)
    marks = options.landmarks or next(
        (file for file in _list_landmark_files(path) if file.is_file()), None
    )
    points = None if marks is None else read_landmarks(marks, mesh)
    checked = repair_mesh(mesh, textured)
    notes = list(checked.notes)
    if points is None:
        notes.append(f"{path} has no landmarks; its face is detected from the front.")
    else:
        check_landmarks(points, model, checked.mesh, str(marks))
    for note in notes:
        log(note)
    return Scan(path, checked.mesh, points, (*mesh.notes, *notes))


def process_scans(
    paths: list[Path], options: ScanOptions, output: Path | None, action: Callable[[Path], object]
) -> int:
    """Process every scan and log errors; return 2 if there was an error, else 0.

    Raises:
        InputError: If one file of landmarks or one texture is given for several scans, or two scans
            would write the same files.
    """
    paths = _expand_patterns(paths)
    for name, one in (("landmarks", options.landmarks), ("texture", options.texture)):
        if one is not None and len(paths) > 1:
            raise InputError(
                f"{one} is one file of {name} for {len(paths)} scans; put each scan's own beside "
                "it."
            )
    names = [(os.path.realpath(output or path.parent), path.stem.casefold()) for path in paths]
    twice = [path for path, name in zip(paths, names, strict=True) if names.count(name) > 1]
    if twice:
        raise InputError(
            f"{twice[0]} and {twice[1]} would write the same files; rename one, or run each "
            "with its own -o."
        )
    code = 0
    for path in paths:
        try:
            action(path)
        except InputError as error:
            report(error)
            code = 2
    return code


def _list_landmark_files(path: Path) -> list[Path]:
    """List the files that may hold the landmarks of a scan."""
    return [path.with_name(path.stem + end) for end in _LANDMARK_ENDS]


def _expand_patterns(paths: list[Path]) -> list[Path]:
    """Expand patterns such as *.obj that no shell has expanded."""
    expanded: list[Path] = []
    for path in paths:
        pattern = not path.exists() and glob.has_magic(str(path))
        found = sorted(map(Path, glob.glob(str(path)))) if pattern else [path]
        if not found:
            raise InputError(f"No file matches {path}; check the folder and the ending.")
        expanded += found
    return expanded


def make_output_stem(source: Source, output: Path | None) -> Path:
    """Make the output folder, and FOLDER/NAME with which the names of a scan's files begin.

    NAME gets a number where another scan's results or a user's files have these names.
    """
    scan = source.paths[0]
    folder = make_output_folder(output or scan.parent / OUTPUT)
    return folder / choose_stem(folder, scan.stem, SCAN_ENDS, source.owns)


def add_scan_arguments(parser: ArgumentParser) -> None:
    """Add the options for scans, the files that belong to them, and the output folder."""
    parser.add_argument("scan", nargs="+", type=Path, help="Meshes: OBJ, PLY, glTF, GLB or STL.")
    parser.add_class_arguments(ScanOptions)
    add_output(parser, "skinmaps beside the scan")
    add_json(parser, "The summary of each scan")


def collect_options(config: Namespace) -> ScanOptions:
    """Collect the options that `add_scan_arguments` added."""
    return ScanOptions(**{one.name: config[one.name] for one in fields(ScanOptions)})
