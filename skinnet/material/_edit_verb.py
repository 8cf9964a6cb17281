"""`skinnet edit-albedo`: pigments of an albedo texture edited, from the texture or its maps."""

import argparse
import json
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import asdict
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Float32
from numpy.typing import NDArray

from skinnet.appearance.edit import PigmentEdit
from skinnet.files import make_folder, write_together
from skinnet.images._mark import Mark
from skinnet.images._result_names import choose_stem, lock_folder
from skinnet.inference._edit_mask import describe_black
from skinnet.inference._editing import to_share
from skinnet.inference._messages import note, print_line
from skinnet.material._brushes import Brush, parse_brush
from skinnet.material._edit_masks import read_mask, read_paint
from skinnet.material._edit_tiles import EditedTile, open_tiles
from skinnet.material._invert_verb import get_opaque
from skinnet.material._map_files import describe_edited, owns
from skinnet.material._presets import PRESETS
from skinnet.material._rows_progress import show_rows
from skinnet.material._texture_checks import TextureCounts
from skinnet.material._texture_file import TextureWriter, describe_copy
from skinnet.material.albedo import AlbedoColour, AlbedoMaps, _blend

_PIGMENTS = ("melanin", "hemoglobin")


class _Edit(NamedTuple):
    """What is done to every tile."""

    edits: dict[str, PigmentEdit]
    paints: dict[str, Path]
    brushes: list[Brush]
    mask: Path | None

    @property
    def changes_nothing(self) -> bool:
        plain = all(edit == PigmentEdit() for edit in self.edits.values())
        return plain and not self.paints and not self.brushes


def edit(options: argparse.Namespace) -> None:
    """Write NAME_edited beside a texture, of its own type, bits and profile."""
    wanted = _read_edit(options)
    with ExitStack() as stack:
        tiles, colour, digest, stem, folder = open_tiles(options, stack)
        folder = make_folder(options.output or folder, "choose another folder with -o")
        stack.enter_context(lock_folder(folder))
        ends = [one.name_end() for one in tiles]
        # Without an edit the texture comes back, which replaces no edit.
        stem = choose_stem(
            folder,
            f"{stem}_edited",
            ends,
            lambda file: not wanted.changes_nothing and owns(file, digest),
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
    return _Edit(edits, paints, brushes, options.mask)


def _adapt(brush: Brush, options: argparse.Namespace) -> Brush:
    """A preset's brush covers all of a mask that the user paints."""
    return brush if options.mask is None else Brush(brush.name, {**brush.values, "cover": 1.0})


def _read_value(word: str | None) -> float | None:
    try:
        return None if word is None else float(word)
    except ValueError:
        return None


def _write(
    tiles: list[EditedTile], files: list[Path], colour: AlbedoColour, wanted: _Edit, digest: str
) -> None:
    texels = sum(one.texture.spec.width * one.texture.spec.height for one in tiles)
    notes: list[str] = []
    is_black = wanted.mask is not None
    with write_together() as temporary, show_rows(texels) as advance:
        for tile, file in zip(tiles, files, strict=True):
            mask = read_mask(wanted.mask, tile)
            is_black &= mask is not None and not mask.any()
            notes += _write_tile(tile, temporary(file), colour, wanted, mask, digest, advance)
        if is_black and wanted.mask is not None:
            raise describe_black(wanted.mask)
    for sentence in notes:
        note(sentence)


def _write_tile(
    tile: EditedTile,
    part: Path,
    colour: AlbedoColour,
    wanted: _Edit,
    mask: NDArray[Any] | None,
    digest: str,
    advance: Callable[[int], None],
) -> list[str]:
    texture, counts = tile.texture, TextureCounts()
    paints = {name: read_paint(path, name, tile) for name, path in wanted.paints.items()}
    spec = describe_copy(texture, str(Mark("edit-albedo", "edited", digest)))
    spec.set_format(tile.encoding.type)
    with TextureWriter(part, spec) as writer:
        top = 0
        for stored, maps in tile.strips(colour):
            rows = slice(top, top + len(stored))
            top += len(stored)
            weight = maps.skin if mask is None else maps.skin * to_share(mask[rows])
            here = {name: plane[rows] for name, plane in paints.items()}
            fractions = _edit_fractions(maps, weight, here, wanted, tile.place(rows))
            rgb = list(texture.rgb)
            counts.add(
                tile.encoding.normalise(stored[..., rgb]).reshape(-1, 3),
                maps.flatten(),
                get_opaque(stored, texture).ravel(),
            )
            writer.write(_recolour(stored, maps, fractions, colour, tile))
            advance(maps.f_mel.size)
    return [*describe_edited(texture.path), *counts.check(tile.name)]


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
    tile: EditedTile,
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
