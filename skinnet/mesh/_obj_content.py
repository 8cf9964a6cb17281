"""The parts of an OBJ file: its triangles by material, with the picture that each one names."""

from pathlib import Path
from typing import NamedTuple

import numpy as np
from jaxtyping import Int, UInt8

from skinnet.errors import InputError
from skinnet.mesh._face_parts import GREY, make_bare_parts, make_part
from skinnet.mesh._material_picture import PictureReader, describe_other_pictures
from skinnet.mesh._materials import Material, Placement
from skinnet.mesh._mesh_parts import MeshContent, MeshPart, refuse_points
from skinnet.mesh._obj import ObjFile, read_obj
from skinnet.mesh._obj_library import Library, read_library
from skinnet.mesh._texture_file import Texture
from skinnet.mesh._texture_wrap import Mapped, Wrap, wrap_texture


class _Group(NamedTuple):
    """Triangles of one material, all with texture coordinates or all without."""

    material: Material | None
    part: MeshPart


def read_obj_content(
    path: Path, given: Texture | None = None, textured: bool = True
) -> MeshContent:
    """Read the parts of an OBJ file: its triangles by material, in the order of their first use.

    Args:
        path: The file.
        given: A picture to use in place of those that the materials name.
        textured: Read materials and pictures.

    Raises:
        InputError: For a file that is damaged or has no triangles, a material that is not defined
            beside others with a picture, and for a picture that is missing or cannot be used.
    """
    file = read_obj(path)
    if not len(file.faces.triangles):
        raise refuse_points(path, len(file.faces.vertices))
    if not textured:
        return MeshContent(make_bare_parts(file.faces), file.notes, False, file.faces.vertices)
    library = _read_library(path, file, given)
    groups = _group(file, library)
    notes = file.notes + library.notes
    if given is None:
        parts = _add_pictures(path, groups, library, notes)
    else:
        parts = [_place(each.part, _read_placement(each.material), given) for each in groups]
    return MeshContent(parts, notes, library.names_pictures, file.faces.vertices)


def _group(file: ObjFile, library: Library) -> list[_Group]:
    materials = list({id(each): each for each in library.used}.values())
    number = {id(each): place for place, each in enumerate(materials)}
    place = np.array([number[id(each)] for each in library.used])[file.material]
    groups = []
    for value in dict.fromkeys(place.tolist()):
        for mapped in (True, False):
            part = make_part(file.faces, place == value, mapped)
            if part is not None:
                colour = _compute_colour(materials[value])
                groups.append(_Group(materials[value], part._replace(colour=colour)))
    return groups


def _add_pictures(
    path: Path, groups: list[_Group], library: Library, notes: list[str]
) -> list[MeshPart]:
    reader = PictureReader(path.absolute().parent, notes)
    parts = [_add_picture(path, each, reader) for each in groups]
    pairs = zip(groups, parts, strict=True)
    plain = [each for each, part in pairs if part.texture is None]
    faults = _describe_faults(path, library)
    if len(plain) == len(parts):
        others = describe_other_pictures(path, [each.material for each in groups])
        if library.names_pictures and not faults + others:
            others = [f"{path} has faces without a picture only; give it with --texture."]
        notes += faults + others
        return parts
    if library.undefined:
        raise InputError(" ".join(faults))
    notes += [_describe_plain(path, each) for each in plain]
    return parts


def _describe_plain(path: Path, group: _Group) -> str:
    material, count = group.material, len(group.part.geometry.triangles)
    name = "no material" if material is None else f"material {material.shown!r}"
    what = "grey" if material is None or material.diffuse is None else "the material's colour"
    lack = "no texture coordinates" if group.part.uv is None else "no picture"
    return f"{path}: {count:,} triangles of {name} have {lack}, and are {what}."


def _add_picture(path: Path, group: _Group, reader: PictureReader) -> MeshPart:
    material = group.material
    statement = None if material is None else material.choose_picture()
    if material is None or statement is None or group.part.uv is None:
        return group.part
    placement, texture = reader.read(material, statement)
    return _place(group.part, placement, texture)


def _place(part: MeshPart, placement: Placement | None, texture: Texture) -> MeshPart:
    """Give a part a texture; scale and offset make it repeat, as materials state."""
    if part.uv is None or placement is None or placement.is_plain:
        return part._replace(texture=texture)
    # Wrapping has the origin at the upper left.
    flipped = Mapped(part.geometry, placement.place(part.uv) * [1, -1] + [0, 1])
    wrap = Wrap.CLAMP if placement.clamp else Wrap.REPEAT
    (mapped,), texture = wrap_texture([flipped], texture, (wrap, wrap), "The mesh")
    return part._replace(geometry=mapped.geometry, uv=mapped.uv * [1, -1] + [0, 1], texture=texture)


def _read_library(path: Path, file: ObjFile, given: Texture | None) -> Library:
    try:
        return read_library(path, file)
    except InputError:
        if given is None:
            raise
        return Library([None] * (len(file.materials) + 1), [], [], [], True)


def _read_placement(material: Material | None) -> Placement | None:
    try:
        statement = None if material is None else material.choose_picture()
        return None if statement is None else statement.parse(lenient=True)
    except InputError:
        return None


def _describe_faults(path: Path, library: Library) -> list[str]:
    remedy = "put the MTL file beside the mesh, or give the picture with --texture"
    faults = [
        f"{path} names the materials' file {missing}; what it says of "
        f"textures is not known: {remedy}."
        for missing in library.missing
    ]
    if library.undefined:
        names = ", ".join(library.undefined[:5])
        faults.append(
            f"{path} uses material {names}, which no MTL file defines; its texture is not known: "
            f"{remedy}."
        )
    return faults


def _compute_colour(material: Material | None) -> UInt8[np.ndarray, "3"]:
    if material is None or material.diffuse is None:
        return GREY
    colour: Int[np.ndarray, 3] = np.rint(np.clip(material.diffuse, 0, 1) * np.float64(255))
    return colour.astype(np.uint8)
