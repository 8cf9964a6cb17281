"""Materials of glTF: their base colour."""

from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Float

from skinnet.mesh._gltf.container import GltfFile

_OTHER_PICTURES = ("normalTexture", "occlusionTexture", "emissiveTexture")


class Material(NamedTuple):
    """The base colour of a material.

    Attributes:
        name: What messages call it.
        texture: Number of the base colour's texture, if it has one.
        tex_coord: Which set of texture coordinates the texture has.
        transform: Transform of the texture coordinates, in homogeneous coordinates.
        factor: Linear RGB that multiplies the texture.
        alpha: Alpha that multiplies the texture's.
        cutoff: Least alpha that is drawn; 0 where transparency is blended, -1 where alpha is
            ignored.
    """

    name: str
    texture: int | None
    tex_coord: int
    transform: Float[np.ndarray, "3 3"]
    factor: Float[np.ndarray, "3"]
    alpha: float
    cutoff: float


def read_material(file: GltfFile, number: int | None) -> Material:
    """Read the base colour of a material; without one it is white."""
    material = {} if number is None else file.get("materials", number)
    roughness = material.get("pbrMetallicRoughness", {})
    glossiness = material.get("extensions", {}).get("KHR_materials_pbrSpecularGlossiness")
    if glossiness is None:
        texture, factor = roughness.get("baseColorTexture"), roughness.get("baseColorFactor")
    else:
        texture, factor = glossiness.get("diffuseTexture"), glossiness.get("diffuseFactor")
    rgba = np.array(factor or [1, 1, 1, 1], np.float64)
    if rgba.shape != (4,) or not np.isfinite(rgba).all():
        raise file.damage(f"a base colour is {rgba.tolist()} in place of four numbers")
    tex_coord, transform = _read_transform(texture or {})
    return Material(
        str(material.get("name", f"material {number}")),
        None if texture is None else texture["index"],
        tex_coord,
        transform,
        rgba[:3].clip(0, 1),
        float(rgba[3].clip(0, 1)),
        _read_cutoff(material),
    )


def list_other_pictures(file: GltfFile, number: int | None) -> list[str]:
    """List the pictures of a material that are not its base colour, by their roles in glTF."""
    material = {} if number is None else file.get("materials", number)
    found = [role for role in _OTHER_PICTURES if role in material]
    more = "metallicRoughnessTexture" in material.get("pbrMetallicRoughness", {})
    return found + ["metallicRoughnessTexture"] * more


def _read_cutoff(material: dict[str, Any]) -> float:
    mode = material.get("alphaMode", "OPAQUE")
    return {"MASK": float(material.get("alphaCutoff", 0.5)), "BLEND": 0.0}.get(mode, -1.0)


def _read_transform(texture: dict[str, Any]) -> tuple[int, Float[np.ndarray, "3 3"]]:
    """Read the set of texture coordinates and their transform (KHR_texture_transform).

    The matrix in the extension's text rotates the other way than its words, its example and all
    that implement it, which are followed.
    """
    stated = texture.get("extensions", {}).get("KHR_texture_transform", {})
    angle, (x, y) = stated.get("rotation", 0.0), stated.get("scale", [1.0, 1.0])
    cos, sin = np.cos(angle), np.sin(angle)
    transform = np.eye(3)
    transform[:2, :2] = [[cos * x, sin * y], [-sin * x, cos * y]]
    transform[:2, 2] = stated.get("offset", [0.0, 0.0])
    return stated.get("texCoord", texture.get("texCoord", 0)), transform
