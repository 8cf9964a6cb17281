"""`skinnet edit-albedo`: pigments of an albedo texture edited, from the texture or its maps."""

import argparse
import json
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from dataclasses import asdict
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Float32
from numpy.typing import NDArray

from skinnet.appearance.edit import PigmentEdit
from skinnet.errors import InputError
from skinnet.files import make_folder, write_together
from skinnet.images._mark import Mark
from skinnet.images._result_names import choose_stem, lock_folder
from skinnet.inference._edit_mask import describe_black, read_edit_mask
from skinnet.inference._editing import to_share
from skinnet.inference._messages import note, print_line
from skinnet.material._brushes import Brush, parse_brush
from skinnet.material._calibrated_colour import make_colour
from skinnet.material._encoding import Encoding
from skinnet.material._invert_verb import get_opaque, invert_rows, open_all
from skinnet.material._map_files import (
    RECORD_END,
    WHITES,
    choose_suffix,
    compute_set_digest,
    owns,
    read_record,
    to_fractions,
)
from skinnet.material._presets import PRESETS
from skinnet.material._rows_progress import show_rows
from skinnet.material._texture_checks import TextureCounts
from skinnet.material._texture_file import (
    TextureFile,
    TextureWriter,
    describe_copy,
    import_openimageio,
    open_texture,
)
from skinnet.material._udim import TOKEN, TextureSet, find_corner, find_set
from skinnet.material.albedo import AlbedoColour, AlbedoMaps, _blend

_PIGMENTS = ("melanin", "hemoglobin")
_Strips = Iterator[tuple[NDArray[Any], AlbedoMaps]]


class _Tile(NamedTuple):
    """A tile to edit: its number, its texture or offset, its rows, and what it is called."""

    tile: int | None
    texture: TextureFile
    encoding: Encoding
    strips: Callable[[AlbedoColour], _Strips]
    name: str


class _Edit(NamedTuple):
    """What is done to every tile."""

    edits: dict[str, PigmentEdit]
    paints: dict[str, Path]
    brushes: list[Brush]
    mask: Path | None
    is_named: bool

    @property
    def changes_nothing(self) -> bool:
        plain = all(edit == PigmentEdit() for edit in self.edits.values())
        return plain and not self.paints and not self.brushes


def edit(options: argparse.Namespace) -> None:
    """Write NAME_edited beside a texture, of its own type, bits and profile."""
    wanted, from_maps = _read_edit(options), options.texture.suffix.lower() == ".json"
    if not wanted.is_named and not from_maps:
        raise InputError(
            f"No edit of {options.texture} is named; give a factor, such as --melanin 1.5, a "
            "--preset or a --brush."
        )
    with ExitStack() as stack:
        if from_maps:
            tiles, colour, digest, stem, folder = _open_maps(options, stack)
        else:
            tiles, colour, digest, stem, folder = _open_texture(options, stack)
        folder = make_folder(options.output or folder, "choose another folder with -o")
        stack.enter_context(lock_folder(folder))
        ends = [_name_end(one) for one in tiles]
        # Without an edit the maps give the texture again, which replaces no edit.
        stem = choose_stem(
            folder, f"{stem}_edited", ends, lambda file: wanted.is_named and owns(file, digest)
        )
        files = [folder / (stem + end) for end in ends]
        _write(tiles, files, colour, wanted, digest)
    if wanted.changes_nothing:
        note("Nothing is edited, so the copy has the colours of the texture itself.")
    _print(options, wanted, files)


def _read_edit(options: argparse.Namespace) -> _Edit:
    preset = PRESETS.get(options.preset)
    edits, paints = {}, {}
    for name in _PIGMENTS:
        word = getattr(options, f"{name}_paint")
        value = _read_value(word)
        if word is not None and value is None:
            paints[name] = Path(word)
        given = getattr(options, name)
        factor = (1.0 if given is None else given) * (getattr(preset, name) if preset else 1.0)
        edits[name] = PigmentEdit(factor, getattr(options, f"{name}_add"), value)
    brushes = [parse_brush(word) for word in options.brush]
    if preset and preset.brush:
        brushes.append(_adapt(parse_brush(preset.brush), options))
    given = [getattr(options, name) for name in _PIGMENTS]
    is_named = any(one is not None for one in given) or bool(paints or brushes or preset)
    is_named |= any(edit != PigmentEdit() for edit in edits.values())
    return _Edit(edits, paints, brushes, options.mask, is_named)


def _adapt(brush: Brush, options: argparse.Namespace) -> Brush:
    """A preset's brush covers all of a mask that the user paints."""
    return brush if options.mask is None else Brush(brush.name, {**brush.values, "cover": 1.0})


def _read_value(word: str | None) -> float | None:
    try:
        return None if word is None else float(word)
    except ValueError:
        return None


def _open_texture(
    options: argparse.Namespace, stack: ExitStack
) -> tuple[list[_Tile], AlbedoColour, str, str, Path]:
    found = find_set(options.texture, options.partial)
    textures = open_all(found, options.space, stack)
    colour = make_colour(options, textures)
    digest = compute_set_digest(one.path for one in textures)
    tiles = []
    for (tile, path), texture in zip(found.list_files(), textures, strict=True):
        encoding = Encoding(texture.type, texture.linear)
        tiles.append(_Tile(tile, texture, encoding, _make_reader(texture, encoding), str(path)))
    return tiles, colour, digest, found.stem, found.pattern.parent


def _make_reader(texture: TextureFile, encoding: Encoding) -> Callable[[AlbedoColour], _Strips]:
    def read(colour: AlbedoColour) -> _Strips:
        for stored in texture.read_strips():
            yield stored, invert_rows(stored, texture, encoding, colour).maps

    return read


def _open_maps(
    options: argparse.Namespace, stack: ExitStack
) -> tuple[list[_Tile], AlbedoColour, str, str, Path]:
    path = options.texture
    record = read_record(path)
    transform = np.array(record["transform"], float)
    colour = AlbedoColour(record["light"], record["camera"], transform)
    tiles, files = [], []
    for one in record["tiles"]:
        names = {name: path.parent / file for name, file in one["files"].items()}
        files += list(names.values())
        offset = open_texture(names["offset"], "linear" if record["linear"] else "sRGB")
        stack.callback(offset.close)
        encoding = Encoding(record["type"], record["linear"])
        reader = _make_maps_reader(names, offset, encoding)
        tiles.append(_Tile(one["tile"], offset, encoding, reader, str(path)))
    digest = compute_set_digest([path, *files])
    return tiles, colour, digest, path.name.removesuffix(RECORD_END), path.parent


def _make_maps_reader(
    names: dict[str, Path], offset: TextureFile, encoding: Encoding
) -> Callable[[AlbedoColour], _Strips]:
    def read(colour: AlbedoColour) -> _Strips:
        planes = {name: _read_plane(names[name], offset) for name in (*_PIGMENTS, "skin")}
        top = 0
        for stored in offset.read_strips():
            rows = slice(top, top + len(stored))
            top += len(stored)
            f_mel, f_blood = (to_fractions(planes[name][rows], name) for name in _PIGMENTS)
            yield _restore(stored, offset, encoding, colour, f_mel, f_blood, planes["skin"][rows])

    return read


def _restore(
    stored: NDArray[Any],
    offset: TextureFile,
    encoding: Encoding,
    colour: AlbedoColour,
    f_mel: Float32[np.ndarray, "rows width"],
    f_blood: Float32[np.ndarray, "rows width"],
    skin: NDArray[Any],
) -> tuple[NDArray[Any], AlbedoMaps]:
    """Put rows of a texture together from its maps."""
    rgb, model = list(offset.rgb), colour.decode(f_mel, f_blood)
    whole = stored.astype(encoding.dtype)
    whole[..., rgb] = encoding.add(stored[..., rgb], model)
    nothing = np.zeros_like(f_mel)
    weight = skin.astype(np.float32) / np.float32(255)
    rest = encoding.decode(whole[..., rgb]) - model
    return whole, AlbedoMaps(f_mel, f_blood, nothing, nothing, weight, rest)


def _read_plane(path: Path, like: TextureFile) -> NDArray[Any]:
    """Read a map of one channel, and check its size."""
    oiio = import_openimageio()
    source = oiio.ImageInput.open(str(path))
    if source is None:
        oiio.geterror()
        raise InputError(f"{path} is not a map that can be read; give a grey PNG of 16 bits.")
    spec = source.spec()
    values = source.read_image(0, 0, 0, 1, str(spec.format))
    source.close()
    if values is None:
        raise InputError(f"{path} is damaged or cut short; make it again.")
    _check_size(path, (spec.height, spec.width), like)
    return np.asarray(values)[..., 0]


def _check_size(path: Path, shape: tuple[int, ...], like: TextureFile) -> None:
    height, width = like.spec.height, like.spec.width
    if shape[:2] != (height, width):
        raise InputError(
            f"{path} is {shape[1]} x {shape[0]} and the texture {width} x {height}; draw it at the "
            "texture's size."
        )


def _write(
    tiles: list[_Tile], files: list[Path], colour: AlbedoColour, wanted: _Edit, digest: str
) -> None:
    texels = sum(one.texture.spec.width * one.texture.spec.height for one in tiles)
    notes: list[str] = []
    is_black = wanted.mask is not None
    with write_together() as temporary, show_rows(texels) as advance:
        for tile, file in zip(tiles, files, strict=True):
            mask = _read_mask(wanted.mask, tile)
            is_black &= mask is not None and not mask.any()
            notes += _write_tile(tile, temporary(file), colour, wanted, mask, digest, advance)
        if is_black and wanted.mask is not None:
            raise describe_black(wanted.mask)
    for sentence in notes:
        note(sentence)


def _write_tile(
    tile: _Tile,
    part: Path,
    colour: AlbedoColour,
    wanted: _Edit,
    mask: NDArray[Any] | None,
    digest: str,
    advance: Callable[[int], None],
) -> list[str]:
    texture, counts = tile.texture, TextureCounts()
    paints = {name: _read_paint(path, name, tile) for name, path in wanted.paints.items()}
    spec = describe_copy(texture, str(Mark("edit-albedo", "edited", digest)))
    spec.set_format(tile.encoding.type)
    with TextureWriter(part, spec) as writer:
        top = 0
        for stored, maps in tile.strips(colour):
            rows = slice(top, top + len(stored))
            top += len(stored)
            weight = maps.skin if mask is None else maps.skin * to_share(mask[rows])
            here = {name: plane[rows] for name, plane in paints.items()}
            fractions = _edit_fractions(maps, weight, here, wanted, _place(tile, rows))
            rgb = list(texture.rgb)
            counts.add(
                tile.encoding.normalise(stored[..., rgb]).reshape(-1, 3),
                maps.flatten(),
                get_opaque(stored, texture).ravel(),
            )
            writer.write(_recolour(stored, maps, fractions, colour, tile))
            advance(maps.f_mel.size)
    return counts.check(tile.name)


def _edit_fractions(
    maps: AlbedoMaps,
    weight: Float32[np.ndarray, "rows width"],
    paints: dict[str, Float32[np.ndarray, "rows width"]],
    wanted: _Edit,
    place: tuple[NDArray[Any], NDArray[Any]],
) -> tuple[Float32[np.ndarray, "rows width"], ...]:
    """Edit both fractions: painted maps, then factors and additions, then brushes."""
    brushed = [brush.compute_factors(*place) for brush in wanted.brushes]
    found = []
    for k, name in enumerate(_PIGMENTS):
        after = wanted.edits[name](paints.get(name, maps[k]))
        for factors in brushed:
            after = after * factors[k]
        found.append(_blend(maps[k], after, weight))
    return tuple(found)


def _recolour(
    stored: NDArray[Any],
    maps: AlbedoMaps,
    fractions: tuple[Float32[np.ndarray, "rows width"], ...],
    colour: AlbedoColour,
    tile: _Tile,
) -> NDArray[Any]:
    """Give texels whose fractions changed their colours; the others keep their stored values."""
    rgb = list(tile.texture.rgb)
    changed = (fractions[0] != maps.f_mel) | (fractions[1] != maps.f_blood)
    if not changed.any():
        return stored
    place = np.nonzero(changed)
    linear = tile.encoding.decode(stored[place][:, rgb])
    here = AlbedoMaps(*(one[place] for one in maps))
    edited = colour._recolour(linear, here, *(one[place] for one in fractions))
    result, values = stored.copy(), stored[place]
    values[:, rgb] = tile.encoding.encode(edited)
    result[place] = values
    return result


def _place(tile: _Tile, rows: slice) -> tuple[NDArray[Any], NDArray[Any]]:
    """Places of the texels of rows: u of the columns, and v, upwards, of the rows."""
    spec, (u, v) = tile.texture.spec, find_corner(tile.tile)
    across = u + (np.arange(spec.width) + 0.5) / spec.width
    return across, v + 1 - (np.arange(rows.start, rows.stop) + 0.5) / spec.height


def _find_tile(path: Path, tile: _Tile) -> Path:
    """The file of a tile, where the path is a pattern or one tile of a set."""
    if tile.tile is None:
        return path
    named = TextureSet(path).name_tile(tile.tile)
    if TOKEN not in path.name or not named.exists():
        raise InputError(
            f"The texture has the tile {tile.tile}, and {path} has no such tile; draw one "
            f"for each tile, and name them by a pattern with {TOKEN}."
        )
    return named


def _read_mask(path: Path | None, tile: _Tile) -> NDArray[Any] | None:
    if path is None:
        return None
    named = _find_tile(path, tile)
    mask = read_edit_mask(named, may_be_black=tile.tile is not None)
    _check_size(named, mask.shape, tile.texture)
    return mask


def _read_paint(path: Path, name: str, tile: _Tile) -> Float32[np.ndarray, "height width"]:
    named = _find_tile(path, tile)
    if not named.is_file():
        raise InputError(
            f"--{name}-paint is a volume fraction in [0, 1], or a painted map; got {path}."
        )
    values = _read_plane(named, tile.texture)
    if values.dtype.kind == "f":
        return np.asarray(values.clip(0, 1), np.float32)
    return np.asarray(values * np.float32(WHITES[name] / np.iinfo(values.dtype).max), np.float32)


def _name_end(tile: _Tile) -> str:
    suffix = choose_suffix(tile.texture.path, tile.encoding.is_float)
    return f"{'' if tile.tile is None else f'.{tile.tile}'}{suffix}"


def _print(options: argparse.Namespace, wanted: _Edit, files: list[Path]) -> None:
    if options.json:
        record = {
            **{name: asdict(one) for name, one in wanted.edits.items()},
            "preset": options.preset,
            "brushes": [{"name": one.name, **one.values} for one in wanted.brushes],
            "files": [str(file) for file in files],
        }
        print_line(json.dumps(record, allow_nan=False))
        return
    print_line(f"{options.texture}: {', '.join(map(str, files))}")
