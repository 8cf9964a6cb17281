"""The table of faces: what was read of each face, or why a file was not read."""

from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

from skinnet.images.faces._face_regions import REGION_NAMES
from skinnet.inference._csv_file import CsvFile
from skinnet.inference._index_table import INDICES, OPTICS
from skinnet.inference._uncertainty import PIGMENTS

_ABOUT = ("file", "face", "reason", "faces_found", "skin_share", "capture_known")
_MODEL = ("sha256", "optics", "model_version", "version", "notes")
_WITH_INTERVAL = (*PIGMENTS, *INDICES, "monk_tone")


def _name_measures(prefix: str = "") -> Iterator[str]:
    """Columns of the numbers of a face, or of a region with its name before them."""
    for name in _WITH_INTERVAL:
        yield from (f"{prefix}{name}", f"{prefix}{name}_low", f"{prefix}{name}_high")
    yield f"{prefix}monk_delta_e"
    yield f"{prefix}typology_group"


def _name_region_measures(region: str) -> Iterator[str]:
    yield f"{region}_share"
    yield from _name_measures(f"{region}_")


COLUMNS = (
    *_ABOUT,
    *_name_measures(),
    *(name for region in REGION_NAMES for name in _name_region_measures(region)),
    *_MODEL,
)
"""Columns of the table, in this order.

A number and its 90 % interval are NAME, NAME_low and NAME_high; those of a part of the face begin
with its name, and REGION_share is the part of it that is skin. Cells of what is not known are
empty.
"""


class FaceTable:
    """A CSV file to which the faces of a run are added, or nothing if none was asked for.

    Args:
        path: The file; None for none.

    Raises:
        InputError: The file is not such a table, or cannot be written.
    """

    def __init__(self, path: Path | None) -> None:
        self._file = None if path is None else CsvFile(path, COLUMNS)
        self._other_optics: dict[str, None] = {}

    def add(self, summaries: Iterable[Mapping[str, Any]]) -> None:
        """Add the faces of a photograph, all or none."""
        if self._file is None:
            return
        rows = [_make_row(summary) for summary in summaries]
        self._file.append(rows)
        optics = (str(row["optics"]) for row in rows if row["optics"] != OPTICS)
        self._other_optics |= dict.fromkeys(optics)

    def add_failure(self, file: str, reason: str) -> None:
        """Add a file that was not read."""
        if self._file is not None:
            self._file.append([{"file": file, "reason": reason}])

    @property
    def notes(self) -> list[str]:
        """What the user should know of the table."""
        return [
            f"Fractions of the preset {name} were read; indices are known for {OPTICS} alone, and "
            "their columns are empty."
            for name in self._other_optics
        ]


def _make_row(summary: Mapping[str, Any]) -> dict[str, Any]:
    """Make the row of a face from its summary, which names its file.

    Args:
        summary: The content of the JSON file of the face.

    Returns:
        Cells by column; None for what is not known.
    """
    about = {name: summary[name] for name in ("file", "faces_found", "skin_share", "version")}
    row: dict[str, Any] = dict.fromkeys(COLUMNS) | about
    row |= {
        "face": summary["id"],
        "capture_known": " ".join(summary["capture_known"]),
        "sha256": summary["input"]["sha256"],
        "optics": summary["model"].get("optics"),
        "model_version": summary["model"]["version"],
        "notes": " ".join(summary["notes"]),
    }
    row |= _list_measures(summary["pigments"], summary["indices"])
    for name, region in summary["regions"].items():
        row[f"{name}_share"] = region["share"]
        row |= _list_measures(region, region["indices"], f"{name}_")
    return row


def _list_measures(
    pigments: Mapping[str, Any], indices: Mapping[str, Any] | None, prefix: str = ""
) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for name in PIGMENTS:
        found |= _spread(f"{prefix}{name}", pigments[name]["mean"], pigments[name]["interval"])
    if indices is None:
        return found
    for name in (*INDICES, "monk_tone"):
        found |= _spread(f"{prefix}{name}", indices[name]["value"], indices[name]["interval"])
    found[f"{prefix}monk_delta_e"] = indices["monk_tone"]["delta_e"]
    found[f"{prefix}typology_group"] = indices["typology_group"]
    return found


def _spread(name: str, value: Any, interval: Any) -> dict[str, Any]:
    low, high = interval or (None, None)
    return {name: value, f"{name}_low": low, f"{name}_high": high}
