"""A statistical shape model: faces in correspondence as a mean and linear modes."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from jaxtyping import Bool, Float, Int

from skinnet.errors import InputError
from skinnet.mesh.mesh import Mesh


@dataclass(frozen=True)
class ShapeModel:
    """A linear model of face shapes: vertices = mean + sum_k alpha_k basis_k.

    x points to the face's left, y up, z forward. The constructor takes arrays as they are; use
    `from_arrays` for arrays from a file.

    Attributes:
        mean: Vertices of the mean face, in the model's unit.
        basis: Modes, in the model's unit.
        variances: Variance of each coefficient alpha_k over people.
        triangles: Vertices of each triangle, counter-clockwise as seen from outside.
        uv: Texture coordinates in [0, 1]; None for a model without a texture space.
        uv_triangles: Texture coordinates of each triangle's corners.
        landmarks: Vertex of each named point; `IBUG` lists the names that a fit uses.
        millimetres: Length of the model's unit in mm.
        name: What error messages call the model, usually its path.

    Source:
        Section 4.1 of Alotaibi & Smith 2017.

    Example:
        >>> import numpy as np
        >>> from skinnet.shape import ShapeModel
        >>> mean, basis = np.eye(3), np.ones((1, 3, 3))
        >>> model = ShapeModel(mean, basis, np.ones(1), np.array([[0, 1, 2]]))
        >>> model.reconstruct(np.array([2.0]))[0]
        array([3., 2., 2.])
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

    @classmethod
    def from_arrays(
        cls,
        mean: Float[np.ndarray, "..."],
        basis: Float[np.ndarray, "..."],
        variances: Float[np.ndarray, "..."],
        triangles: Int[np.ndarray, "..."],
        uv: Float[np.ndarray, "..."] | None = None,
        uv_triangles: Int[np.ndarray, "..."] | None = None,
        landmarks: Mapping[str, int] | None = None,
        millimetres: float = 1.0,
        name: str = "model",
    ) -> "ShapeModel":
        """Make a model of arrays, and check that they belong together.

        Args:
            mean: Vertices [N, 3] of the mean face, in the model's unit.
            basis: Modes [S, N, 3], in the model's unit.
            variances: Variances [S] of the coefficients, 0 or more.
            triangles: Vertices [T, 3] of each triangle.
            uv: Texture coordinates [U, 2].
            uv_triangles: Texture coordinates [T, 3] of each triangle's corners.
            landmarks: Vertex of each named point.
            millimetres: Length of the model's unit in mm, above 0.
            name: What error messages call the model.

        Returns:
            The model, which shares the arrays.

        Raises:
            InputError: If shapes disagree, values are NaN or infinite, a variance is negative, or
                a triangle or landmark is out of range.
        """
        known = {} if landmarks is None else dict(landmarks)
        fault = (
            _find_disagreement(mean, basis, variances)
            or _find_bad_triangle(triangles, len(mean), "vertices")
            or _find_bad_texture(triangles, uv, uv_triangles)
            or _find_bad_value({"mean": mean, "basis": basis, "variances": variances, "uv": uv})
        )
        outside = [each for each, vertex in known.items() if not 0 <= vertex < len(mean)]
        if not fault and (variances < 0).any():
            fault = f"a variance is {variances.min():.3g}, and none is negative"
        if not fault and outside:
            fault = f"landmark {outside[0]} is vertex {known[outside[0]]} of {len(mean):,}"
        if not fault and not 0 < millimetres < math.inf:
            fault = f"its unit is {millimetres} millimetres"
        if fault:
            raise InputError(f"{name} is not a usable shape model: {fault}.")
        return cls(mean, basis, variances, triangles, uv, uv_triangles, known, millimetres, name)

    def reconstruct(self, alpha: Float[np.ndarray, "modes"]) -> Float[np.ndarray, "vertices 3"]:
        """Compute the vertices of a face.

        Args:
            alpha: Coefficients of the first modes; the others are 0.

        Returns:
            Vertices in the model's unit.
        """
        return self.mean + np.tensordot(alpha, self.basis[: len(alpha)], 1)

    def build_mesh(self, alpha: Float[np.ndarray, "modes"]) -> Mesh:
        """Build the mesh of a face.

        Args:
            alpha: Coefficients of the first modes; the others are 0.

        Returns:
            The mesh, with the model's texture coordinates and no texture.
        """
        vertices = self.reconstruct(alpha)
        return Mesh(vertices, self.triangles, self.uv, self.uv_triangles, name=self.name)

    def truncate(self, modes: int) -> "ShapeModel":
        """Keep the first modes.

        Args:
            modes: How many modes to keep.

        Returns:
            A model with that many modes.

        Raises:
            InputError: If the model has fewer modes.
        """
        if not 0 < modes <= len(self.variances):
            raise InputError(
                f"{self.name} has {len(self.variances)} modes, and {modes} are asked for; ask for "
                "fewer, or give a model of more subjects."
            )
        return replace(self, basis=self.basis[:modes], variances=self.variances[:modes])

    def crop(self, keep: Bool[np.ndarray, "vertices"]) -> "ShapeModel":
        """Keep some vertices, and the triangles and landmarks that lie wholly on them.

        Args:
            keep: True for the vertices to keep.

        Returns:
            The model of these vertices, in their order.
        """
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


def _find_disagreement(
    mean: Float[np.ndarray, "..."],
    basis: Float[np.ndarray, "..."],
    variances: Float[np.ndarray, "..."],
) -> str | None:
    if mean.ndim != 2 or mean.shape[1] != 3 or not mean.size:
        return f"its mean is {list(mean.shape)} and not [vertices, 3]"
    if basis.ndim != 3 or basis.shape[1:] != mean.shape or not basis.size:
        return (
            f"its basis is {list(basis.shape)} and does not agree with its mean {list(mean.shape)}"
        )
    if variances.shape != basis.shape[:1]:
        return f"it has {len(basis)} modes and variances {list(variances.shape)}"
    return None


def _find_bad_triangle(triangles: Int[np.ndarray, "..."], count: int, what: str) -> str | None:
    if triangles.ndim != 2 or triangles.shape[1] != 3 or not triangles.size:
        return f"its triangles are {list(triangles.shape)} and not [triangles, 3]"
    if triangles.min() < 0 or triangles.max() >= count:
        return f"its triangles go from {triangles.min()} to {triangles.max()} of {count:,} {what}"
    return None


def _find_bad_texture(
    triangles: Int[np.ndarray, "..."],
    uv: Float[np.ndarray, "..."] | None,
    own: Int[np.ndarray, "..."] | None,
) -> str | None:
    if uv is None and own is None:
        return None
    if uv is None or own is None or uv.ndim != 2 or uv.shape[1] != 2:
        return "its texture coordinates are not [points, 2] with triangles into them"
    if own.shape != triangles.shape:
        return f"it has triangles {list(triangles.shape)}, and {list(own.shape)} for its texture"
    return _find_bad_triangle(own, len(uv), "texture coordinates")


def _find_bad_value(arrays: Mapping[str, Float[np.ndarray, "..."] | None]) -> str | None:
    for name, array in arrays.items():
        if array is None:
            continue
        with np.errstate(invalid="ignore"):
            total = array.sum(dtype=np.float64)
        # The sum is finite if all values are, and takes no memory as np.isfinite(array) does.
        if not np.isfinite(total):
            return f"its {name} has values that are NaN or infinite"
    return None
