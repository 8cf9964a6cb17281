"""ICT-FaceKit's model of whole heads (Li et al. 2020), as an .npz."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float, Int, UInt8

from skinnet.errors import InputError
from skinnet.files._npz import read_npz
from train.synthetic.bodies.ict_chart import chart_skin
from train.synthetic.labels import EYE, MOUTH, SKIN, TEETH

_SCALE, _ORIGIN = 11.0, (0.0, 3.5, 0.0)
"""Centimetres in half a head, and the point between the ears at the height of the eyes."""

_MATERIALS = {"M_Face": SKIN, "M_BackHead": SKIN, "M_GumsTongue": MOUTH, "M_Teeth": TEETH,
             "M_ScleraLeft": EYE, "M_ScleraRight": EYE}  # fmt: skip
"""Materials that are used, and their labels; the iris is painted on the sclera's ball."""

FIRST_INNER_VERTEX = 11248
"""From this vertex on, the skin's triangles line the mouth and the eye sockets."""

EYEBALLS = ((21451, 23021), (23021, 24591))
"""First vertex of each eyeball, and the one after its last."""

ARRAYS = {"verts": (None, 3), "id_modes": (None, None, 3), "expr_modes": (None, None, 3),
          "expr_names": (None,), "tris": (None, 3), "tri_material": (None,),
          "material_names": (None,), "landmarks68": (68,)}  # fmt: skip
"""Arrays of the file and their shapes; None is any number."""


@dataclass(frozen=True)
class IctModel:
    """The model in half heads: identity modes of one standard deviation, expressions by name."""

    mean: Float[np.ndarray, "vertices 3"]
    identities: Float[np.ndarray, "identities vertices 3"]
    expressions: Float[np.ndarray, "expressions vertices 3"]
    names: tuple[str, ...]
    triangles: Int[np.ndarray, "triangles 3"]
    label: UInt8[np.ndarray, "triangles"]
    chart: Float[np.ndarray, "vertices 2"]


def read_ict_model(path: Path) -> IctModel:
    """Read the model.

    Args:
        path: An .npz with the arrays in `ARRAYS`, in centimetres.

    Returns:
        The model in half heads, with the chart of its skin.

    Raises:
        InputError: If the file or one of its arrays is not as it should be.
    """
    arrays = _read_arrays(path)
    mean = (arrays["verts"].astype(np.float64) - _ORIGIN) / _SCALE
    material = arrays["material_names"].astype(str)[arrays["tri_material"]]
    triangles = arrays["tris"].astype(np.int64)
    used = np.isin(material, list(_MATERIALS))
    triangles = triangles[used]
    label = np.array([_MATERIALS[name] for name in material[used]], np.uint8)
    label[(label == SKIN) & (triangles.max(1) >= FIRST_INNER_VERTEX)] = MOUTH
    return IctModel(
        mean,
        (arrays["id_modes"] / _SCALE).astype(np.float32),
        (arrays["expr_modes"] / _SCALE).astype(np.float32),
        tuple(arrays["expr_names"].astype(str)),
        triangles,
        label,
        chart_skin(mean, arrays["landmarks68"]),
    )


def _read_arrays(path: Path) -> dict[str, np.ndarray]:
    try:
        arrays = read_npz(path, ARRAYS)
    except InputError:
        raise
    except KeyError as error:
        raise InputError(
            f"{path} lacks {error.args[0]}; an .npz of ICT-FaceKit holds {', '.join(ARRAYS)}."
        ) from error
    except FileNotFoundError as error:
        raise InputError(
            f"{path} cannot be read as an .npz of arrays: it is not there; python -m "
            f"tools.ict_facekit ICT-FaceKit -o {path} makes it."
        ) from error
    except (OSError, ValueError) as error:
        raise InputError(f"{path} cannot be read as an .npz of arrays; copy it again.") from error
    for name, shape in ARRAYS.items():
        found = arrays[name].shape
        known = [k if n is None else n for n, k in zip(shape, found, strict=False)]
        if len(found) != len(shape) or tuple(known) != found:
            raise InputError(f"{path}: {name} is {found}, which is not the shape of ICT-FaceKit's.")
    vertices = len(arrays["verts"])
    fits = (
        arrays["id_modes"].shape[1] == vertices == arrays["expr_modes"].shape[1]
        and len(arrays["expr_modes"]) == len(arrays["expr_names"])
        and len(arrays["tri_material"]) == len(arrays["tris"])
        and EYEBALLS[-1][-1] <= vertices
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
