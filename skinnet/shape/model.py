"""A statistical shape model: faces in correspondence as a mean and linear modes."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Float, Int

from skinnet.shape.mesh import Mesh


@dataclass(frozen=True)
class ShapeModel:
    """shape(alpha) = mean + sum_k alpha_k basis_k (Alotaibi & Smith 2017, section 4.1).

    `mean` [N, 3] and `basis` [S, N, 3] in the model's unit, of `millimetres` each; x points to the
    face's left, y up, z forward. `variances` [S] are those of alpha over people. `uv` [U, 2] and
    `uv_triangles` [T, 3] are the model's own texture space, None until one is made. `landmarks`
    gives the vertex of each named point (`skinnet.shape.landmarks`).
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

    def shape(self, alpha: Float[np.ndarray, "modes"]) -> Float[np.ndarray, "vertices 3"]:
        """Vertices of the face with these coefficients; fewer than S stand for the first."""
        return self.mean + np.tensordot(alpha, self.basis[: len(alpha)], 1)

    def mesh(self, alpha: Float[np.ndarray, "modes"]) -> Mesh:
        """The face with these coefficients as a mesh without a texture."""
        return Mesh(self.shape(alpha), self.triangles, self.uv, self.uv_triangles, name=self.name)
