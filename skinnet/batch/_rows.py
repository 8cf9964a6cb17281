"""The rows of a photograph: one for each face, or one that says why there is none."""

import hashlib
from collections.abc import Iterator, Sequence
from datetime import UTC, datetime
from io import BytesIO
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

import pyarrow as pa

from skinnet._version import __version__
from skinnet.batch._columns import FAILED, NO_FACE, READ, flatten, list_columns, name_map
from skinnet.batch._job import Model, Reading
from skinnet.batch._photographs import NO_ROW, UNKNOWN, Photograph
from skinnet.errors import InputError, NoFaceError
from skinnet.images._mark import Mark, read_mark
from skinnet.images._result_names import compute_digest
from skinnet.images._walk import check_mark
from skinnet.images.photograph import read_picture
from skinnet.inference._messages import describe
from skinnet.inference.decomposer import Decomposer
from skinnet.inference.decomposition import MAP_FILES, Decomposition
from skinnet.inference.results import _write_map

Row = dict[str, Any]

_TYPES = {
    "string": pa.string(),
    "strings": pa.list_(pa.string()),
    "double": pa.float64(),
    "doubles": pa.list_(pa.float64()),
    "points": pa.list_(pa.list_(pa.float64())),
    "int64": pa.int64(),
    "bool": pa.bool_(),
    "time": pa.timestamp("us", tz="UTC"),
    "bytes": pa.binary(),
}


class Content(NamedTuple):
    """A photograph with what is to be read.

    Attributes:
        photograph: The photograph.
        source: Its file on this machine, or its bytes; None if it cannot be read.
        fault: Why it cannot be read.
    """

    photograph: Photograph
    source: Path | bytes | None
    fault: str = ""


def make_schema(lights: Sequence[str], maps: bool) -> pa.Schema:
    """The columns with their types and descriptions, the same in all parts of an output."""
    return pa.schema(
        [
            pa.field(name, _TYPES[kind], metadata={"description": description})
            for name, kind, description in list_columns(lights, maps)
        ]
    )


def read_rows(
    decomposer: Decomposer, content: Content, reading: Reading, model: Model
) -> list[Row]:
    """Read a photograph, whatever it is. A fault of one does not end the others."""
    about = _describe(content.photograph, model)
    if content.source is None:
        return [about | {"status": FAILED, "reason": content.fault}]
    try:
        return [about | row for row in _read(decomposer, content, reading)]
    except NoFaceError as error:
        return [about | {"status": NO_FACE, "reason": str(error)}]
    except (InputError, OSError) as error:
        return [about | {"status": FAILED, "reason": describe(error)}]
    except Exception as error:
        reason = (
            f"An unexpected fault of skinnet: {type(error).__name__}: {error}; please report it."
        )
        return [about | {"status": FAILED, "reason": reason}]


def make_failure(photograph: Photograph, model: Model, reason: str) -> Row:
    """The row of a photograph that is not read."""
    return _describe(photograph, model) | {"status": FAILED, "reason": reason}


def _describe(photograph: Photograph, model: Model) -> Row:
    seconds = photograph.modified / 1e9
    return {
        "key": photograph.key,
        "file": photograph.file,
        "source": photograph.source,
        "source_row": None if photograph.row == NO_ROW else photograph.row,
        "source_size": None if photograph.size == UNKNOWN else photograph.size,
        "source_modified": datetime.fromtimestamp(seconds, UTC) if photograph.modified else None,
        "version": __version__,
        "model_version": model.version,
    }


def _read(decomposer: Decomposer, content: Content, reading: Reading) -> Iterator[Row]:
    source, name = content.source, content.photograph.file
    assert source is not None
    notes = check_mark(read_mark(_open(source)), name)
    picture, digest = read_picture(_open(source), name), _compute_digest(source)
    found = decomposer(
        picture,
        name=name,
        detail=reading.detail,
        faces=reading.faces,
        region=reading.region,
    )
    for each in found:
        row = dict(flatten(each.to_dict(), ""))
        row["notes"] = [*notes, *row["notes"]]
        maps = _encode_maps(each, digest) if reading.maps else {}
        yield {"status": READ, "input_sha256": digest} | row | maps


def _open(source: Path | bytes) -> Path | BytesIO:
    return source if isinstance(source, Path) else BytesIO(source)


def _compute_digest(source: Path | bytes) -> str:
    if isinstance(source, Path):
        return compute_digest(source)
    return hashlib.sha256(source).hexdigest()


def _encode_maps(decomposition: Decomposition, digest: str) -> dict[str, bytes]:
    """The files of maps that `skinnet predict` writes."""
    mark, found = Mark("predict", "map", digest), {}
    with TemporaryDirectory(prefix="skinnet-") as folder:
        for name in MAP_FILES:
            path = Path(folder) / f"{name}.png"
            _write_map(path, name, decomposition, mark)
            found[name_map(name)] = path.read_bytes()
    return found
