"""`skinnet fit-shape`: a shape model fitted to scans."""

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from jsonargparse import ArgumentParser, Namespace

from skinnet.errors import InputError
from skinnet.images.photograph import write_png
from skinnet.mesh.mesh import Mesh
from skinnet.mesh.mesh_file import write_mesh
from skinnet.pipeline._fit_archive import load_fit, save_fit
from skinnet.pipeline._fit_picture import fit_sheet
from skinnet.pipeline._progress import digest, finished, log, write_record
from skinnet.pipeline._scans import (
    Scan,
    ScanOptions,
    add_scan_arguments,
    each_scan,
    load_scan,
    place,
    scan_options,
)
from skinnet.pipeline.initial_pose import find_initial_pose
from skinnet.shape.fit_settings import FitSettings
from skinnet.shape.model import ShapeModel
from skinnet.shape.registration import Registration, register

NOTHING_NEAR = 10.0
"""RMS distance of the kept vertices in mm above which a fit has found no face."""

UNLIKELY = 2.0
"""RMS of the coefficients, in standard deviations, above which a fit is doubtful."""


@dataclass(frozen=True)
class Fitted:
    """A scan, the shape fitted to it, and FOLDER/NAME of its files."""

    scan: Scan
    found: Registration
    stem: Path
    fingerprint: str

    def mesh(self, model: ShapeModel) -> Mesh:
        """The fitted model in the scan's frame."""
        name = f"the model fitted to {self.scan.path}"
        return Mesh(self.found.vertices, model.triangles, model.uv, model.uv_triangles, name=name)


def add_arguments(parser: ArgumentParser) -> None:
    """Scans, model, output and how the fit goes."""
    add_scan_arguments(parser)
    parser.add_class_arguments(FitSettings, "fit")


def run(config: Namespace) -> int:
    """Fit a shape model to scans; write NAME_shape.npz, .obj, .png and .json of each."""
    options = scan_options(config)
    model = options.load_model()

    def one(path: Path) -> None:
        print(told(fitted(path, model, options, config.output, config.fit)), flush=True)

    return each_scan(config.scan, options, config.output, one)


def fitted(
    path: Path,
    model: ShapeModel,
    options: ScanOptions,
    output: Path | None,
    fit: FitSettings,
    textured: bool = False,
) -> Fitted:
    """The fit of one scan, from disk if it was made before from the same files and settings."""
    scan = load_scan(path, model, options, textured)
    stem = place(path, output)
    marks = {} if scan.landmarks is None else scan.landmarks
    points = {name: point.tolist() for name, point in marks.items()}
    fingerprint = digest(path, options.model or "default", points, fit)
    files = [stem.with_name(f"{stem.name}_shape.{end}") for end in ("npz", "obj", "png", "json")]
    if finished(files[-1], fingerprint, files[:-1]) is not None:
        log(f"{files[0]} is there already and is kept.")
        return Fitted(scan, load_fit(files[0]), stem, fingerprint)
    start = find_initial_pose(model, scan.mesh) if scan.landmarks is None else None
    found = register(model, scan.mesh, scan.landmarks, fit, log, start)
    _check(found, scan, model)
    save_fit(files[0], found)
    result = Fitted(scan, found, stem, fingerprint)
    if summary(result, model)["rms_deviations"] > UNLIKELY:
        log(
            f"{scan.path}: the fitted shape is an unlikely one for {model.name}; look at "
            f"{files[2]}, and give a model of real faces with --model."
        )
    write_mesh(files[1], result.mesh(model))
    write_png(files[2], fit_sheet(scan.mesh, result.mesh(model), found))
    write_record(files[3], fingerprint, summary(result, model))
    return result


def told(result: Fitted) -> str:
    """One line on a fit."""
    found = result.found
    end = "" if found.converged else "; it had not settled when its iterations ran out"
    return (
        f"{result.scan.path}: {found.rms:.2f} mm RMS over the nearest "
        f"{found.kept.mean():.0%} of the model, {np.percentile(found.distances, 95):.1f} mm at "
        f"95 % of all of it; a unit of the scan is {found.millimetres:.3g} mm{end}; "
        f"{result.stem}_shape.npz, .obj, .png, .json"
    )


def summary(result: Fitted, model: ShapeModel) -> dict[str, Any]:
    """What the record of a fit says: distances in mm, pose, and how it went."""
    found = result.found
    middle, most = np.percentile(found.distances, [50, 95])
    deviations = found.alpha / np.sqrt(model.variances[: len(found.alpha)])
    return {
        "file": str(result.scan.path),
        "model": model.name,
        "notes": list(result.scan.notes),
        "rms_mm": found.rms,
        "median_mm": float(middle),
        "p95_mm": float(most),
        "kept": float(found.kept.mean()),
        "millimetres": found.millimetres,
        "rotation": found.pose.rotation.tolist(),
        "scale": found.pose.scale,
        "translation": found.pose.translation.tolist(),
        "rms_deviations": float(np.sqrt(np.mean(deviations**2))),
        "converged": found.converged,
        "stages": [asdict(stage) for stage in found.record],
    }


def _check(found: Registration, scan: Scan, model: ShapeModel) -> None:
    if not found.rms < NOTHING_NEAR:
        raise InputError(
            f"{scan.path}: {model.name} ends {found.rms:.0f} mm from the scan, which is no fit; "
            "check the landmarks, or give some if there were none."
        )
