"""Heads of ICT-FaceKit's shape model (Li et al. 2020) with expressions and eyes that look about."""

from dataclasses import dataclass
from pathlib import Path
from zipfile import BadZipFile

import numpy as np
from jaxtyping import Float, Int, UInt8
from scipy.interpolate import RBFInterpolator

from skinnet.errors import InputError
from train.synthetic.body import Neck
from train.synthetic.expression import expression
from train.synthetic.labelled_mesh import Part, clipped, joined, part
from train.synthetic.labels import EYE, MOUTH, SKIN, TEETH

SCALE, MIDDLE = 11.0, (0.0, 3.5, 0.0)
"""Centimetres in half a head, and the point between the ears at the height of the eyes."""

MATERIALS = {"M_Face": SKIN, "M_BackHead": SKIN, "M_GumsTongue": MOUTH, "M_Teeth": TEETH,
             "M_ScleraLeft": EYE, "M_ScleraRight": EYE}  # fmt: skip
"""What is drawn; the iris is painted on the ball that surrounds it."""

SOCKETS = 11248
"""From this vertex on, the head's triangles line the mouth and the eyes' sockets."""

BALLS = ((21451, 23021), (23021, 24591))
IRIS = 0.395
"""Radians between the gaze and the iris' edge: 5.9 mm on a ball of 15.3 mm."""

NECK = -1.5
SHAPES = {"verts": (None, 3), "id_modes": (None, None, 3), "expr_modes": (None, None, 3),
          "expr_names": (None,), "tris": (None, 3), "tri_material": (None,),
          "material_names": (None,), "landmarks68": (68,)}  # fmt: skip


@dataclass(frozen=True)
class IctHead:
    """The model in half heads: modes scaled by their standard deviation, expressions by name."""

    mean: Float[np.ndarray, "vertices 3"]
    identities: Float[np.ndarray, "identities vertices 3"]
    expressions: Float[np.ndarray, "expressions vertices 3"]
    names: tuple[str, ...]
    triangles: Int[np.ndarray, "triangles 3"]
    label: UInt8[np.ndarray, "triangles"]
    chart: Float[np.ndarray, "vertices 2"]


def load_ict_head(path: Path) -> IctHead:
    """The model of an .npz with the arrays in `SHAPES`; raises `InputError` if one is amiss."""
    arrays = _checked(path)
    mean = (arrays["verts"].astype(np.float64) - MIDDLE) / SCALE
    material = arrays["material_names"].astype(str)[arrays["tri_material"]]
    triangles = arrays["tris"].astype(np.int64)
    drawn = np.isin(material, list(MATERIALS))
    triangles = triangles[drawn]
    label = np.array([MATERIALS[name] for name in material[drawn]], np.uint8)
    label[(label == SKIN) & (triangles.max(1) >= SOCKETS)] = MOUTH
    return IctHead(
        mean,
        (arrays["id_modes"] / SCALE).astype(np.float32),
        (arrays["expr_modes"] / SCALE).astype(np.float32),
        tuple(arrays["expr_names"].astype(str)),
        triangles,
        label,
        skin_chart(mean, arrays["landmarks68"]),
    )


def _checked(path: Path) -> dict[str, np.ndarray]:
    try:
        # A file of our own is closed even if NumPy finds it is no .npz.
        with path.open("rb") as stream, np.load(stream, allow_pickle=False) as file:
            arrays = {name: file[name] for name in SHAPES}
    except KeyError as error:
        raise InputError(
            f"{path} lacks {error.args[0].split()[0]}; an .npz of ICT-FaceKit holds "
            f"{', '.join(SHAPES)}."
        ) from error
    except (OSError, ValueError, EOFError, TypeError, BadZipFile) as error:
        raise InputError(f"{path} cannot be read as an .npz of arrays; copy it again.") from error
    for name, shape in SHAPES.items():
        found = arrays[name].shape
        known = [k if n is None else n for n, k in zip(shape, found, strict=False)]
        if len(found) != len(shape) or tuple(known) != found:
            raise InputError(f"{path}: {name} is {found}, which is no array of ICT-FaceKit's.")
    vertices = len(arrays["verts"])
    fits = (
        arrays["id_modes"].shape[1] == vertices == arrays["expr_modes"].shape[1]
        and len(arrays["expr_modes"]) == len(arrays["expr_names"])
        and len(arrays["tri_material"]) == len(arrays["tris"])
        and BALLS[-1][-1] <= vertices
        and 0 <= arrays["tris"].min() <= arrays["tris"].max() < vertices
        and 0 <= arrays["landmarks68"].min() <= arrays["landmarks68"].max() < vertices
        and 0 <= arrays["tri_material"].min()
        and arrays["tri_material"].max() < len(arrays["material_names"])
    )
    if not fits:
        raise InputError(
            f"{path}: its vertices ({vertices:,}), modes, triangles and landmarks do not belong "
            "together; the file was put together from different releases."
        )
    return arrays


def bare_ict(model: IctHead, draw: np.random.Generator) -> tuple[Part, Neck]:
    """A bald head of a drawn person with a mild expression, and the foot of its neck."""
    person = 0.9 * draw.normal(0, 1, len(model.identities)).clip(-2.5, 2.5)
    gaze = draw.normal(0, (0.10, 0.06)).clip(-0.2, 0.2)
    weights = expression(model.names, gaze, draw)
    shape = model.mean + np.tensordot(person.astype(np.float32), model.identities, 1)
    active = np.flatnonzero(weights)
    moved = np.tensordot(weights[active].astype(np.float32), model.expressions[active], 1)
    shape, chart = shape + moved, model.chart.copy()
    for first, end in BALLS:
        ball = model.mean[first:end]
        chart[first:end] = _iris(ball)
        shape[first:end] = _turned(shape[first:end], gaze)
    inside = np.isin(np.arange(len(shape)), model.triangles[np.isin(model.label, (TEETH, MOUTH))])
    inside &= np.arange(len(shape)) >= SOCKETS
    chart[inside] = shape[inside, :2]
    parts = [
        part(shape, model.triangles[model.label == label], label, chart)
        for label in (SKIN, MOUTH, TEETH, EYE)
    ]
    parts[0] = clipped(parts[0], parts[0].vertices[:, 1] - NECK)
    return joined(parts), _neck(parts[0])


def _iris(ball: Float[np.ndarray, "points 3"]) -> Float[np.ndarray, "points 2"]:
    """Angles from an eye's axis in iris radii."""
    x, y, z = (ball - _centre(ball)).T
    across = np.hypot(x, y)
    return np.stack([x, y], 1) * (np.arctan2(across, z) / IRIS / across.clip(1e-9))[:, None]


def _centre(ball: Float[np.ndarray, "points 3"]) -> Float[np.ndarray, "3"]:
    """Middle of an eyeball, whose cornea bulges ahead."""
    low, high = ball.min(0), ball.max(0)
    middle = (low + high) / 2
    middle[2] = low[2] + (high - low)[:2].mean() / 2
    return middle


def _turned(
    ball: Float[np.ndarray, "points 3"], gaze: Float[np.ndarray, "2"]
) -> Float[np.ndarray, "points 3"]:
    """An eyeball that looks `gaze` radians to the face's left and up."""
    (a, b), (p, q) = np.cos(gaze), np.sin(gaze)
    left = np.array([[a, 0, p], [0, 1, 0], [-p, 0, a]])
    up = np.array([[1, 0, 0], [0, b, q], [0, -q, b]])
    middle = _centre(ball)
    return (ball - middle) @ (left @ up).T + middle


def _neck(skin: Part) -> Neck:
    ring = skin.vertices[np.abs(skin.vertices[:, 1] + 1.25) < 0.1]
    low, high = ring.min(0), ring.max(0)
    x, _, z = (low + high) / 2
    return Neck(float(x), float(z), float((high - low)[0] / 2), float((high - low)[2] / 2))


# Landmarks of the mean (numbers of iBUG's 68 on the face's left, or several whose middle is meant)
# and where `train.synthetic.face_painting` paints them: azimuth, elevation.
PLACES: tuple[tuple[tuple[int, ...], tuple[float, float]], ...] = (
    ((42,), (0.205, 0.012)), ((45,), (0.475, 0.028)), ((43,), (0.295, 0.060)),
    ((44,), (0.385, 0.062)), ((46,), (0.385, -0.018)), ((47,), (0.295, -0.018)),
    ((22,), (0.13, 0.195)), ((23,), (0.24, 0.205)), ((24,), (0.36, 0.208)),
    ((25,), (0.47, 0.205)), ((26,), (0.58, 0.185)),
    ((27,), (0.0, 0.04)), ((28,), (0.0, -0.08)), ((29,), (0.0, -0.20)), ((30,), (0.0, -0.33)),
    ((33,), (0.0, -0.47)), ((34,), (0.065, -0.452)), ((35,), (0.14, -0.43)),
    ((54,), (0.205, -0.655)), ((51,), (0.0, -0.600)), ((52,), (0.065, -0.588)),
    ((53,), (0.135, -0.615)), ((62, 66), (0.0, -0.66)), ((63, 65), (0.085, -0.66)),
    ((55,), (0.14, -0.710)), ((56,), (0.075, -0.732)), ((57,), (0.0, -0.738)),
    ((8,), (0.0, -1.10)),
)  # fmt: skip


def skin_chart(
    mean: Float[np.ndarray, "vertices 3"], landmarks: Int[np.ndarray, "68"]
) -> Float[np.ndarray, "vertices 2"]:
    """Azimuth and elevation of each vertex on the chart of `skinnet.shape.procedural_head`.

    A thin-plate spline takes the mean's own angles to those at which its features are painted.
    """
    own = _angles(mean)
    marks = _angles(mean[landmarks])
    source = [marks[list(numbers)].mean(0) for numbers, _ in PLACES]
    target = [np.array(place) for _, place in PLACES]
    for place, chart in EARS + tuple((place, place) for place in _anchors()):
        source.append(np.array(place))
        target.append(np.array(chart))
    source, target = (
        np.concatenate([x, x * [-1, 1]]) for x in (np.array(source), np.array(target))
    )
    source, once = np.unique(source.round(9), axis=0, return_index=True)
    spline = RBFInterpolator(source, target[once], kernel="thin_plate_spline", smoothing=1e-6)
    chart = spline(own)
    chart[:, 1] -= 0.4 * (-1.02 - mean[:, 1]).clip(0)
    return chart


EARS = (((1.61, -0.20), (1.5, -0.10)), ((1.61, 0.06), (1.5, 0.11)), ((1.58, -0.46), (1.5, -0.30)),
        ((1.44, -0.20), (1.36, -0.12)), ((1.76, -0.20), (1.64, -0.12)))  # fmt: skip
"""Middle, top, lobe, front and back of the ear at the mean's own angles, and on the chart."""


def _anchors() -> list[tuple[float, float]]:
    """Places far from the features, where the head's own angles serve."""
    around = [(a, e) for a in (2.0, 2.6, np.pi) for e in (-1.2, -0.8, -0.4, 0.0, 0.4, 0.8)]
    top = [(a, e) for a in (0.0, 0.5, 1.0, 1.5, 2.2, np.pi) for e in (0.65, 1.0, 1.3)]
    return around + top + [(0.9, -0.85), (1.1, -0.5), (1.0, 0.35), (0.5, -1.25), (1.5, -0.9)]


def _angles(points: Float[np.ndarray, "points 3"]) -> Float[np.ndarray, "points 2"]:
    length = np.linalg.norm(points, axis=1).clip(1e-9)
    return np.stack(
        [np.arctan2(points[:, 0], points[:, 2]), np.arcsin((points[:, 1] / length).clip(-1, 1))], 1
    )
