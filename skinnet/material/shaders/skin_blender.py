"""Skin of two pigments for Blender 4.2 and later: the node group "Skin", and a material with it.

Open this file in Blender's Text Editor and press Run. Or: blender --python skin_blender.py
With the name of a file behind two hyphens, it is saved there, with all textures but the maps in it:
blender --background --python skin_blender.py -- skin.blend
"""

import json
import sys
from pathlib import Path
from typing import Any

import bpy

_SETTINGS: dict[str, Any] = json.loads("{}")
"""Written by skinnet shader: the table, its axes, and the maps."""

_FACTOR = "Share of what is there; 1 changes nothing"
_ADD = "Volume fraction that is added"
_SOCKETS = (
    ("Melanin", _SETTINGS.get("melanin", 0), (0, 1), "Volume fraction of melanosomes"),
    ("Hemoglobin", _SETTINGS.get("hemoglobin", 0), (0, 1), "Volume fraction of blood"),
    ("Melanin Factor", 1, (0, 10), _FACTOR),
    ("Melanin Add", 0, (-1, 1), _ADD),
    ("Hemoglobin Factor", 1, (0, 10), _FACTOR),
    ("Hemoglobin Add", 0, (-1, 1), _ADD),
    ("Flush", 0, (-1, 10), "Share of blood that is added; 1 doubles it, -1 takes all"),
    ("Flush Mask", 1, (0, 1), "Where the flush is; a texture or an attribute"),
    ("Pulse", 0, (0, 10), "Share of blood that each heartbeat adds"),
    ("Pulse Rate", 70, (0, 300), "Beats per minute"),
    ("Time", 0, (-1e6, 1e6), "Seconds; the material drives it by the frame"),
    ("Skin", 1, (0, 1), "How far edits apply: the map of skin"),
    ("Keep", 0, (0, 1), "Share that is kept of what is not skin in the original"),
)
"""Name, value, range and description of each number that the group takes."""

_COLOURS = (
    ("Original", "Texture that the maps were made from"),
    ("Offset", "Linear colour of what is not skin, where there is no original"),
)
"""Name and description of each colour that the group takes."""

_SPACES = {"raw": "Non-Color", "srgb": "sRGB", "linear": "Linear Rec.709"}
_BLACK = 1e-6


class _Graph:
    """A node tree in which nodes are placed in columns from left to right."""

    def __init__(self, tree: Any) -> None:
        self.tree = tree
        self._rows: dict[int, int] = {}

    def add(self, kind: str, inputs: dict[Any, Any], **settings: Any) -> Any:
        """Add a node; inputs are numbers, colours or outputs of other nodes."""
        node = self.tree.nodes.new(kind)
        for name, value in settings.items():
            setattr(node, name, value)
        column = 0
        for key, value in inputs.items():
            if isinstance(value, bpy.types.NodeSocket):
                self.tree.links.new(value, node.inputs[key])
                column = max(column, round(value.node.location.x / 200) + 1)
            else:
                node.inputs[key].default_value = value
        self._rows[column] = self._rows.get(column, -1) + 1
        node.location = (200 * column, -300 * self._rows[column])
        return node

    def compute(self, operation: str, *values: Any, clamp: bool = False) -> Any:
        """Add a Math node and return its output."""
        inputs = dict(enumerate(values))
        node = self.add("ShaderNodeMath", inputs, operation=operation, use_clamp=clamp)
        return node.outputs[0]

    def compute_vector(self, operation: str, *values: Any) -> Any:
        """Add a Vector Math node and return its output."""
        inputs = dict(enumerate(values))
        return self.add("ShaderNodeVectorMath", inputs, operation=operation).outputs[0]


def _make_group() -> Any:
    """Make the node group: pigments and edits in, albedo out."""
    group = bpy.data.node_groups.new(_SETTINGS["name"], "ShaderNodeTree")
    for name, value, (low, high), description in _SOCKETS:
        socket = group.interface.new_socket(
            name, in_out="INPUT", socket_type="NodeSocketFloat", description=description
        )
        socket.min_value, socket.max_value = low, high
        socket.default_value = value
    for name, description in _COLOURS:
        socket = group.interface.new_socket(
            name, in_out="INPUT", socket_type="NodeSocketColor", description=description
        )
        socket.default_value = (0, 0, 0, 1)
    group.interface.new_socket("Albedo", in_out="OUTPUT", socket_type="NodeSocketColor")
    graph = _Graph(group)
    given = graph.add("NodeGroupInput", {}).outputs
    table = _load_table()
    before = _look_up(graph, table, given["Melanin"], given["Hemoglobin"])
    edited = (
        _weigh(graph, given, "Melanin", _edit_melanin(graph, given)),
        _weigh(graph, given, "Hemoglobin", _edit_blood(graph, given)),
    )
    after = _look_up(graph, table, *edited)
    whole = _add_offset(graph, given, before, after)
    graph.add("NodeGroupOutput", {"Albedo": graph.compute_vector("MAXIMUM", whole, (0, 0, 0))})
    return group


def _weigh(graph: _Graph, given: Any, name: str, edited: Any) -> Any:
    """Edit what is skin alone."""
    change = graph.compute("SUBTRACT", edited, given[name])
    return graph.compute("MULTIPLY_ADD", change, given["Skin"], given[name])


def _add_offset(graph: _Graph, given: Any, before: Any, after: Any) -> Any:
    """Add what is not skin, which darkens with the skin and never grows."""
    rest = graph.compute_vector("SUBTRACT", given["Original"], before)
    offset = graph.compute_vector("MULTIPLY_ADD", rest, given["Keep"], given["Offset"])
    positive = [graph.compute_vector("MAXIMUM", one, (_BLACK,) * 3) for one in (after, before)]
    ratio = graph.compute_vector("DIVIDE", *positive)
    factor = graph.compute_vector("MINIMUM", ratio, (1, 1, 1))
    return graph.compute_vector("MULTIPLY_ADD", offset, factor, after)


def _edit_melanin(graph: _Graph, given: Any) -> Any:
    edit = (given["Melanin"], given["Melanin Factor"], given["Melanin Add"])
    return graph.compute("MULTIPLY_ADD", *edit, clamp=True)


def _edit_blood(graph: _Graph, given: Any) -> Any:
    """(hemoglobin * factor + add) * (1 + flush * mask + pulse * wave), within 0 and 1."""
    beats = graph.compute("MULTIPLY", given["Pulse Rate"], given["Time"])
    beats = graph.compute("FRACT", graph.compute("DIVIDE", beats, 60.0))
    cosine = graph.compute("COSINE", graph.compute("MULTIPLY", beats, 6.28318531))
    wave = graph.compute("MULTIPLY_ADD", cosine, -0.5, 0.5)
    blood = graph.compute("MULTIPLY_ADD", given["Flush"], given["Flush Mask"], 1.0)
    blood = graph.compute("MULTIPLY_ADD", given["Pulse"], wave, blood)
    edit = (given["Hemoglobin"], given["Hemoglobin Factor"], given["Hemoglobin Add"])
    edited = graph.compute("MULTIPLY_ADD", *edit)
    return graph.compute("MULTIPLY", edited, blood, clamp=True)


def _load_table() -> Any:
    image = bpy.data.images.load(str(_FOLDER / _SETTINGS["table"]))
    image.colorspace_settings.name = "Linear Rec.709"
    image.pack()
    return image


def _look_up(graph: _Graph, image: Any, melanin: Any, hemoglobin: Any) -> Any:
    axes = (melanin, "melanin_spacing", "columns"), (hemoglobin, "hemoglobin_spacing", "rows")
    places = [_place(graph, value, _SETTINGS[name], _SETTINGS[size]) for value, name, size in axes]
    vector = graph.add("ShaderNodeCombineXYZ", dict(enumerate(places))).outputs[0]
    table = {"image": image, "interpolation": "Linear", "extension": "EXTEND"}
    return graph.add("ShaderNodeTexImage", {"Vector": vector}, **table).outputs["Color"]


def _place(graph: _Graph, fraction: Any, spacing: float, nodes: int) -> Any:
    """Coordinate of a fraction in the table: log(1 + f / spacing), from 0 at f = 0 to 1 at 1."""
    ratio = graph.compute("MULTIPLY_ADD", fraction, 1 / spacing, 1.0)
    position = graph.compute("LOGARITHM", ratio, 1 + 1 / spacing)
    return graph.compute("MULTIPLY_ADD", position, (nodes - 1) / nodes, 0.5 / nodes)


def _make_material(group: Any) -> Any:
    """Make a material: the maps, the group, and a surface with its albedo."""
    material = bpy.data.materials.new(_SETTINGS["name"])
    if material.node_tree is None:  # before Blender 5
        material.use_nodes = True
    material.node_tree.nodes.clear()
    graph = _Graph(material.node_tree)
    maps = {each["input"]: _add_map(graph, each) for each in _SETTINGS["maps"]}
    skin = graph.add("ShaderNodeGroup", {}, node_tree=group, width=200)
    skin.location = (600, 0)
    for name, value in maps.items():
        graph.tree.links.new(value, skin.inputs[name])
    skin.inputs["Keep"].default_value = float("Original" in maps)
    _drive_time(skin.inputs["Time"])
    look = {"Base Color": skin.outputs["Albedo"], "Roughness": 0.45, "IOR": 1.4}
    surface = graph.add("ShaderNodeBsdfPrincipled", look).outputs[0]
    graph.add("ShaderNodeOutputMaterial", {"Surface": surface})
    material.use_fake_user = True
    return material


def _add_map(graph: _Graph, settings: dict[str, Any]) -> Any:
    """Add a map: its file holds numbers, and value = scale * number + offset."""
    node = graph.add("ShaderNodeTexImage", {}, image=_load_map(settings), label=settings["input"])
    if settings["input"] == "Original":
        return node.outputs["Color"]
    scale, offset = settings["scale"], settings["offset"]
    if settings["input"] == "Offset":
        terms = node.outputs["Color"], (scale,) * 3, (offset,) * 3
        return graph.compute_vector("MULTIPLY_ADD", *terms)
    return graph.compute("MULTIPLY_ADD", node.outputs["Color"], scale, offset)


def _load_map(settings: dict[str, Any]) -> Any:
    """Load a file, or the files of all tiles."""
    path, tiles = str((_FOLDER / settings["file"]).resolve()), settings["tiles"]
    image = bpy.data.images.load(path.replace("<UDIM>", str(tiles[0]) if tiles else ""))
    image.colorspace_settings.name = _SPACES[settings["space"]]
    if not path.endswith(".exr"):
        image.alpha_mode = "CHANNEL_PACKED"  # colours are not multiplied by alpha
    if tiles:
        image.source, image.filepath = "TILED", path
        image.tiles[0].number = tiles[0]
        for tile in tiles[1:]:
            image.tiles.new(tile)
    return image


def _drive_time(socket: Any) -> None:
    """Let the frame drive the seconds, at the frames per second of the scene."""
    driver = socket.driver_add("default_value").driver
    for name, path in (("fps", "render.fps"), ("base", "render.fps_base")):
        variable = driver.variables.new()
        variable.name, variable.type = name, "CONTEXT_PROP"
        variable.targets[0].context_property = "ACTIVE_SCENE"
        variable.targets[0].data_path = path
    driver.expression = "frame * base / fps"


def _find_folder() -> Path:
    """Find the folder of this file, also when Blender's Text Editor runs it."""
    text = getattr(getattr(bpy.context, "space_data", None), "text", None)
    return Path(bpy.path.abspath(text.filepath) if text else __file__).resolve().parent


def _main() -> None:
    material = _make_material(_make_group())
    target = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else []
    if target:
        path = Path(target[0]).resolve()
        bpy.ops.wm.save_as_mainfile(filepath=str(path), compress=True, relative_remap=True)
    print(f"The material {material.name} and its node group are ready.")


_FOLDER = _find_folder()

if __name__ == "__main__":
    _main()
