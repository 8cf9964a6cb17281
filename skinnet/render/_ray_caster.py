"""Embree where it is installed, and a tree of boxes in NumPy where it is not."""

from abc import ABC, abstractmethod

import numpy as np
from jaxtyping import Bool, Float, Float32, Int

from skinnet.render._triangle_tree import TriangleTree


class RayCaster(ABC):
    """What `Scene` asks of a mesh."""

    @abstractmethod
    def find_first(
        self, origins: Float32[np.ndarray, "rays 3"], directions: Float[np.ndarray, "rays 3"]
    ) -> Int[np.ndarray, "rays"]:
        """Find the index of the first triangle on each ray, -1 for none."""

    @abstractmethod
    def is_blocked(
        self, origins: Float32[np.ndarray, "rays 3"], directions: Float[np.ndarray, "#rays 3"]
    ) -> Bool[np.ndarray, "rays"]:
        """Tell whether each ray hits anything."""


def make_caster(
    vertices: Float32[np.ndarray, "vertices 3"], triangles: Int[np.ndarray, "triangles 3"]
) -> RayCaster:
    """Make the fastest ray caster that is installed.

    Embree has no wheel for some platforms, Linux on ARM among them. The other one gives the same
    triangles, up to rays that pass between two of them, and takes twenty to forty times as long.
    """
    try:
        # By itself, since modules below it may have been imported before.
        import embreex  # noqa: F401

        return _Embree(vertices, triangles)
    except ImportError:
        return _Boxes(vertices, triangles)


class _Embree(RayCaster):
    def __init__(
        self, vertices: Float32[np.ndarray, "vertices 3"], triangles: Int[np.ndarray, "triangles 3"]
    ) -> None:
        from embreex.mesh_construction import TriangleMesh
        from embreex.rtcore_scene import EmbreeScene

        self._scene = EmbreeScene(robust=True)
        TriangleMesh(self._scene, vertices, triangles.astype(np.int32))

    def find_first(
        self, origins: Float32[np.ndarray, "rays 3"], directions: Float[np.ndarray, "rays 3"]
    ) -> Int[np.ndarray, "rays"]:
        return np.asarray(self._scene.run(origins, directions.astype(np.float32)), np.int64)

    def is_blocked(
        self, origins: Float32[np.ndarray, "rays 3"], directions: Float[np.ndarray, "#rays 3"]
    ) -> Bool[np.ndarray, "rays"]:
        towards = np.ascontiguousarray(directions, np.float32)
        return np.asarray(self._scene.run(origins, towards, query="OCCLUDED") != -1)


class _Boxes(RayCaster):
    def __init__(
        self, vertices: Float32[np.ndarray, "vertices 3"], triangles: Int[np.ndarray, "triangles 3"]
    ) -> None:
        self._tree = TriangleTree(vertices[triangles])

    def find_first(
        self, origins: Float32[np.ndarray, "rays 3"], directions: Float[np.ndarray, "rays 3"]
    ) -> Int[np.ndarray, "rays"]:
        # In single precision, as Embree takes them: both miss the same rays.
        return self._tree.find_first(origins, directions.astype(np.float32))

    def is_blocked(
        self, origins: Float32[np.ndarray, "rays 3"], directions: Float[np.ndarray, "#rays 3"]
    ) -> Bool[np.ndarray, "rays"]:
        towards = np.broadcast_to(directions.astype(np.float32), origins.shape)
        return np.asarray(self._tree.find_first(origins, towards) != -1)
