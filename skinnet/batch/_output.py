"""The folder of a batch: parts in Parquet, each of which is there whole or not at all.

    OUTPUT/part-0123456789abcdef.parquet    rows; the name is a digest of the keys in it
    OUTPUT/_skinnet/settings.json           what the numbers depend on
    OUTPUT/_skinnet/run.json                the run that may write
    OUTPUT/_skinnet/plan-TOKEN.parquet      the blocks of that run
    OUTPUT/_skinnet/unfinished/             parts that are being written
    OUTPUT/_skinnet/attempts/               blocks that are being read

Readers of Parquet pass over names that begin with an underscore.
"""

import hashlib
import json
import os
import re
from collections import Counter
from collections.abc import Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from secrets import token_hex
from typing import Any, NamedTuple

import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq
from pyarrow.fs import FileType

from skinnet._version import __version__
from skinnet.batch._columns import READ
from skinnet.batch._parquet_input import open_parquet
from skinnet.batch._photographs import NO_ROW
from skinnet.batch._places import Place, explain, find_place
from skinnet.errors import InputError

FORMAT = 1

_OWN = "_skinnet"
_PART = re.compile(r"part-[0-9a-f]{16}\.parquet")
_KNOWN = ("key", "file", "source", "source_row", "status", "reason")
_KEPT = ("settings.json", "run.json")
_THREADS = 16


class Record(NamedTuple):
    """What a part says of a photograph.

    Attributes:
        part: The part.
        file: The photograph.
        place: Path of its file, and its row there.
        status: What became of it.
        reason: Why it was not read.
        rows: Its faces, or 1.
    """

    part: str
    file: str
    place: tuple[str, int]
    status: str
    reason: str
    rows: int


@dataclass(frozen=True)
class Output:
    """The folder of a batch, as the driver and the workers see it.

    Attributes:
        folder: The folder.
        token: Names the run that may write.
    """

    folder: Place
    token: str

    @property
    def _own(self) -> Place:
        return self.folder.join(_OWN)

    @property
    def plan(self) -> Place:
        """The file of the blocks of this run."""
        return self._own.join(f"plan-{self.token}.parquet")

    def name_attempt(self, part: str) -> Place:
        """The file that counts how often a block was begun."""
        return self._own.join("attempts").join(f"{part.removesuffix('.parquet')}.json")

    def check_run(self) -> None:
        """Check that no other run has begun since, and that this machine sees the folder.

        Raises:
            InputError: It does not, or one has.
        """
        place = self._own.join("run.json")
        if not place.exists():
            raise InputError(
                f"{self.folder.url} of this run is not seen on every machine of the cluster; give "
                "a folder that all share, or a URL such as s3://bucket/folder."
            )
        if json.loads(place.read())["run"] != self.token:
            raise InputError(
                f"Another run writes to {self.folder.url}, and this one ends; what it has written "
                "stays."
            )

    def has(self, part: str) -> bool:
        """Whether a part is written."""
        return self.folder.join(part).exists()

    def write(self, part: str, tables: Iterable[pa.Table]) -> None:
        """Write a part, one group of rows a table: under another name first, and whole.

        An earlier part of this name is replaced in one step. Its rows are the same, as the name is
        made of their keys.
        """
        unfinished = self._own.join("unfinished").join(f"{part}-{token_hex(4)}")
        try:
            self._write_unfinished(unfinished, tables)
            self.check_run()
            unfinished.move(self.folder.join(part))
        except BaseException:
            if unfinished.exists():
                unfinished.delete()
            raise

    def _write_unfinished(self, place: Place, tables: Iterable[pa.Table]) -> None:
        with explain(place.url), place.filesystem.open_output_stream(place.path) as stream:
            writer: pq.ParquetWriter | None = None
            for table in tables:
                writer = writer or pq.ParquetWriter(stream, table.schema, compression="zstd")
                writer.write_table(table)
            if writer is not None:
                writer.close()
        if place.is_local:
            _flush(place.path)

    def begin(self) -> None:
        """Make this the run that may write, and remove what earlier runs left unfinished."""
        for name in ("unfinished", "attempts"):
            self._own.join(name).make_folder()
        self._own.join("run.json").write(json.dumps({"run": self.token}).encode())
        for place, info in self._own.list(recursive=True):
            if info.type == FileType.File and place.name not in _KEPT:
                place.delete()

    def end(self) -> None:
        """Remove the plan; the workers are done."""
        if self.plan.exists():
            self.plan.delete()

    def read_records(self) -> dict[str, list[Record]]:
        """Read what the parts say of each photograph, by its key."""
        parts = [place for place, _ in self.folder.list() if _PART.fullmatch(place.name)]
        found: dict[str, list[Record]] = {}
        with ThreadPoolExecutor(_THREADS) as pool:
            for records in pool.map(_read_part, parts):
                for key, record in records:
                    found.setdefault(key, []).append(record)
        return found

    def drop(self, keys: dict[str, set[str]]) -> None:
        """Remove photographs from parts.

        Args:
            keys: Keys to remove, by the name of the part.
        """
        for part, gone in keys.items():
            place = self.folder.join(part)
            with open_parquet(place) as file:
                kept = sum(len(each) for each in _filter(file, gone))
                if kept:
                    self.write(part, _filter(file, gone))
            if not kept:
                place.delete()


def open_output(name: str, settings: dict[str, Any]) -> Output:
    """Open the folder of a batch, or make it.

    Args:
        name: The folder; a path or a URL.
        settings: What the numbers depend on: the model, the faces that are read and the like.

    Raises:
        InputError: It holds other files, was written with other settings, or cannot be written.
    """
    folder = find_place(name)
    info = folder.stat()
    if info.type == FileType.File:
        raise InputError(f"{name} is a file; give a folder for the Parquet files.")
    output = Output(folder, token_hex(8))
    place = folder.join(_OWN).join("settings.json")
    entries = [place.name for place, _ in folder.list() if place.name not in (".DS_Store", "")]
    others = [each for each in entries if each != _OWN and not _PART.fullmatch(each)]
    if others or (entries and not place.exists()):
        _refuse_others(name, (others or entries)[0])
    if not entries:
        folder.join(_OWN).make_folder()
        place.write(json.dumps({"format": FORMAT, "skinnet": __version__, **settings}).encode())
    _check_settings(name, json.loads(place.read()), settings)
    return output


def name_part(keys: Iterable[str]) -> str:
    """Name the part of some photographs; whoever reads them gives it the same name."""
    digest = hashlib.sha256("".join(sorted(keys)).encode()).hexdigest()
    return f"part-{digest[:16]}.parquet"


def find_repeated(records: dict[str, list[Record]]) -> dict[str, set[str]]:
    """Find photographs that are in several parts: keys to drop, by part, so that one stays."""
    found: dict[str, set[str]] = {}
    for key, each in records.items():
        for record in sorted(each)[1:]:
            found.setdefault(record.part, set()).add(key)
    return found


def _refuse_others(name: str, other: str) -> None:
    raise InputError(
        f"{name} holds other files, such as {other}; give a folder that is empty, does not exist, "
        "or was written by this command."
    )


def _check_settings(name: str, written: dict[str, Any], settings: dict[str, Any]) -> None:
    if written.get("format") != FORMAT:
        version = written.get("skinnet", "unknown")
        raise InputError(f"{name} was written by skinnet {version}; give another folder.")
    for key, value in settings.items():
        if written.get(key) != value:
            raise InputError(
                f"{name} was written with {key} {written.get(key)}, and now {key} is {value}; "
                "numbers of both are not mixed. Give the same, or another folder."
            )


def _read_part(place: Place) -> list[tuple[str, Record]]:
    try:
        with open_parquet(place) as file:
            columns = file.read(list(_KNOWN)).to_pydict()
    except InputError as error:
        raise InputError(
            f"{place.url} is damaged. Remove it, and run again: its photographs are read again."
        ) from error
    rows = Counter(columns["key"])
    found: dict[str, Record] = {}
    for key, file_, source, row, status, reason in zip(*columns.values(), strict=True):
        where = (source, NO_ROW if row is None else row)
        found[key] = Record(place.name, file_, where, status, reason or "", rows[key])
    return list(found.items())


def _flush(path: str) -> None:
    """Have the system write a file to its disk before its name says that it is whole."""
    with open(path, "rb+") as file:
        os.fsync(file.fileno())


def _filter(file: pq.ParquetFile, gone: set[str]) -> Iterator[pa.Table]:
    """The groups of rows of a part without some photographs."""
    for group in range(file.num_row_groups):
        table = file.read_row_group(group)
        left = table.filter(pc.invert(pc.is_in(table["key"], pa.array(sorted(gone)))))
        if len(left):
            yield left


def is_read(record: Record) -> bool:
    """Whether a photograph was read."""
    return record.status == READ
