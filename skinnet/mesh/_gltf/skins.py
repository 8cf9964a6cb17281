"""Skins of glTF: vertices follow the joints of a skeleton."""

from typing import Any

import numpy as np
from jaxtyping import Float

from skinnet.mesh._gltf.accessors import read_accessor
from skinnet.mesh._gltf.container import GltfFile
from skinnet.mesh._gltf.nodes import Instance, Transform


def compute_skinning(
    file: GltfFile,
    instance: Instance,
    attributes: dict[str, Any],
    transforms: dict[int, Transform],
) -> Float[np.ndarray, "_ 4 4"] | None:
    """Compute the transform of each vertex in the pose that the nodes state.

    Returns:
        A transform to the scene for each vertex, which replaces that of the mesh's node; None if
        the mesh has no skin.
    """
    if "skin" not in instance.node or "JOINTS_0" not in attributes:
        return None
    joints = _compute_joints(file, file.get("skins", instance.node["skin"]), transforms)
    total: Any = 0
    weight: Any = 0
    for number in range(len(attributes)):
        if f"JOINTS_{number}" not in attributes or f"WEIGHTS_{number}" not in attributes:
            break
        index = read_accessor(file, attributes[f"JOINTS_{number}"]).astype(np.int64)
        share = read_accessor(file, attributes[f"WEIGHTS_{number}"], normalise=True)
        if index.max(initial=0) >= len(joints):
            raise file.damage(f"a vertex refers to joint {index.max()} of {len(joints)}")
        total = total + np.einsum("nk,nkij->nij", share.astype(np.float64), joints[index])
        weight = weight + share.sum(1, np.float64)
    bound = np.asarray(weight > 0)
    total[~bound] = joints[0]
    matrices: Float[np.ndarray, "_ 4 4"] = total / np.where(bound, weight, 1)[:, None, None]
    return matrices


def _compute_joints(
    file: GltfFile, skin: dict[str, Any], transforms: dict[int, Transform]
) -> Float[np.ndarray, "joints 4 4"]:
    """Compute the transforms from the mesh at rest to the scene, one for each joint."""
    placed = np.stack([transforms[joint] for joint in skin["joints"]])
    if "inverseBindMatrices" not in skin:
        return placed
    inverse = read_accessor(file, skin["inverseBindMatrices"]).astype(np.float64)
    if len(inverse) < len(placed):
        raise file.damage(f"a skin has {len(placed)} joints and {len(inverse)} matrices")
    joints: Float[np.ndarray, "joints 4 4"] = placed @ inverse[: len(placed)].reshape(
        -1, 4, 4
    ).transpose(0, 2, 1)
    return joints
