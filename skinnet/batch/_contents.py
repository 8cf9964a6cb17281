"""The files or bytes of the photographs of a block."""

from collections.abc import Iterator, Sequence
from itertools import groupby
from pathlib import Path

from skinnet.batch._job import Job
from skinnet.batch._parquet_input import read_rows
from skinnet.batch._photographs import NO_ROW, Photograph
from skinnet.batch._places import find_place
from skinnet.batch._rows import Content
from skinnet.errors import InputError

_LARGEST = 2**31 - 1
"""Bytes of a file in a store; it is held in memory."""


def load(photographs: Sequence[Photograph], job: Job) -> Iterator[Content]:
    """Load photographs one after the other; a fault is part of what is yielded."""
    for source, group in groupby(photographs, lambda each: (each.source, each.row == NO_ROW)):
        if source[1]:
            yield from (_load_file(each, job.query) for each in group)
        else:
            yield from _load_rows(list(group), job)


def _load_file(photograph: Photograph, query: str) -> Content:
    if photograph.fault:
        return Content(photograph, None, photograph.fault)
    if "://" not in photograph.source:
        return Content(photograph, Path(photograph.source))
    if photograph.size > _LARGEST:
        fault = f"{photograph.file} has {photograph.size:,} bytes; give pictures below 2 GB."
        return Content(photograph, None, fault)
    try:
        return Content(photograph, find_place(photograph.source + query).read())
    except InputError as error:
        return Content(photograph, None, str(error))


def _load_rows(photographs: list[Photograph], job: Job) -> Iterator[Content]:
    url = photographs[0].source
    loaded = 0
    try:
        place = find_place(url + job.query if "://" in url else url)
        rows = read_rows(
            place, [each.row for each in photographs], job.bytes_column, job.name_column
        )
        for photograph, (name, data) in zip(photographs, rows, strict=False):
            loaded += 1
            named = photograph._replace(file=name or photograph.file)
            fault = "" if data else f"{named.file} has no bytes; check {photograph.file}."
            yield Content(named, data or None, fault)
        fault = "It is no longer in {}."
    except InputError as error:
        fault = str(error)
    for photograph in photographs[loaded:]:
        yield Content(photograph, None, fault.format(url))
