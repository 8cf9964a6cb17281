"""Opens a GLB or USDZ file in Blender, in `.venv-blender`, and prints what is there as JSON."""

import json
import sys

import bpy
import numpy as np

path = sys.argv[1]
bpy.ops.wm.read_factory_settings(use_empty=True)
if path.endswith(".glb"):
    bpy.ops.import_scene.gltf(filepath=path, import_unused_materials=True)
else:
    bpy.ops.wm.usd_import(filepath=path)
head = next(each for each in bpy.data.objects if each.type == "MESH")
places = np.array([head.matrix_world @ vertex.co for vertex in head.data.vertices], float)
material = head.data.materials[0]
links = [
    (link.from_node.image.name.split(".")[0], link.to_node.type, link.to_socket.name)
    for link in material.node_tree.links
    if link.from_node.type == "TEX_IMAGE"
]
images = {
    image.name.split(".")[0]: [image.colorspace_settings.name, *image.size]
    for image in bpy.data.images
}
extras = material["skinnet"].to_dict() if "skinnet" in material else {}
print(
    "FOUND "
    + json.dumps(
        {
            "low": places.min(0).tolist(),
            "high": places.max(0).tolist(),
            "foremost": places[places[:, 1].argmin()].tolist(),
            "links": links,
            "images": images,
            "extras": extras,
        }
    )
)
