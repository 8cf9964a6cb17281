"""Writer of a head as GLB, the one-file form of glTF 2.0."""

from pathlib import Path
from typing import Any

import numpy as np
import trimesh
from PIL import Image

from skinnet.pipeline._head import IOR, LEVELS, ROUGHNESS, Head, encode_png

KEY = "skinnet"
"""Key of our entry among the `extras` of the material."""


def write_glb(path: Path, head: Head) -> None:
    """Write a head as GLB.

    Base colour and normal map are those of glTF. The pigment maps are 16-bit PNG textures of the
    same texture coordinates, which `extras.skinnet` of the material names with their scale.

    Args:
        path: The file.
        head: The head.
    """
    material = trimesh.visual.material.PBRMaterial(
        name="skin",
        baseColorTexture=Image.fromarray(head.albedo),
        normalTexture=Image.fromarray(head.normal_map),
        metallicFactor=0.0,
        roughnessFactor=ROUGHNESS,
    )
    mesh = trimesh.Trimesh(
        head.positions,
        head.triangles,
        vertex_normals=head.normals,
        visual=trimesh.visual.TextureVisuals(head.uv, material=material),
        process=False,
    )
    mesh.vertex_attributes["TANGENT"] = np.asarray(head.tangents, np.float32)
    scene = trimesh.Scene()
    scene.add_geometry(mesh, node_name="head", geom_name="head")

    def add_pigments(buffers: dict[Any, bytes], tree: dict[str, Any]) -> None:
        _add_pigments(head, buffers, tree)

    path.write_bytes(
        trimesh.exchange.gltf.export_glb(
            scene, include_normals=True, buffer_postprocessor=add_pigments
        )
    )


def _add_pigments(head: Head, buffers: dict[Any, bytes], tree: dict[str, Any]) -> None:
    for attributes in (part["attributes"] for part in tree["meshes"][0]["primitives"]):
        if "_TANGENT" in attributes:  # trimesh takes it for an attribute of its user
            attributes["TANGENT"] = attributes.pop("_TANGENT")
    entry: dict[str, Any] = dict(head.facts)
    for image, name in zip(tree["images"], ("albedo", "normal"), strict=True):
        image["name"] = name
    for name, pixels in head.pigments.items():
        data = encode_png(pixels, head.mark)
        buffers[f"{KEY} {name}"] = data + bytes(-len(data) % 4)
        tree["images"].append(
            {"bufferView": len(buffers) - 1, "mimeType": "image/png", "name": name}
        )
        tree["textures"].append({"source": len(tree["images"]) - 1})
        entry[name] = {
            "texture": {"index": len(tree["textures"]) - 1, "texCoord": 0},
            # glTF's readers scale 16 bits to [0, 1].
            "scale": head.scales[name] * LEVELS,
            "unit": "volume fraction",
        }
    material = tree["materials"][0]
    material["extras"] = {KEY: entry}
    material["extensions"] = {"KHR_materials_ior": {"ior": IOR}}
    tree["extensionsUsed"] = ["KHR_materials_ior"]
