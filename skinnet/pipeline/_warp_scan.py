"""The warp of a scan's texture into the model's texture space (section 4.2 of the paper)."""

import json

import numpy as np

from skinnet.errors import InputError
from skinnet.files import READ_ERRORS, write_atomically
from skinnet.files._npz import read_npz
from skinnet.inference._messages import log
from skinnet.pipeline._fit_shape import FittedScan
from skinnet.pipeline._output import add_end
from skinnet.pipeline._progress import compute_fingerprint, read_finished, write_record
from skinnet.pipeline.texture_space import WarpSettings
from skinnet.shape.model import ShapeModel
from skinnet.texture.projection import project_texture
from skinnet.texture.warp import TextureSpace, WarpedTexture


def make_texture_space(model: ShapeModel, size: int) -> TextureSpace:
    """Make the texture space of an embedded model."""
    assert model.uv is not None and model.uv_triangles is not None  # `embed_model` gives both
    return TextureSpace(model.uv, model.uv_triangles, size)


def warp_scan(
    fitted: FittedScan, model: ShapeModel, space: TextureSpace, settings: WarpSettings
) -> WarpedTexture:
    """Warp a scan's texture into the model's space, or read the earlier result of these inputs."""
    file, record = (add_end(fitted.stem, end) for end in ("_warp.npz", "_warp.json"))
    fingerprint = compute_fingerprint(fitted.fingerprint, settings, space.uv.tobytes().hex())
    if read_finished(record, fingerprint, [file]):
        try:
            return WarpedTexture(**read_npz(file, ("image", "mask")))
        except READ_ERRORS:
            log(f"{file} is damaged, and is made again.")
    limit = settings.limit / fitted.fit.millimetres
    warped = project_texture(space, fitted.mesh(model), fitted.scan.mesh, limit, settings.angle)
    covered = warped.mask.sum() / space.mask.sum()
    if not covered:
        raise InputError(
            f"{fitted.scan.path}: no texel of the model lies within {settings.limit:g} mm of the "
            f"scan; look at {fitted.stem}_shape.png."
        )
    origin = fitted.source.describe("maps", "warp", file.parent)
    with write_atomically(file) as part:
        np.savez(part, image=warped.image, mask=warped.mask, origin=np.array(json.dumps(origin)))
    write_record(record, fingerprint, origin | {"covered": float(covered)})
    log(f"{fitted.scan.path}: {covered:.0%} of the model's texels are covered by the scan.")
    return warped
