"""The parts of a glTF file: their geometry in the scene, and their base colour."""

from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from skinnet.errors import InputError
from skinnet.files import READ_ERRORS
from skinnet.images import linear_to_srgb, to_uint8
from skinnet.mesh._gltf.container import GltfFile, describe_damage, open_gltf
from skinnet.mesh._gltf.materials import Material, list_other_pictures, read_material
from skinnet.mesh._gltf.nodes import compute_transforms, describe_scene, list_instances
from skinnet.mesh._gltf.pictures import read_base_picture
from skinnet.mesh._gltf.primitives import Colours, Primitive, read_attribute, read_primitives
from skinnet.mesh._gltf.vertex_colours import bake_colours
from skinnet.mesh._mesh_parts import MeshContent, MeshPart, refuse_points
from skinnet.mesh._texture_file import Texture
from skinnet.mesh._texture_wrap import Mapped, Wrap, wrap_texture

_WRAPS = {10497: Wrap.REPEAT, 33648: Wrap.MIRROR, 33071: Wrap.CLAMP}

_BAKED = 1024
"""Side in texels of the texture that is made of vertex colours alone."""


class _Group(NamedTuple):
    """Primitives of one material. `colours` are linear, a row for each vertex."""

    material: Material
    number: int | None
    primitives: list[Primitive]
    colours: list[Colours]
    varied: bool


def read_gltf(path: Path, given: Texture | None = None, textured: bool = True) -> MeshContent:
    """Read the parts of a glTF or GLB file that have triangles, in the frame of its scene.

    Args:
        path: The file.
        given: A picture to use in place of the materials' base colours.
        textured: Read base colours. Otherwise the parts have their texture coordinates as they are
            in the file, and no colours.

    Raises:
        InputError: For a file that is damaged, of another version, without triangles, or that
            states something which is not read.
    """
    try:
        return _read_content(open_gltf(path), given, textured)
    except InputError:
        raise
    except READ_ERRORS as error:
        raise describe_damage(path, f"{type(error).__name__}, {error}") from error


def _read_content(file: GltfFile, given: Texture | None, textured: bool) -> MeshContent:
    transforms = compute_transforms(file)
    primitives = [
        primitive
        for instance in list_instances(file, transforms)
        for primitive in read_primitives(file, instance, transforms)
    ]
    solid = [primitive for primitive in primitives if len(primitive.geometry.triangles)]
    if not solid:
        raise refuse_points(file.path, sum(len(one.geometry.vertices) for one in primitives))
    file.notes.extend(describe_scene(file))
    if textured:
        groups = _group(file, solid)
        parts = [part for group in groups for part in _read_group(file, group, given)]
    else:
        parts = [_convert_bare(file, primitive) for primitive in solid]
    coloured = any("COLOR_0" in primitive.attributes for primitive in solid)
    named = bool(file.document.get("images")) or coloured
    return MeshContent(parts, list(dict.fromkeys(file.notes)), named, np.zeros((0, 3)))


def _group(file: GltfFile, primitives: list[Primitive]) -> list[_Group]:
    """Group primitives by material, and by vertex colour where that is constant."""
    groups: dict[Any, _Group] = {}
    for primitive in primitives:
        colours = _read_colours(file, primitive)
        varied = bool((np.ptp(colours, 0) > 0).any())
        key = primitive.material, None if varied else tuple(colours[0].tolist())
        material = read_material(file, primitive.material)
        group = groups.setdefault(key, _Group(material, primitive.material, [], [], varied))
        group.primitives.append(primitive)
        group.colours.append(colours)
    return list(groups.values())


def _read_colours(file: GltfFile, primitive: Primitive) -> Colours:
    if "COLOR_0" not in primitive.attributes:
        return np.ones((len(primitive.geometry.vertices), 3))
    return read_attribute(file, primitive, "COLOR_0")[:, :3].clip(0, 1)


def _read_group(file: GltfFile, group: _Group, given: Texture | None) -> list[MeshPart]:
    material = group.material
    if not group.varied:
        material = material._replace(factor=material.factor * group.colours[0][0])
    if given is None and material.texture is None:
        if others := list_other_pictures(file, group.number):
            file.notes.append(
                f"{file.path}: {material.name} has a picture as {' and '.join(others)}, and none "
                "for its base colour."
            )
        return _colour_group(file, group, material)
    if given is not None and not all(_has_uv(one, material) for one in group.primitives):
        return [_convert_bare(file, one, material) for one in group.primitives]
    picture = read_base_picture(file, material) if given is None else given
    mapped = [_map(file, primitive, material) for primitive in group.primitives]
    wraps = _read_wraps(file, material)
    mapped, picture = wrap_texture(mapped, picture, wraps, str(file.path))
    if group.varied and given is None:
        picture = _multiply(file, group, mapped, picture)
    return [_convert(each, picture, material) for each in mapped]


def _multiply(file: GltfFile, group: _Group, mapped: list[Mapped], picture: Texture) -> Texture:
    """Multiply a texture with vertex colours."""
    baked = _bake(group, mapped, picture)
    if baked is None:
        raise InputError(
            f"{file.path}: {group.material.name} multiplies its texture with vertex colours "
            "(COLOR_0) which differ where faces share texels; bake them into the texture, or "
            "export it without vertex colours."
        )
    return baked


def _bake(group: _Group, mapped: list[Mapped], picture: Texture) -> Texture | None:
    corners = np.concatenate([each.uv[each.geometry.triangles] for each in mapped])
    # Wrapped coordinates repeat vertices; the primitives' own triangles refer to their colours.
    pairs = zip(group.colours, group.primitives, strict=True)
    colours = np.concatenate([colour[one.geometry.triangles] for colour, one in pairs])
    return bake_colours(picture, corners, colours)


def _colour_group(file: GltfFile, group: _Group, material: Material) -> list[MeshPart]:
    """Make parts without a picture: their vertex colours as a texture, else one colour."""
    if not group.varied:
        return [_convert_bare(file, one, material) for one in group.primitives]
    if all("TEXCOORD_0" in one.attributes for one in group.primitives):
        mapped = [_map(file, one, material) for one in group.primitives]
        plain = to_uint8(linear_to_srgb(np.ones((_BAKED, _BAKED, 3)) * material.factor))
        baked = _bake(group, mapped, plain)
        if baked is not None:
            file.notes.append(
                f"{file.path}: the texture of {material.name} is made of its vertex colours "
                "(COLOR_0), which are linear by glTF."
            )
            return [_convert(each, baked, material) for each in mapped]
    file.notes.append(f"{file.path}: the vertex colours of {material.name} are averaged.")
    pairs = zip(group.primitives, group.colours, strict=True)
    return [
        _convert_bare(file, one, material._replace(factor=material.factor * colours.mean(0)))
        for one, colours in pairs
    ]


def _has_uv(primitive: Primitive, material: Material) -> bool:
    return f"TEXCOORD_{material.tex_coord}" in primitive.attributes


def _map(file: GltfFile, primitive: Primitive, material: Material) -> Mapped:
    """Read the texture coordinates of the base colour, as its material transforms them."""
    name = f"TEXCOORD_{material.tex_coord}"
    if name not in primitive.attributes:
        raise InputError(
            f"{file.path}: {material.name} has its texture at {name}, which a mesh does not have; "
            "export it with texture coordinates (UV)."
        )
    uv = read_attribute(file, primitive, name)
    matrix = material.transform
    return Mapped(primitive.geometry, uv @ matrix[:2, :2].T + matrix[:2, 2])


def _read_wraps(file: GltfFile, material: Material) -> tuple[Wrap, Wrap]:
    texture = {} if material.texture is None else file.get("textures", material.texture)
    sampler = file.get("samplers", texture["sampler"]) if "sampler" in texture else {}
    return _WRAPS[sampler.get("wrapS", 10497)], _WRAPS[sampler.get("wrapT", 10497)]


def _convert(mapped: Mapped, picture: Texture | None, material: Material) -> MeshPart:
    colour = to_uint8(linear_to_srgb(material.factor))
    return MeshPart(mapped.geometry, mapped.uv * [1, -1] + [0, 1], picture, colour)


def _convert_bare(
    file: GltfFile, primitive: Primitive, material: Material | None = None
) -> MeshPart:
    """Make a part without a picture."""
    material = material or read_material(file, primitive.material)
    if _has_uv(primitive, material):
        return _convert(_map(file, primitive, material), None, material)
    colour = to_uint8(linear_to_srgb(material.factor))
    return MeshPart(primitive.geometry, None, None, colour)
