"""Colours of the shader's node group and of its OSL shader, rendered by Cycles without a window.

It runs in a Python that has bpy:
python benchmarks/in_blender/patches.py FOLDER CASES.json OUTPUT.npz
FOLDER holds the files of `skinnet shader` with maps. CASES is a list of {"frame": N, "inputs":
{socket: value}}. OUTPUT holds `blender` and `osl`, each [cases, rows, columns, 3] in linear sRGB.
"""

import json
import runpy
import sys
from pathlib import Path
from typing import Any

import bpy
import numpy as np

_BUNDLED = "python/lib/python3.11/site-packages"
"""Folder of the modules that Blender's own Python has, such as oslquery."""


def main(folder: Path, cases: list[dict[str, Any]], output: Path) -> None:
    """Render each case with the node group, then with the OSL shader."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    runpy.run_path(str(folder / "skin_blender.py"), run_name="__main__")
    material = bpy.data.materials["Skin"]
    nodes = material.node_tree.nodes
    maps = [node for node in nodes if node.bl_idname == "ShaderNodeTexImage"]
    for node in maps:
        node.interpolation = "Closest"  # a sample is not exactly in the middle of its pixel
    _set_scene(material, tuple(maps[0].image.size))
    group = next(node for node in nodes if node.bl_idname == "ShaderNodeGroup")
    emission = _show(material.node_tree, group.outputs["Albedo"])
    found = {"blender": [_render(output, group, case) for case in cases]}
    script = _add_osl(material.node_tree, group, folder / "skin.osl")
    material.node_tree.links.new(script.outputs[0], emission.inputs["Color"])
    bpy.context.scene.cycles.shading_system = True
    found["osl"] = [_render(output, script, case) for case in cases]
    np.savez(output, **{name: np.stack(each) for name, each in found.items()})


def _set_scene(material: Any, size: tuple[int, int]) -> None:
    """Put a square before an orthographic camera, so that a pixel shows the middle of a texel."""
    bpy.ops.mesh.primitive_plane_add(size=1)
    bpy.context.object.data.materials.append(material)
    bpy.ops.object.camera_add(location=(0, 0, 1))
    scene = bpy.context.scene
    scene.camera = bpy.context.object
    scene.camera.data.type, scene.camera.data.ortho_scale = "ORTHO", 1.0
    scene.render.engine = "CYCLES"
    scene.render.resolution_x, scene.render.resolution_y = size
    scene.cycles.samples, scene.cycles.use_denoising = 1, False
    scene.cycles.pixel_filter_type, scene.cycles.filter_width = "BOX", 0.01
    scene.view_settings.view_transform = "Raw"
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"


def _show(tree: Any, colour: Any) -> Any:
    """Let the surface emit a colour, so that no light changes it."""
    emission = tree.nodes.new("ShaderNodeEmission")
    output = next(node for node in tree.nodes if node.bl_idname == "ShaderNodeOutputMaterial")
    tree.links.new(colour, emission.inputs["Color"])
    tree.links.new(emission.outputs[0], output.inputs["Surface"])
    return emission


def _add_osl(tree: Any, group: Any, path: Path) -> Any:
    """Add the OSL shader with the maps of the group."""
    sys.path.append(str(Path(bpy.utils.resource_path("LOCAL")) / _BUNDLED))
    script = tree.nodes.new("ShaderNodeScript")
    script.mode, script.filepath = "EXTERNAL", str(path)
    if not script.outputs:
        raise RuntimeError(f"{path} does not compile.")
    script.inputs["Table"].default_value = str(path.with_name("skin_table.exr"))
    for link in list(tree.links):
        if link.to_node == group:
            tree.links.new(link.from_socket, script.inputs[link.to_socket.name])
    return script


def _render(output: Path, node: Any, case: dict[str, Any]) -> np.ndarray:
    scene = bpy.context.scene
    scene.frame_set(case["frame"])
    for name, value in case["inputs"].items():
        node.inputs[name].default_value = value
    if node.bl_idname == "ShaderNodeScript":
        node.inputs["Time"].default_value = case["frame"] / scene.render.fps
    scene.render.filepath = str(output.with_suffix(".exr"))
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(scene.render.filepath)
    pixels = np.empty(image.size[0] * image.size[1] * 4, np.float32)
    image.pixels.foreach_get(pixels)
    pixels = pixels.reshape(image.size[1], image.size[0], 4)[::-1, :, :3]
    bpy.data.images.remove(image)
    return pixels


if __name__ == "__main__":
    main(Path(sys.argv[1]), json.loads(Path(sys.argv[2]).read_text("utf-8")), Path(sys.argv[3]))
