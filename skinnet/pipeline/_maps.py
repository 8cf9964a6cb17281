"""`skinnet maps`: scans to maps of melanin and hemoglobin in a model's texture space."""

from dataclasses import asdict, dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float
from jsonargparse import ArgumentParser, Namespace

from skinnet.appearance.skin_texture import SkinTexture
from skinnet.inference._messages import log
from skinnet.pipeline._fit_shape import FittedScan, fit_scan
from skinnet.pipeline._maps_writer import MAPS_ENDS, write_maps
from skinnet.pipeline._output import add_end, print_result
from skinnet.pipeline._progress import compute_fingerprint, read_finished, write_record
from skinnet.pipeline._scans import RENAMED, add_scan_arguments, collect_options, process_scans
from skinnet.pipeline._warp_scan import make_texture_space, warp_scan
from skinnet.pipeline.calibrate import CalibratedColours, ColourSettings
from skinnet.pipeline.texture_inversion import invert_texture
from skinnet.pipeline.texture_space import WarpSettings, embed_model
from skinnet.shape.fit_settings import FitSettings
from skinnet.shape.model import ShapeModel
from skinnet.texture.warp import WarpedTexture

__all__ = ["RENAMED", "add_arguments", "run"]

_RECORD_END = "_maps.json"

_DOUBTFUL_SHARE = 0.5
"""Share of texels whose colour is off the skin manifold above which maps are doubtful."""


@dataclass(frozen=True)
class WarpedScan:
    """A fitted scan, and its texture in the model's space."""

    fitted: FittedScan
    warped: WarpedTexture

    @cached_property
    def colours(self) -> Float[np.ndarray, "n 3"]:
        """Linear RGB [n, 3] of the texels that the scan covers."""
        return np.asarray(self.warped.image[self.warped.mask])


def add_arguments(parser: ArgumentParser) -> None:
    """Add the options for scans, shape model, output and the settings of each step."""
    add_scan_arguments(parser)
    parser.add_class_arguments(FitSettings, "fit")
    parser.add_class_arguments(WarpSettings, "warp")
    parser.add_class_arguments(ColourSettings, "colour")


def run(config: Namespace) -> int:
    """Fit and warp each scan, calibrate all together, and invert; finished steps are reused."""
    options = collect_options(config)
    config.colour.check()
    model = embed_model(options.load_model(), config.warp.own_uv)
    space = make_texture_space(model, config.warp.size)
    scans: list[WarpedScan] = []

    def process(path: Path) -> None:
        fitted = fit_scan(path, model, options, config.output, config.fit, textured=True)
        scans.append(WarpedScan(fitted, warp_scan(fitted, model, space, config.warp)))

    code = process_scans(config.scan, options, config.output, process)
    if not scans:
        return code
    colours = config.colour.calibrate([scan.colours for scan in scans])
    for scan, exposure in zip(scans, colours.calibration.exposures, strict=True):
        record = write_scan_maps(scan, exposure, model, colours)
        path, stem = scan.fitted.scan.path, scan.fitted.stem
        files = [add_end(stem, end) for end in (*MAPS_ENDS, _RECORD_END)]
        print_result(describe_maps(path, stem, record), record, files, config.json)
    return code


def write_scan_maps(
    scan: WarpedScan, exposure: float, model: ShapeModel, colours: CalibratedColours
) -> dict[str, Any]:
    """Invert the texture of a scan and write its maps, unless the same inputs gave them before.

    Returns:
        The record of the maps.
    """
    path, stem = scan.fitted.scan.path, scan.fitted.stem
    fingerprint = compute_fingerprint(
        scan.fitted.fingerprint,
        scan.warped.image.tobytes().hex(),
        exposure,
        colours.settings,
        colours.colour.to_record(),
    )
    record = add_end(stem, _RECORD_END)
    files = [add_end(stem, end) for end in MAPS_ENDS]
    finished = read_finished(record, fingerprint, files)
    if finished is not None:
        log(f"{files[0]} is there already and is kept.")
        return finished
    texture, off_manifold = invert_texture(scan.warped, exposure, colours, str(path))
    source = scan.fitted.source
    write_maps(stem, texture, colours.colour, scan.fitted.mesh(model), source)
    summary = summarise_maps(scan, texture, off_manifold, exposure, colours)
    if off_manifold > _DOUBTFUL_SHARE:
        log(
            f"{path}: {off_manifold:.0%} of the texels have a colour that skin cannot have, so "
            "their pigments are doubtful; name the light and camera (--colour.light, .camera) or "
            "something white in the texture (--colour.white)."
        )
    return write_record(
        record, fingerprint, source.describe("maps", "summary", stem.parent) | summary
    )


def describe_maps(path: Path, stem: Path, record: dict[str, Any]) -> str:
    """Describe the maps of a scan in one line."""
    mean = ", ".join(f"{name} {record[name]['median']:.3g}" for name in ("melanin", "hemoglobin"))
    return (
        f"{path}: median {mean}; {record['off_manifold']:.1%} of the texels have a colour that "
        f"skin cannot have; {stem}_maps.npz, _panel.png, _face.obj"
    )


def summarise_maps(
    scan: WarpedScan,
    texture: SkinTexture,
    off_manifold: float,
    exposure: float,
    colours: CalibratedColours,
) -> dict[str, Any]:
    """Summarise the maps of a scan for their record."""
    mask = texture.mask
    levels = {"p05": 5, "median": 50, "p95": 95}
    pigments = {
        name: {key: float(np.percentile(values[mask], level)) for key, level in levels.items()}
        for name, values in (("melanin", texture.f_mel), ("hemoglobin", texture.f_blood))
    }
    return {
        "file": str(scan.fitted.scan.path),
        "rms_mm": scan.fitted.fit.rms,
        "texels": int(mask.sum()),
        "exposure": exposure,
        "transform": colours.calibration.transform.tolist(),
        "calibration": colours.calibration.record,
        "settings": asdict(colours.settings),
        "off_manifold": off_manifold,
        "offset_rms": float(np.sqrt(np.mean(texture.offset[mask] ** 2))),
        **pigments,
    }
