"""A statistical shape model: faces in correspondence as a mean and linear modes."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from jaxtyping import Bool, Float, Int

from skinnet.errors import InputError
from skinnet.mesh.mesh import Mesh

Numbers = Float[np.ndarray, "..."]
Indices = Int[np.ndarray, "..."]


@dataclass(frozen=True)
class ShapeModel:
    """shape(alpha) = mean + sum_k alpha_k basis_k (Alotaibi & Smith 2017, section 4.1).

    `mean` [N, 3] and `basis` [S, N, 3] in the model's unit, of `millimetres` each; x points to the
    face's left, y up, z forward. `variances` [S] are those of alpha over people. `uv` [U, 2] and
    `uv_triangles` [T, 3] are the model's own texture space, None until one is made. `landmarks`
    gives the vertex of each named point (`skinnet.shape.landmarks`). Arrays out of a file go
    through `checked_model`.
    """

    mean: Float[np.ndarray, "vertices 3"]
    basis: Float[np.ndarray, "modes vertices 3"]
    variances: Float[np.ndarray, "modes"]
    triangles: Int[np.ndarray, "triangles 3"]
    uv: Float[np.ndarray, "points 2"] | None = None
    uv_triangles: Int[np.ndarray, "triangles 3"] | None = None
    landmarks: Mapping[str, int] = field(default_factory=dict)
    millimetres: float = 1.0
    name: str = "model"

    def reconstruct(self, alpha: Float[np.ndarray, "modes"]) -> Float[np.ndarray, "vertices 3"]:
        """Vertices of the face with these coefficients; fewer than S stand for the first."""
        return self.mean + np.tensordot(alpha, self.basis[: len(alpha)], 1)

    def build_mesh(self, alpha: Float[np.ndarray, "modes"]) -> Mesh:
        """The face with these coefficients as a mesh without a texture."""
        return Mesh(
            self.reconstruct(alpha), self.triangles, self.uv, self.uv_triangles, name=self.name
        )

    def truncate(self, modes: int) -> "ShapeModel":
        """The model's first modes. Raises `InputError` if it has fewer."""
        if not 0 < modes <= len(self.variances):
            raise InputError(
                f"{self.name} has {len(self.variances)} modes, and {modes} are asked for; ask for "
                "fewer, or give a model of more subjects."
            )
        return replace(self, basis=self.basis[:modes], variances=self.variances[:modes])

    def crop(self, keep: Bool[np.ndarray, "vertices"]) -> "ShapeModel":
        """The model of some vertices, with the triangles and landmarks that lie wholly on them."""
        number = np.cumsum(keep) - 1
        inside = keep[self.triangles].all(1)
        uv, uv_triangles = self.uv, self.uv_triangles
        if uv is not None and uv_triangles is not None:
            used, place = np.unique(uv_triangles[inside], return_inverse=True)
            uv, uv_triangles = uv[used], place.reshape(-1, 3)
        return replace(
            self,
            mean=self.mean[keep],
            basis=self.basis[:, keep],
            triangles=number[self.triangles[inside]],
            uv=uv,
            uv_triangles=uv_triangles,
            landmarks={name: int(number[i]) for name, i in self.landmarks.items() if keep[i]},
        )


def checked_model(
    mean: Numbers,
    basis: Numbers,
    variances: Numbers,
    triangles: Indices,
    uv: Numbers | None = None,
    uv_triangles: Indices | None = None,
    landmarks: Mapping[str, int] | None = None,
    millimetres: float = 1.0,
    name: str = "model",
) -> ShapeModel:
    """A model of arrays that are not known to belong together.

    Raises `InputError` naming the model and the fault: shapes that disagree, values that are NaN or
    infinite, negative variances, triangles or landmarks out of range.
    """
    marks = {} if landmarks is None else dict(landmarks)
    fault = (
        _disagreement(mean, basis, variances)
        or _bad_triangles(triangles, len(mean), "vertices")
        or _bad_texture(triangles, uv, uv_triangles)
        or _bad_values({"mean": mean, "basis": basis, "variances": variances, "uv": uv})
    )
    outside = [mark for mark, vertex in marks.items() if not 0 <= vertex < len(mean)]
    if not fault and (variances < 0).any():
        fault = f"a variance is {variances.min():.3g}, and none is negative"
    if not fault and outside:
        fault = f"landmark {outside[0]} is vertex {marks[outside[0]]} of {len(mean):,}"
    if not fault and not millimetres > 0:
        fault = f"its unit is {millimetres} millimetres"
    if fault:
        raise InputError(f"{name} is no shape model that can be used: {fault}.")
    return ShapeModel(mean, basis, variances, triangles, uv, uv_triangles, marks, millimetres, name)


def _disagreement(mean: Numbers, basis: Numbers, variances: Numbers) -> str | None:
    if mean.ndim != 2 or mean.shape[1] != 3 or not mean.size:
        return f"its mean is {list(mean.shape)} and not [vertices, 3]"
    if basis.ndim != 3 or basis.shape[1:] != mean.shape or not basis.size:
        return (
            f"its basis is {list(basis.shape)} and does not agree with its mean {list(mean.shape)}"
        )
    if variances.shape != basis.shape[:1]:
        return f"it has {len(basis)} modes and variances {list(variances.shape)}"
    return None


def _bad_triangles(triangles: Indices, count: int, what: str) -> str | None:
    if triangles.ndim != 2 or triangles.shape[1] != 3 or not triangles.size:
        return f"its triangles are {list(triangles.shape)} and not [triangles, 3]"
    if triangles.min() < 0 or triangles.max() >= count:
        return f"its triangles go from {triangles.min()} to {triangles.max()} of {count:,} {what}"
    return None


def _bad_texture(triangles: Indices, uv: Numbers | None, own: Indices | None) -> str | None:
    if uv is None and own is None:
        return None
    if uv is None or own is None or uv.ndim != 2 or uv.shape[1] != 2:
        return "its texture coordinates are not [points, 2] with triangles into them"
    if own.shape != triangles.shape:
        return f"it has triangles {list(triangles.shape)}, and {list(own.shape)} for its texture"
    return _bad_triangles(own, len(uv), "texture coordinates")


def _bad_values(arrays: Mapping[str, Numbers | None]) -> str | None:
    for name, array in arrays.items():
        if array is None:
            continue
        with np.errstate(invalid="ignore"):
            total = array.sum(dtype=np.float64)
        # The sum is finite where all values are, and needs no array of its own.
        if not np.isfinite(total):
            return f"its {name} has values that are NaN or infinite"
    return None
