"""Renders the faces of `examples.blushing`; it runs in a Python that has bpy."""

import json
import math
import runpy
import sys
from pathlib import Path
from typing import Any

import bpy

_FLUSHES = {"rest": 0.0, "blushing": 1.5}


def main(folder: Path, tones: list[str], size: int = 280, samples: int = 32) -> None:
    """Render each face at rest and blushing, and both cheeks near."""
    for tone in tones:
        bpy.ops.wm.read_factory_settings(use_empty=True)
        bpy.ops.wm.obj_import(filepath=str(folder / "face.obj"))
        face = bpy.context.object
        for polygon in face.data.polygons:
            polygon.use_smooth = True
        runpy.run_path(str(folder / tone / "skin_blender.py"), run_name="__main__")
        material = bpy.data.materials["Skin"]
        face.data.materials.clear()
        face.data.materials.append(material)
        skin = next(n for n in material.node_tree.nodes if n.bl_idname == "ShaderNodeGroup")
        _add_mask(material.node_tree, skin, folder / "mask.png")
        _light(face, size, samples)
        for name, flush in _FLUSHES.items():
            skin.inputs["Flush"].default_value = flush
            _render(folder / f"{tone}_{name}.png")
        bpy.context.scene.camera.data.ortho_scale /= 3
        bpy.context.scene.camera.data.shift_x = 0.35
        bpy.context.scene.camera.data.shift_y = -0.25
        _render(folder / f"{tone}_near.png")


def _add_mask(tree: Any, skin: Any, path: Path) -> None:
    mask = tree.nodes.new("ShaderNodeTexImage")
    mask.image = bpy.data.images.load(str(path))
    mask.image.colorspace_settings.name = "Non-Color"
    tree.links.new(mask.outputs["Color"], skin.inputs["Flush Mask"])


def _light(face: Any, size: int, samples: int) -> None:
    """Put the camera before the face, a large lamp to its side, and grey light around."""
    height = max(face.dimensions)
    scene = bpy.context.scene
    bpy.ops.object.camera_add(location=(0, -5 * height, 0), rotation=(math.pi / 2, 0, 0))
    scene.camera = bpy.context.object
    scene.camera.data.type, scene.camera.data.ortho_scale = "ORTHO", 1.15 * height
    scene.camera.data.clip_end = 100 * height
    at = (-2 * height, -3 * height, 2 * height)
    bpy.ops.object.light_add(type="SUN", location=at, rotation=(0.9, 0, -0.55))
    bpy.context.object.data.energy, bpy.context.object.data.angle = 2.2, 0.4
    scene.world = bpy.data.worlds.new("World")
    if scene.world.node_tree is None:
        scene.world.use_nodes = True
    background = scene.world.node_tree.nodes["Background"]
    background.inputs["Color"].default_value = (0.5, 0.5, 0.5, 1)
    scene.render.engine, scene.cycles.samples = "CYCLES", samples
    scene.render.resolution_x = scene.render.resolution_y = size
    scene.view_settings.view_transform = "Standard"


def _render(path: Path) -> None:
    bpy.context.scene.render.filepath = str(path)
    bpy.ops.render.render(write_still=True)


if __name__ == "__main__":
    main(Path(sys.argv[1]), json.loads(sys.argv[2]))
