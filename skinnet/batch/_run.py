"""A run: what is left to read is read, and then everything is counted."""

import json
import time
from argparse import Namespace
from collections import Counter
from collections.abc import Iterable
from typing import Any, NamedTuple

from skinnet.batch._blocks import choose_size, write_plan
from skinnet.batch._cluster import connect, import_ray, read_blocks
from skinnet.batch._columns import FAILED, NO_FACE, READ
from skinnet.batch._job import Job, Model, Reading, read_model
from skinnet.batch._listing import Columns, Listing, list_photographs
from skinnet.batch._output import Output, Record, find_repeated, is_read, open_output
from skinnet.batch._parquet_input import BYTES_COLUMN, NAME_COLUMN
from skinnet.batch._photographs import Photograph
from skinnet.errors import InputError
from skinnet.inference._face_choice import check_choice
from skinnet.inference._messages import note, print_line, report
from skinnet.inference._progress import show_progress

_MOST_FAILURES = 20

_WORDS = {READ: "read", NO_FACE: "without a face", FAILED: "could not be read"}

Records = dict[str, list[Record]]


class Pace(NamedTuple):
    """How fast photographs were read.

    Attributes:
        photographs: How many.
        seconds: In which time, the start of the workers included.
        cores: By how many cores.
    """

    photographs: int = 0
    seconds: float = 0.0
    cores: int = 0

    @property
    def rate(self) -> float:
        """Photographs a second and core."""
        return self.photographs / self.seconds / self.cores if self.photographs else 0.0


def run(options: Namespace) -> bool:
    """Read the photographs of an input that are not in the output yet.

    Returns:
        Whether all photographs of the input are read.

    Raises:
        InputError: The input, the output, the model or the cluster cannot be used.
    """
    import_ray()
    reading = Reading(options.faces, options.region, options.detail, options.maps)
    check_choice(reading.faces)
    model = read_model(options.model)
    columns = Columns(options.path_column, options.bytes_column, options.name_column)
    listing = list_photographs(options.input, columns, options.recursive)
    for sentence in listing.notes:
        note(sentence)
    output = open_output(options.output, reading.to_settings(model))
    wanted = {each.key: each for each in listing.photographs}
    left, stale = find_left(wanted, output.read_records(), options.retry_failed)
    note(_describe_start(len(wanted), len(left)))
    pace = Pace()
    if left:
        job = _make_job(output, listing, columns, model, reading)
        pace = _read_all(job, output, left, stale, options)
    return _conclude(output, wanted, pace, options.json)


def find_left(
    wanted: dict[str, Photograph], records: Records, retry: bool
) -> tuple[list[Photograph], dict[str, set[str]]]:
    """Find which photographs are to be read, and which rows they replace.

    Args:
        wanted: The photographs of the input, by key.
        records: What the output holds.
        retry: Whether those that were not read are read again.

    Returns:
        The photographs, and keys to drop from parts: of earlier states of a changed file, of what
        is read again, and of what lies in two parts.
    """
    stale = find_repeated(records)
    places = {(each.source, each.row): key for key, each in wanted.items()}
    again = set()
    for key, found in records.items():
        changed = places.get(found[0].place, key) != key
        failed = retry and key in wanted and not is_read(found[0])
        again |= {key} if failed else set()
        for record in found if changed or failed else ():
            stale.setdefault(record.part, set()).add(key)
    left = [each for key, each in wanted.items() if key not in records or key in again]
    return sorted(left, key=lambda each: (each.source, each.row)), stale


def _make_job(
    output: Output, listing: Listing, columns: Columns, model: Model, reading: Reading
) -> Job:
    return Job(
        output=output.folder.url + output.folder.query,
        token=output.token,
        query=listing.place.query,
        bytes_column=columns.bytes or BYTES_COLUMN,
        name_column=columns.name or NAME_COLUMN,
        model=model,
        reading=reading,
    )


def _read_all(
    job: Job,
    output: Output,
    left: list[Photograph],
    stale: dict[str, set[str]],
    options: Namespace,
) -> Pace:
    with connect(options.address) as cores:
        used = min(cores, options.workers or cores)
        size = options.block or choose_size(len(left), used, job.reading.maps)
        output.begin()
        output.drop(stale)
        counts = write_plan(output.plan, left, size)
        start = time.perf_counter()
        with show_progress(len(left)) as advance:
            for number, fault in read_blocks(job, len(counts), options.workers, cores):
                if fault:
                    raise InputError(fault)
                for _ in range(counts[number]):
                    advance(0)
        return Pace(len(left), time.perf_counter() - start, min(used, len(counts)))


def _conclude(output: Output, wanted: dict[str, Photograph], pace: Pace, as_json: bool) -> bool:
    """Check that each photograph is there once, and say what became of them."""
    records = output.read_records()
    if repeated := find_repeated(records):  # another run wrote while this one began
        output.drop(repeated)
        records = output.read_records()
    missing = [each.file for key, each in wanted.items() if key not in records]
    if missing:
        raise InputError(
            f"{len(missing)} photographs are not in {output.folder.url}, such as {missing[0]}; the "
            "same command reads them."
        )
    output.end()
    found = [records[key][0] for key in wanted]
    failures = [each for each in found if not is_read(each)]
    _report_failures(failures)
    counts = Counter(each.status for each in found)
    rows = sum(each.rows for each in found)
    if as_json:
        print_line(json.dumps(_count(counts, rows, pace)))
    else:
        print_line(f"{output.folder.url}: {_describe_end(counts, rows, pace)}")
    return not failures


def _report_failures(failures: list[Record]) -> None:
    for each in failures[:_MOST_FAILURES]:
        report(InputError(each.reason))
    more = len(failures) - _MOST_FAILURES
    if more > 0:
        report(InputError(f"{more} more were not read: the rows whose status is not {READ}."))


def _count(counts: Counter[str], rows: int, pace: Pace) -> dict[str, Any]:
    return {
        "photographs": counts.total(),
        **{status: counts[status] for status in _WORDS},
        "rows": rows,
        "read_now": pace.photographs,
        "seconds": round(pace.seconds, 2),
        "cores": pace.cores,
        "photographs_per_second_and_core": round(pace.rate, 4),
    }


def _describe_start(wanted: int, left: int) -> str:
    done = f"; {wanted - left} are in the output already" if left < wanted else ""
    return f"{wanted:,} photographs{done}."


def _describe_end(counts: Counter[str], rows: int, pace: Pace) -> str:
    parts: Iterable[str] = (f"{counts[status]:,} {words}" for status, words in _WORDS.items())
    speed = f"; {pace.rate:.2g} photographs a second and core" if pace.photographs else ""
    return f"{', '.join(parts)}, {rows:,} rows{speed}."
