"""`skinnet fit-shape`: a shape model fitted to scans."""

import json
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from jsonargparse import ArgumentParser, Namespace

from skinnet.errors import InputError
from skinnet.images._png_file import write_png
from skinnet.images._result_names import lock_folder
from skinnet.inference._messages import log
from skinnet.mesh.mesh import Mesh
from skinnet.mesh.mesh_file import write_mesh
from skinnet.pipeline._fit_archive import load_fit, save_fit
from skinnet.pipeline._fit_picture import draw_fit
from skinnet.pipeline._output import add_end, print_result
from skinnet.pipeline._progress import compute_fingerprint, read_finished, write_record
from skinnet.pipeline._scans import (
    RENAMED,
    Scan,
    ScanOptions,
    add_scan_arguments,
    collect_options,
    load_scan,
    make_output_stem,
    process_scans,
)
from skinnet.pipeline._source import Source
from skinnet.pipeline.initial_pose import find_initial_pose
from skinnet.shape.fit_settings import FitSettings
from skinnet.shape.model import ShapeModel
from skinnet.shape.registration import Registration, register

__all__ = ["RENAMED", "add_arguments", "run"]

_NO_FACE_MM = 10.0
"""RMS distance of the kept vertices in mm above which no face was found."""

_UNLIKELY_SHAPE = 2.0
"""RMS of the coefficients, in standard deviations, above which a fit is doubtful."""

_VERB = "fit-shape"
_ENDS = ("_shape.npz", "_shape.obj", "_shape.png", "_shape.json")


@dataclass(frozen=True)
class FittedScan:
    """A scan, the shape fitted to it, and FOLDER/NAME with which the names of its files begin."""

    scan: Scan
    source: Source
    fit: Registration
    stem: Path
    fingerprint: str

    def mesh(self, model: ShapeModel) -> Mesh:
        """Build the mesh of the fitted model in the scan's frame."""
        name = f"the model fitted to {self.scan.path}"
        return Mesh(self.fit.vertices, model.triangles, model.uv, model.uv_triangles, name=name)


def add_arguments(parser: ArgumentParser) -> None:
    """Add the options for scans, shape model, output and fit."""
    add_scan_arguments(parser)
    parser.add_class_arguments(FitSettings, "fit")


def run(config: Namespace) -> int:
    """Fit a shape model to scans; write NAME_shape.npz, .obj, .png and .json of each."""
    options = collect_options(config)
    model = options.load_model()

    def process(path: Path) -> None:
        fitted = fit_scan(path, model, options, config.output, config.fit)
        files = [add_end(fitted.stem, end) for end in _ENDS]
        record = json.loads(files[-1].read_text(encoding="utf-8"))
        print_result(describe_fit(fitted), record, files, config.json)

    return process_scans(config.scan, options, config.output, process)


def fit_scan(
    path: Path,
    model: ShapeModel,
    options: ScanOptions,
    output: Path | None,
    settings: FitSettings,
    textured: bool = False,
) -> FittedScan:
    """Fit a shape model to one scan, or read the earlier fit of these inputs."""
    scan = load_scan(path, model, options, textured)
    source = Source.read([path])
    stem = make_output_stem(source, output)
    marks = {} if scan.landmarks is None else scan.landmarks
    points = {name: point.tolist() for name, point in marks.items()}
    fingerprint = compute_fingerprint(path, options.shape or "default", points, settings)
    archive, mesh, picture, record = (add_end(stem, end) for end in _ENDS)
    if read_finished(record, fingerprint, [archive, mesh, picture]) is not None:
        log(f"{archive} is there already and is kept.")
        return FittedScan(scan, source, load_fit(archive), stem, fingerprint)
    start = find_initial_pose(model, scan.mesh) if scan.landmarks is None else None
    fit = register(model, scan.mesh, scan.landmarks, settings, log, start)
    _check_fit(fit, scan, model)
    with lock_folder(stem.parent):
        # Another process may have taken the name meanwhile.
        stem = make_output_stem(source, output)
        fitted = FittedScan(scan, source, fit, stem, fingerprint)
        write_fit(fitted, model)
    return fitted


def write_fit(fitted: FittedScan, model: ShapeModel) -> None:
    """Write the files of a fit, the record last; warn if its shape is unlikely."""
    archive, mesh, picture, record = (add_end(fitted.stem, end) for end in _ENDS)
    summary = summarise_fit(fitted, model)
    if summary["rms_deviations"] > _UNLIKELY_SHAPE:
        log(
            f"{fitted.scan.path}: the fitted shape is unlikely under {model.name}; look at "
            f"{picture}, and give a model of real faces with --shape."
        )
    text = fitted.source.make_mark(_VERB, "shape").to_text()
    origin = fitted.source.describe(_VERB, "shape", fitted.stem.parent)
    save_fit(archive, fitted.fit, origin)
    write_mesh(mesh, fitted.mesh(model), text)
    write_png(picture, draw_fit(fitted.scan.mesh, fitted.mesh(model), fitted.fit), text)
    write_record(record, fitted.fingerprint, origin | summary)


def describe_fit(fitted: FittedScan) -> str:
    """Describe a fit in one line."""
    fit = fitted.fit
    end = "" if fit.converged else "; the fit did not converge"
    return (
        f"{fitted.scan.path}: {fit.rms:.2f} mm RMS over the nearest "
        f"{fit.kept.mean():.0%} of the model, 95 % of all vertices within "
        f"{np.percentile(fit.distances, 95):.1f} mm; a unit of the scan is {fit.millimetres:.3g} mm"
        f"{end}; "
        f"{fitted.stem}_shape.npz, .obj, .png, .json"
    )


def summarise_fit(fitted: FittedScan, model: ShapeModel) -> dict[str, Any]:
    """Summarise a fit for its record: distances in mm, pose and convergence."""
    fit = fitted.fit
    middle, most = np.percentile(fit.distances, [50, 95])
    deviations = fit.alpha / np.sqrt(model.variances[: len(fit.alpha)])
    return {
        "file": str(fitted.scan.path),
        "model": model.name,
        "notes": list(fitted.scan.notes),
        "rms_mm": fit.rms,
        "median_mm": float(middle),
        "p95_mm": float(most),
        "kept": float(fit.kept.mean()),
        "millimetres": fit.millimetres,
        "rotation": fit.pose.rotation.tolist(),
        "scale": fit.pose.scale,
        "translation": fit.pose.translation.tolist(),
        "rms_deviations": float(np.sqrt(np.mean(deviations**2))),
        "converged": fit.converged,
        "stages": [asdict(stage) for stage in fit.record],
    }


def _check_fit(fit: Registration, scan: Scan, model: ShapeModel) -> None:
    if not fit.rms < _NO_FACE_MM:
        raise InputError(
            f"{scan.path}: {model.name} stays {fit.rms:.0f} mm away from the scan, so no face was "
            "found; check the landmarks, or give some if there were none."
        )
