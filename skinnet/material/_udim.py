"""Sets of UDIM tiles: which files belong together, and where each lies in texture space."""

import re
from dataclasses import dataclass
from pathlib import Path

from skinnet.errors import InputError

TOKEN = "<UDIM>"
"""Stands for the number of a tile in a pattern, as in face.<UDIM>.png."""

_TILE = re.compile(r"(?<!\d)(1\d{3})(?!\d)(?=[^/\\]*$)")
_FIRST, _ROW = 1001, 10


@dataclass(frozen=True)
class TextureSet:
    """The files of one texture.

    Attributes:
        pattern: The path, with `TOKEN` for the number of a tile if there are tiles.
        tiles: Numbers of the tiles; empty for a texture of one file.
    """

    pattern: Path
    tiles: tuple[int, ...] = ()

    @property
    def stem(self) -> str:
        """Name of the texture without its ending and tile."""
        return re.sub(rf"[._-]?{TOKEN}", "", self.pattern.stem) or "texture"

    def list_files(self) -> list[tuple[int | None, Path]]:
        """List tiles with their files; one file has no tile."""
        if not self.tiles:
            return [(None, self.pattern)]
        return [(tile, self.name_tile(tile)) for tile in self.tiles]

    def name_tile(self, tile: int | None) -> Path:
        """Name the file of a tile."""
        name = self.pattern.name
        return self.pattern.with_name(name if tile is None else name.replace(TOKEN, str(tile)))


def find_set(given: Path, partial: bool = False) -> TextureSet:
    """Find the files of a texture.

    Args:
        given: A file, a pattern with `TOKEN`, or one tile of a set.
        partial: Whether tiles may be missing.

    Returns:
        The set; a tile without siblings is a texture of its own.

    Raises:
        InputError: A pattern fits no file, or tiles between others are missing.
    """
    name = given.name.replace("%(UDIM)d", TOKEN).replace("%04d", TOKEN)
    found = _TILE.search(name)
    if TOKEN not in name:
        if found is None:
            return TextureSet(given)
        name = name[: found.start()] + TOKEN + name[found.end() :]
    tiles = _list_tiles(given.with_name(name))
    if not tiles:
        raise InputError(f"No file fits the pattern {given.with_name(name)}; check the path.")
    if TOKEN not in given.name and tiles in ([], [int(found[1])] if found else []):
        return TextureSet(given)
    if missing := _find_gaps(tiles):
        word = ", ".join(map(str, missing[:5]))
        if not partial:
            raise InputError(
                f"{given.with_name(name)} has the tiles {', '.join(map(str, tiles))}, and {word} "
                "of the set is missing; copy the whole set, or give --partial if there is no more."
            )
    return TextureSet(given.with_name(name), tuple(tiles))


def _list_tiles(pattern: Path) -> list[int]:
    before, _, after = pattern.name.partition(TOKEN)
    fits = re.compile(rf"{re.escape(before)}(1\d{{3}}){re.escape(after)}")
    folder = pattern.parent
    names = (one.name for one in folder.iterdir()) if folder.is_dir() else ()
    numbers = (int(match[1]) for name in names if (match := fits.fullmatch(name)))
    return sorted(number for number in numbers if number >= _FIRST)


def _find_gaps(tiles: list[int]) -> list[int]:
    """Tiles that lie between others of their row, or start a row that has others."""
    rows: dict[int, list[int]] = {}
    for tile in tiles:
        rows.setdefault((tile - _FIRST) // _ROW, []).append(tile)
    gaps = []
    for row in range(max(rows) + 1):
        start = _FIRST + _ROW * row
        known = rows.get(row, [])
        gaps += [tile for tile in range(start, max(known, default=start) + 1) if tile not in known]
    return gaps


def find_corner(tile: int | None) -> tuple[float, float]:
    """Find where a tile begins in texture space: its least u and v."""
    if tile is None:
        return 0.0, 0.0
    row, column = divmod(tile - _FIRST, _ROW)
    return float(column), float(row)
