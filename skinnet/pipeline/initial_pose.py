"""The pose of an upright face whose front is towards +z, found without landmarks."""

from itertools import product

import numpy as np
from jaxtyping import Float, UInt8

from skinnet.errors import NoFaceError
from skinnet.images.faces._largest import choose_largest
from skinnet.images.faces.finder import find_faces
from skinnet.mesh.mesh import Mesh
from skinnet.render.scene import Scene
from skinnet.render.views import OrthographicView
from skinnet.render.visibility import GeometryBuffers, trace_geometry
from skinnet.shape._icp import IcpStage
from skinnet.shape._scan_points import ScanPoints
from skinnet.shape.fit_settings import FitSettings
from skinnet.shape.model import ShapeModel
from skinnet.shape.similarity import Similarity

PIXELS = 500
"""Height and width of the picture in which the face is detected."""

_LIGHT = np.array([0.3, 0.5, 0.8])
"""Vector to the light of that picture."""

_SHIFTS, _SIZES = (-0.1, -0.05, 0.0, 0.05, 0.1), (0.9, 1.0, 1.1)
"""Vertical shifts in widths of the face, and scales, of the poses that are tried."""


def find_initial_pose(model: ShapeModel, scan: Mesh) -> Similarity:
    """Find the pose of the mean face on a scan from face detections in pictures of both.

    Both are rendered from the front as grey plaster, so a texture has no influence. The detection
    is accurate to a tenth of the face's size. Of several poses near it, the one with the best rigid
    fit is chosen.

    Args:
        model: The shape model, upright, its front towards +z.
        scan: The scan, upright, its front towards +z, in any unit.

    Returns:
        The pose, from the model's frame and unit to the scan's: the `start` for `register`.

    Raises:
        NoFaceError: If no face is detected.
    """
    mean = model.build_mesh(np.zeros(0))
    (model_place, model_width), (place, width) = (_locate_face(mesh) for mesh in (mean, scan))
    rigid = FitSettings(kept=0.9, iterations=10)
    stage = IcpStage(model, ScanPoints(scan), rigid, np.zeros(0), 800, 1, 1e3)
    candidates = []
    for shift, size in product(_SHIFTS, _SIZES):
        scale = size * width / model_width
        lifted = place + np.array([0, shift * width, 0])
        pose = Similarity(np.eye(3), scale, lifted - scale * model_place)
        pose, _, record = stage.run(pose, np.zeros(1))
        candidates.append((record.rms[-1], pose))
    return min(candidates, key=lambda one: one[0])[1]


def _locate_face(mesh: Mesh) -> tuple[Float[np.ndarray, "3"], float]:
    """Find the point of the mesh in the middle of its face, and the width of the detector's box."""
    low, high = mesh.vertices.min(0), mesh.vertices.max(0)
    scale = PIXELS / (1.1 * float((high - low)[:2].max()))
    eye = np.array([*(low + high)[:2] / 2, high[2] + 1 / scale])
    view = OrthographicView((PIXELS, PIXELS), eye, np.eye(3), scale)
    buffers = trace_geometry(Scene(mesh), view)
    face = choose_largest(find_faces(_shade_plaster(buffers)))
    if face is None:
        raise NoFaceError(
            f"No face was found on {mesh.name} from the front; rotate it upright, with the face "
            "towards +z, or give landmarks."
        )
    box = face.box
    column, row = (box.left + box.right) / 2, (box.top + box.bottom) / 2
    width = box.width / scale
    middle = eye[:2] + np.array([column - PIXELS / 2, PIXELS / 2 - row]) / scale
    near = np.linalg.norm(buffers.position[:, :2] - middle, axis=1) < 0.3 * width
    return np.array([*middle, buffers.position[near, 2].max()]), width


def _shade_plaster(buffers: GeometryBuffers) -> UInt8[np.ndarray, "height width 3"]:
    shade = 200 * (0.35 + 0.65 * buffers.normal @ _LIGHT).clip(0, 1)
    picture = np.full(buffers.hit.shape, 200, np.uint8)
    picture[buffers.hit] = shade.astype(np.uint8)
    return np.repeat(picture[..., None], 3, 2)
