"""The pictures that materials name: found, read, and checked to be colour."""

from dataclasses import replace
from pathlib import Path

from skinnet.errors import InputError
from skinnet.mesh._foreign_name import describe_absence, find_foreign_file, show_name
from skinnet.mesh._materials import Material, PictureStatement, Placement
from skinnet.mesh._texture_file import Texture, check_colour, describe_texture, open_texture

_NEUTRAL = 0.02
"""Largest difference of the channels of a grey, which programs write in place of white."""


class PictureReader:
    """Reads the pictures of materials, each file once, and notes what was assumed."""

    def __init__(self, folder: Path, notes: list[str]) -> None:
        """Begin with the mesh's folder and the list for notes."""
        self.folder, self.notes = folder, notes
        self.read_already: dict[tuple[Path, bool], Texture] = {}

    def read(self, material: Material, statement: PictureStatement) -> tuple[Placement, Texture]:
        """Read the picture of a material.

        Raises:
            InputError: If it is missing, is no picture of colour, or is combined with more than a
                scale and an offset.
        """
        placement = statement.parse()
        _check_factor(material, statement)
        path = self.find(statement, placement)
        if statement.keyword.lower() == "map_ka":
            self.add(
                f"{statement.describe()} names {path.name}, and there is no map_Kd; the picture of "
                "the ambient colour is taken for the skin's."
            )
        # Programs disagree on whether `Tr 1` is opaque; nobody exports what cannot be seen.
        if material.opacity is not None and 0 < material.opacity < 1:
            self.add(
                f"{material.library}: material {material.shown!r} is transparent (d "
                f"{material.opacity:g}); it is read as opaque."
            )
        return placement, self.decode(path, material)

    def decode(self, path: Path, material: Material) -> Texture:
        """Decode a picture; its alpha is opacity only for a material that says so by map_d."""
        opaque = not any(each.keyword.lower() == "map_d" for each in material.pictures)
        if (path, opaque) not in self.read_already:
            picture = open_texture(path)
            for note in describe_texture(picture):
                self.add(note)
            if picture.alpha is not None and opaque:
                self.add(f"{path}: its alpha is not opacity (no map_d), and is not applied.")
                picture = replace(picture, alpha=None)
            check_colour(picture.srgb, str(path))
            self.read_already[path, opaque] = picture.srgb
        return self.read_already[path, opaque]

    def find(self, statement: PictureStatement, placement: Placement) -> Path:
        """Find a picture, beside the MTL file or the mesh."""
        folders = [statement.library.absolute().parent, self.folder]
        whole = find_foreign_file(statement.rest, folders[:1], self.folder)
        found = whole or find_foreign_file(placement.name, folders, self.folder)
        if found is None:
            raise _refuse_missing(statement, placement)
        if found.moved:
            self.add(
                f"{statement.describe()} names {show_name(placement.name)}, which is not there; "
                f"{found.path} is taken, which has its name."
            )
        return found.path

    def add(self, note: str) -> None:
        """Add a note once."""
        if note not in self.notes:
            self.notes.append(note)


def describe_other_pictures(path: Path, materials: list[Material | None]) -> list[str]:
    """Describe the pictures of materials of which none has one for its colour."""
    named = [each for material in materials if material for each in material.pictures]
    if not named:
        return []
    shown = ", ".join(dict.fromkeys(f"{show_name(each.rest)} ({each.keyword})" for each in named))
    return [
        f"{path}: its materials name {shown}, and no picture of their colour (map_Kd); give it "
        "with --texture."
    ]


def _check_factor(material: Material, statement: PictureStatement) -> None:
    """Refuse a coloured Kd: by the format it multiplies the picture, and most programs ignore it.

    Programs write greys of any brightness, black too, beside a picture that they show unchanged.
    """
    factor = material.diffuse
    if factor is not None and max(factor) - min(factor) > _NEUTRAL:
        shown = " ".join(f"{value:g}" for value in factor)
        raise InputError(
            f"{statement.describe()} names a picture, and the material's colour is Kd {shown}; "
            "some programs multiply them and others do not. Set Kd to 1 1 1, or give the picture "
            "with --texture."
        )


def _refuse_missing(statement: PictureStatement, placement: Placement) -> InputError:
    name = show_name(placement.name)
    if "<udim>" in name.lower() or "<uvtile>" in name.lower():
        return InputError(
            f"{statement.describe()} names {name}, a texture in several tiles, which is not read; "
            "bake it into one picture."
        )
    stem = name.replace("\\", "/").rpartition("/")[2].rpartition(".")[0].casefold()
    folder = statement.library.absolute().parent
    alike = sorted(each.name for each in folder.iterdir() if each.stem.casefold() == stem != "")
    alike = [each for each in alike if each.rpartition(".")[2].lower() not in ("obj", "mtl")]
    hint = f" ({alike[0]} is there)" if alike else ""
    return InputError(
        f"{statement.describe()} names the picture {name!r}, and "
        f"{describe_absence(placement.name, folder)}{hint}; put it beside the mesh, or give "
        "the picture with --texture."
    )
