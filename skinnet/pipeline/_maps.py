"""`skinnet maps`: scans to maps of melanin and hemoglobin in a model's texture space."""

from dataclasses import asdict, dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import torch
from jaxtyping import Float
from jsonargparse import ArgumentParser, Namespace

from skinnet.appearance.skin_texture import SkinTexture
from skinnet.errors import InputError
from skinnet.files import write_atomically
from skinnet.pipeline._fit_shape import Fitted, fitted
from skinnet.pipeline._maps_writer import ENDS, write_maps
from skinnet.pipeline._progress import digest, finished, log, write_record
from skinnet.pipeline._scans import add_scan_arguments, each_scan, scan_options
from skinnet.pipeline.calibrate import Colours, ColourSettings
from skinnet.shape.fit_settings import FitSettings
from skinnet.shape.model import ShapeModel
from skinnet.texture.mirror import find_mirror_vertices
from skinnet.texture.projection import MAX_NORMAL_ANGLE, project_texture
from skinnet.texture.tutte import compute_tutte_embedding
from skinnet.texture.warp import TextureSpace, WarpedTexture

DOUBTFUL = 0.5
"""Share of texels off the manifold above which maps are doubtful."""


@dataclass(frozen=True)
class WarpSettings:
    """How a scan's texture comes into the model's texture space (section 4.2).

    Args:
        size: texels along a side of the maps.
        limit: distance in mm between model and scan above which a texel is not covered.
        angle: angle in degrees between their normals above which it is not covered.
        own_uv: use the model's own texture coordinates in place of a Tutte embedding of its mean.
    """

    size: int = 1024
    limit: float = 5.0
    angle: float = MAX_NORMAL_ANGLE
    own_uv: bool = False

    def __post_init__(self) -> None:
        if not 16 <= self.size <= 8192:
            raise InputError(f"size is a number of texels from 16 to 8192; got {self.size}.")


def embedded(model: ShapeModel, own_uv: bool = False) -> ShapeModel:
    """The model with a Tutte embedding of its mean as texture space, or with its own."""
    if own_uv:
        if model.uv is None:
            raise InputError(f"{model.name} has no texture coordinates; leave out own_uv.")
        return model
    mean = model.mean.astype(np.float64)
    uv = compute_tutte_embedding(mean, model.triangles, find_mirror_vertices(mean))
    return replace(model, uv=uv, uv_triangles=model.triangles)


def texture_space(model: ShapeModel, size: int) -> TextureSpace:
    """The texels of an embedded model."""
    assert model.uv is not None and model.uv_triangles is not None  # `embedded` saw to it
    return TextureSpace(model.uv, model.uv_triangles, size)


@dataclass(frozen=True)
class Skin:
    """One scan on its way: the fit, and its texture in the model's space."""

    fitted: Fitted
    warped: WarpedTexture

    @cached_property
    def colours(self) -> Float[np.ndarray, "n 3"]:
        """Linear RGB [n, 3] of the texels that the scan covers."""
        return np.asarray(self.warped.image[self.warped.mask])


def add_arguments(parser: ArgumentParser) -> None:
    """Scans, model, output, and the settings of each step."""
    add_scan_arguments(parser)
    parser.add_class_arguments(FitSettings, "fit")
    parser.add_class_arguments(WarpSettings, "warp")
    parser.add_class_arguments(ColourSettings, "colour")


def run(config: Namespace) -> int:
    """Fit, warp, calibrate on all scans together, invert; what is on disk already is kept."""
    options = scan_options(config)
    config.colour.check()
    model = embedded(options.load_model(), config.warp.own_uv)
    space = texture_space(model, config.warp.size)
    skins: list[Skin] = []

    def one(path: Path) -> None:
        fit = fitted(path, model, options, config.output, config.fit, textured=True)
        skins.append(Skin(fit, warped(fit, model, space, config.warp)))

    code = each_scan(config.scan, options, config.output, one)
    if not skins:
        return code
    colours = config.colour.calibrated([skin.colours for skin in skins])
    for skin, factor in zip(skins, colours.found.exposures, strict=True):
        inverted(skin, factor, model, colours)
    return code


def warped(
    fit: Fitted, model: ShapeModel, space: TextureSpace, settings: WarpSettings
) -> WarpedTexture:
    """A scan's texture in the model's space, from disk if it was made before."""
    file, record = (fit.stem.with_name(f"{fit.stem.name}_warp.{end}") for end in ("npz", "json"))
    fingerprint = digest(fit.fingerprint, settings, space.uv.tobytes().hex())
    if finished(record, fingerprint, [file]):
        with np.load(file, allow_pickle=False) as found:
            return WarpedTexture(found["image"], found["mask"])
    limit = settings.limit / fit.found.millimetres
    made = project_texture(space, fit.mesh(model), fit.scan.mesh, limit, settings.angle)
    covered = made.mask.sum() / space.mask.sum()
    if not covered:
        raise InputError(
            f"{fit.scan.path}: no texel of the model lies within {settings.limit:g} mm of the "
            f"scan; look at {fit.stem}_shape.png."
        )
    with write_atomically(file) as part:
        np.savez(part, image=made.image, mask=made.mask)
    write_record(record, fingerprint, {"covered": float(covered)})
    log(f"{fit.scan.path}: {covered:.0%} of the model's texels are covered by the scan.")
    return made


def inverted(skin: Skin, factor: float, model: ShapeModel, colours: Colours) -> None:
    """Invert one scan's texture and write its maps; those made before from the same are kept."""
    stem = skin.fitted.stem
    record = stem.with_name(f"{stem.name}_maps.json")
    fingerprint = digest(
        skin.fitted.fingerprint,
        skin.warped.image.tobytes().hex(),
        factor,
        colours.settings,
        colours.colour.to_record(),
    )
    files = [stem.with_name(stem.name + end) for end in ENDS]
    if finished(record, fingerprint, files) is not None:
        log(f"{files[0]} is there already and is kept.")
        return
    texture, off = invert(skin.warped, factor, colours, str(skin.fitted.scan.path))
    face = skin.fitted.mesh(model)
    write_maps(stem, texture, colours.colour, face)
    found = write_record(record, fingerprint, summary(skin, texture, off, factor, colours))
    if off > DOUBTFUL:
        log(
            f"{skin.fitted.scan.path}: {off:.0%} of the texels lie off the colours of skin, and "
            "their pigments mean little; name the light and camera (--colour.light, .camera) or "
            "something white in the texture (--colour.white)."
        )
    mean = ", ".join(f"{name} {found[name]['median']:.3g}" for name in ("melanin", "hemoglobin"))
    print(
        f"{skin.fitted.scan.path}: median {mean}; {off:.1%} of the texels lie off the colours of "
        f"skin; {stem}_maps.npz, _panel.png, _face.obj",
        flush=True,
    )


def invert(
    warped: WarpedTexture, factor: float, colours: Colours, name: str
) -> tuple[SkinTexture, float]:
    """Maps of a texture's colours times `factor`, and the share of them off the skin manifold."""
    mask = warped.mask
    gain = factor * colours.settings.balance()
    rgb = (gain * warped.image[mask]).astype(np.float32)
    found = colours.inverse(torch.from_numpy(rgb), colours.settings.refine)
    maps = [np.zeros((*mask.shape, *one.shape[1:]), np.float32) for one in found[:3]]
    for whole, part in zip(maps, found[:3], strict=True):
        whole[mask] = part.numpy()
    f_mel, f_blood, _ = maps
    bare = SkinTexture(f_mel, f_blood, np.zeros((*mask.shape, 3), np.float32), mask, name)
    # The offset is taken from the table that will add it again, so that the texture comes back.
    offset = np.zeros((*mask.shape, 3), np.float32)
    offset[mask] = rgb - bare.albedo(colours.colour)[mask]
    return replace(bare, offset=offset), float(1 - found.on_manifold.float().mean())


def summary(
    skin: Skin, texture: SkinTexture, off: float, factor: float, colours: Colours
) -> dict[str, Any]:
    """What the record of a scan's maps says."""
    mask = texture.mask
    levels = {"p05": 5, "median": 50, "p95": 95}
    pigments = {
        name: {key: float(np.percentile(values[mask], level)) for key, level in levels.items()}
        for name, values in (("melanin", texture.f_mel), ("hemoglobin", texture.f_blood))
    }
    return {
        "file": str(skin.fitted.scan.path),
        "rms_mm": skin.fitted.found.rms,
        "texels": int(mask.sum()),
        "exposure": factor,
        "transform": colours.found.transform.tolist(),
        "calibration": colours.found.record,
        "settings": asdict(colours.settings),
        "off_manifold": off,
        "offset_rms": float(np.sqrt(np.mean(texture.offset[mask] ** 2))),
        **pigments,
    }
