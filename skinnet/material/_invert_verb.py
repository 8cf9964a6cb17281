"""`skinnet invert`: an albedo texture to maps of pigments, their spread and an offset."""

import argparse
import json
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import ExitStack
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Float32
from numpy.typing import NDArray

from skinnet.files import make_folder, write_together
from skinnet.images._mark import Mark
from skinnet.images._result_names import OUTPUT, choose_stem, describe_input, lock_folder
from skinnet.inference._messages import note, print_line
from skinnet.material._calibrated_colour import make_colour
from skinnet.material._encoding import Encoding
from skinnet.material._map_files import (
    MAPS,
    RECORD_END,
    WHITES,
    compute_set_digest,
    describe_edited,
    name_map,
    owns,
    to_fractions,
    to_pixels,
)
from skinnet.material._rows_progress import show_rows
from skinnet.material._texture_checks import TextureCounts
from skinnet.material._texture_file import (
    TextureFile,
    TextureWriter,
    describe_copy,
    describe_map,
    open_texture,
)
from skinnet.material._udim import TextureSet, find_set
from skinnet.material.albedo import AlbedoColour, AlbedoMaps

_Files = dict[str, str]


class InvertedRows(NamedTuple):
    """Pigments of rows of a texture, as a map of 16 bits holds them.

    Attributes:
        maps: The maps, whose fractions are those of whole pixels.
        model: Linear RGB of the skin model at these fractions, [rows, width, 3].
    """

    maps: AlbedoMaps
    model: Float32[np.ndarray, "rows width 3"]


def invert(options: argparse.Namespace) -> None:
    """Write the maps of a texture, and NAME_maps.json that says what they are."""
    found = find_set(options.texture, options.partial)
    with ExitStack() as stack:
        textures = open_all(found, options.space, stack)
        colour = make_colour(options, textures)
        digest = compute_set_digest(one.path for one in textures)
        folder = make_folder(
            options.output or found.pattern.parent / OUTPUT, "choose another folder with -o"
        )
        stack.enter_context(lock_folder(folder))
        stem = _choose_stem(folder, found, textures, digest)
        record = _describe(found, textures, colour, digest, folder)
        record |= _write(folder, stem, found, textures, colour, record, digest)
    _print(found.pattern, record, folder, stem, options.json)


def open_all(found: TextureSet, space: str | None, stack: ExitStack) -> list[TextureFile]:
    """Open the files of a texture."""
    textures = []
    for _, path in found.list_files():
        textures.append(open_texture(path, space))
        stack.callback(textures[-1].close)
    return textures


def invert_rows(
    stored: NDArray[Any], texture: TextureFile, encoding: Encoding, colour: AlbedoColour
) -> InvertedRows:
    """Invert rows of a texture; transparent texels are not skin."""
    linear = encoding.decode(stored[..., list(texture.rgb)])
    maps = colour.invert(linear)
    f_mel, f_blood = (
        to_fractions(to_pixels(plane, name), name)
        for name, plane in (("melanin", maps.f_mel), ("hemoglobin", maps.f_blood))
    )
    # The offset is that of the pixels, so that these give the exact texture.
    model = colour.decode(f_mel, f_blood)
    maps = maps._replace(f_mel=f_mel, f_blood=f_blood, offset=linear - model)
    if texture.alpha is not None:
        maps = maps._replace(
            skin=np.where(stored[..., texture.alpha] > 0, maps.skin, np.float32(0))
        )
    skin = np.rint(maps.skin * 255).astype(np.float32) / np.float32(255)
    return InvertedRows(maps._replace(skin=skin), model)


def get_opaque(stored: NDArray[Any], texture: TextureFile) -> NDArray[Any]:
    """Return the opacity of rows; ones if there is none."""
    return np.ones(stored.shape[:-1]) if texture.alpha is None else stored[..., texture.alpha]


def _choose_stem(folder: Path, found: TextureSet, textures: list[TextureFile], digest: str) -> str:
    ends = [RECORD_END]
    for (tile, path), texture in zip(found.list_files(), textures, strict=True):
        ends += [name_map("", name, tile, path, texture.is_float) for name in MAPS]
    return choose_stem(folder, found.stem, ends, lambda file: owns(file, digest))


def _describe(
    found: TextureSet,
    textures: list[TextureFile],
    colour: AlbedoColour,
    digest: str,
    folder: Path,
) -> dict[str, Any]:
    first = textures[0]
    return {
        "mark": str(Mark("invert", "maps", digest)),
        "input": describe_input(found.pattern, digest, folder),
        "light": colour.colour.light,
        "camera": colour.colour.camera,
        "transform": colour.colour.calibration.tolist(),
        "type": first.type,
        "linear": first.linear,
        "suffix": first.path.suffix,
        "fraction_of_white": WHITES,
    }


def _write(
    folder: Path,
    stem: str,
    found: TextureSet,
    textures: list[TextureFile],
    colour: AlbedoColour,
    record: dict[str, Any],
    digest: str,
) -> dict[str, Any]:
    """Write all tiles and the record, or nothing."""
    tiles, notes, levels = [], [], _Levels()
    texels = sum(one.spec.width * one.spec.height for one in textures)
    with write_together() as temporary, show_rows(texels) as advance:
        for (tile, path), texture in zip(found.list_files(), textures, strict=True):
            files = {name: name_map(stem, name, tile, path, texture.is_float) for name in MAPS}
            parts = {name: temporary(folder / file) for name, file in files.items()}
            counts = _write_tile(texture, colour, parts, digest, levels, advance)
            notes += [*describe_edited(path), *counts.check(str(path))]
            size = [texture.spec.width, texture.spec.height]
            tiles.append({"tile": tile, "size": size, "files": files})
        more = {**levels.summarise(), "tiles": tiles, "notes": notes}
        text = json.dumps({**record, **more}, indent=2, allow_nan=False)
        temporary(folder / (stem + RECORD_END)).write_text(text + "\n", encoding="utf-8")
    for sentence in notes:
        note(sentence)
    return more


def _write_tile(
    texture: TextureFile,
    colour: AlbedoColour,
    parts: dict[str, Path],
    digest: str,
    levels: "_Levels",
    advance: Callable[[int], None],
) -> TextureCounts:
    """Write the maps of one file; files are written while the next rows are inverted."""
    encoding, counts = Encoding(texture.type, texture.linear), TextureCounts()
    with ExitStack() as stack:
        writers = {
            name: stack.enter_context(TextureWriter(part, _describe_file(texture, name, digest)))
            for name, part in parts.items()
        }
        pool = stack.enter_context(ThreadPoolExecutor(2))  # it ends before the files are closed
        waiting: list[Future[None]] = []
        for stored in texture.read_strips():
            rows = invert_rows(stored, texture, encoding, colour)
            rgb = stored[..., list(texture.rgb)]
            opaque = get_opaque(stored, texture)
            counts.add(encoding.normalise(rgb).reshape(-1, 3), rows.maps.flatten(), opaque.ravel())
            planes = _to_planes(stored, rows, texture, encoding)
            levels.add(planes, rows.maps.skin > 0)
            for one in waiting:
                one.result()
            waiting = [pool.submit(writers[name].write, plane) for name, plane in planes.items()]
            advance(rows.maps.f_mel.size)
        for one in waiting:
            one.result()
    return counts


def _describe_file(texture: TextureFile, name: str, digest: str) -> Any:
    software = str(Mark("invert", "map", digest))
    if name == "offset" and not texture.is_float:
        return describe_copy(texture, software)
    if name == "offset":
        spec = describe_copy(texture, software)
        spec.set_format("float")
        return spec
    texts = {"Software": software}
    if name in WHITES:
        texts["ImageDescription"] = f"{name}: volume fraction, {WHITES[name]:g} at white"
    return describe_map(texture, 1, "uint8" if name == "skin" else "uint16", texts)


def _to_planes(
    stored: NDArray[Any], inverted: InvertedRows, texture: TextureFile, encoding: Encoding
) -> dict[str, NDArray[Any]]:
    """Convert maps to rows of pixels [rows, width, channels]."""
    (maps, model), rgb = inverted, list(texture.rgb)
    fractions = dict(zip(WHITES, maps[:4], strict=True))
    planes = {name: to_pixels(plane, name)[..., None] for name, plane in fractions.items()}
    planes["skin"] = np.rint(maps.skin * 255).astype(np.uint8)[..., None]
    offset = stored.astype(np.float32 if encoding.is_float else encoding.dtype)
    offset[..., rgb] = encoding.subtract(stored[..., rgb], model)
    return planes | {"offset": offset}


class _Levels:
    """Histograms of both pigments over skin, for their percentiles."""

    def __init__(self) -> None:
        self._counts = {name: np.zeros(65536, np.int64) for name in ("melanin", "hemoglobin")}
        self._skin = self._all = 0

    def add(self, planes: dict[str, NDArray[Any]], skin: NDArray[np.bool_]) -> None:
        for name, counts in self._counts.items():
            counts += np.bincount(planes[name][..., 0][skin], minlength=65536)
        self._skin += int(skin.sum())
        self._all += skin.size

    def summarise(self) -> dict[str, Any]:
        found: dict[str, Any] = {"skin_share": self._skin / max(self._all, 1)}
        for name, counts in self._counts.items():
            sums = counts.cumsum()
            places = {"p05": 0.05, "median": 0.5, "p95": 0.95}
            found[name] = {
                key: float(np.searchsorted(sums, share * sums[-1]) * WHITES[name] / 65535)
                if sums[-1]
                else None
                for key, share in places.items()
            }
        return found


def _print(texture: Path, record: dict[str, Any], folder: Path, stem: str, as_json: bool) -> None:
    names = [name for tile in record["tiles"] for name in tile["files"].values()]
    files = [str(folder / name) for name in [*names, stem + RECORD_END]]
    if as_json:
        print_line(json.dumps({**record, "files": files}, allow_nan=False))
        return
    means = ", ".join(
        f"{name} {record[name]['median']:.3g}"
        for name in ("melanin", "hemoglobin")
        if record[name]["median"] is not None
    )
    print_line(
        f"{texture}: median {means or 'of nothing'}; {record['skin_share']:.0%} of "
        f"the texels are skin; {folder / stem}{RECORD_END}"
    )
