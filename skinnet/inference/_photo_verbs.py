"""The verb `predict`, with options that are parsed, and what other verbs share with it."""

import argparse
import hashlib
import json
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import Any, NamedTuple

from skinnet.errors import InputError
from skinnet.files._reading import read_stream
from skinnet.images._mark import read_mark
from skinnet.images._result_names import OUTPUT, compute_digest, lock_folder
from skinnet.images._walk import STDIN, Found, Walk, check_mark, walk
from skinnet.images.faces._face_models import open_ahead
from skinnet.images.photograph import read_picture
from skinnet.images.picture import Picture
from skinnet.inference._face_choice import check_choice
from skinnet.inference._face_rows import FaceTable
from skinnet.inference._input_run import (
    NotWrittenError,
    describe_totals,
    is_one_file,
    name_input,
    run_over,
)
from skinnet.inference._messages import describe, explain, note, print_line, report
from skinnet.inference._own_results import Source, choose_result_stem
from skinnet.inference._report.html_report import NAME, FaceReport, make_rows
from skinnet.inference._told_capture import ToldCapture
from skinnet.inference._usual_values import describe_reading
from skinnet.inference._workers.turns import wait_turn
from skinnet.inference._workers.worker_count import choose_count, count_cores
from skinnet.inference.decomposer import Decomposer
from skinnet.inference.decomposition import Decomposition
from skinnet.inference.results import (
    _describe_map_files,
    _list_all_ends,
    _list_ends,
    _make_folder,
    _name_files,
    _name_part,
    _Result,
    _write_pictures,
)


class _Done(NamedTuple):
    """What is known of a photograph that was decomposed: for the totals, the table and the page."""

    faces: int
    summaries: list[dict[str, Any]]
    rows: list[str]


@dataclass(frozen=True)
class _PredictRun:
    """What all photographs of a run share; a worker process has a copy of it."""

    decomposer: Decomposer
    options: argparse.Namespace
    told: ToldCapture
    page: Path | None

    def load(self) -> None:
        """Open the networks."""
        _open_networks(self.decomposer, self.options)

    def __call__(self, found: Found) -> _Done:
        """Decompose a picture, write its results, and print them."""
        source, picture, notes = _read(found)
        known, told_notes = self.told.tell(picture)
        decompositions = self.decomposer(
            picture,
            name=source.name,
            detail=self.options.detail,
            faces=self.options.faces,
            region=self.options.region,
            capture=known,
        )
        try:
            every = (*notes, *told_notes)
            results, folder = _write(source, picture, decompositions, every, self.options)
        except InputError as error:
            raise NotWrittenError(str(error)) from error
        rows = [] if self.page is None else make_rows(picture.srgb, results, folder, self.page)
        faces = sum(each.face_id is not None for each in decompositions)
        return _Done(faces, [] if self.options.csv is None else [*_list(results)], rows)


def predict(options: argparse.Namespace) -> bool:
    """Decompose every input; report bad inputs and continue. Returns whether none was bad."""
    check_choice(options.faces)
    found = walk(options.input, options.recursive)
    workers, decomposer = _prepare(options, found)
    told = ToldCapture.from_options(options, decomposer, len(found.pictures))
    table, page = FaceTable(options.csv), FaceReport(_choose_report(options, found))
    with page.finish_at_interrupt():
        totals = run_over(
            found,
            _PredictRun(decomposer, options, told, page.path),
            lambda name, error: _report_failure(table, page, name, error),
            quiet=options.json,
            take=lambda done: _take(done, table, page),
            workers=workers,
            one_folder=options.output is not None,
        )
    for sentence in (*found.notes, *table.notes):
        note(sentence)
    total = describe_totals(totals, found, "read", _describe_place(found, options.output))
    page.finish(total)
    if not is_one_file(found, options.input):
        note(total if page.path is None else f"{total} The report is {page.path}.")
    return not totals.failures


def _take(done: _Done, table: FaceTable, page: FaceReport) -> int:
    """Add a photograph to the table and the page. Returns the number of its faces."""
    try:
        table.add(done.summaries)
        page.add_rows(done.rows)
    except InputError as error:
        raise NotWrittenError(str(error)) from error
    return done.faces


def _choose_report(options: argparse.Namespace, found: Walk) -> Path | None:
    """The page that is asked for; without a name it lies in the folder of the first maps."""
    report: Path | None = options.report
    if report is None or report.name:
        return report
    first = next((Path(each.path).parent for each in found.pictures), Path())
    folder: Path = options.output or first / OUTPUT
    return folder / NAME


def _describe_place(found: Walk, output: Path | None) -> str:
    """Where maps are written."""
    folders = {Path(each.path).parent / OUTPUT for each in found.pictures if each.path != STDIN}
    if output is None and len(folders) > 1:
        return f"maps in {OUTPUT} beside the photographs"
    return f"maps in {output or (folders or {Path(OUTPUT)}).pop()}"


def _make_decomposer(options: argparse.Namespace) -> Decomposer:
    """Make the decomposer that is asked for, and open its networks."""
    decomposer = Decomposer(options.model, providers=options.provider)
    _open_networks(decomposer, options)
    return decomposer


def _open_networks(decomposer: Decomposer, options: argparse.Namespace) -> None:
    if options.region == "face":
        open_ahead()
    decomposer.load()


def _prepare(options: argparse.Namespace, found: Walk) -> tuple[int, Decomposer]:
    """Choose the number of workers, and make the decomposer that each of them has.

    Raises:
        InputError: A number or a model is wrong.
    """
    workers = choose_count(options.workers, found.pictures, options.provider)
    if workers == 1:
        return 1, _make_decomposer(options)
    threads = max(1, count_cores() // workers)
    decomposer = Decomposer(options.model, threads=threads, providers=options.provider)
    decomposer.load()  # what is wrong is said once, before a worker starts
    explain(f"{workers} processes read the photographs.")
    return workers, decomposer


def _report_failure(table: FaceTable, page: FaceReport, name: str, error: Exception) -> None:
    """Print why a file was not read, and add it to the table and the page."""
    report(error)
    page.add_failure(name, describe(error))
    try:
        table.add_failure(name, describe(error))
    except InputError as fault:
        report(fault)


def _write(
    source: Source,
    picture: Picture,
    decompositions: Sequence[Decomposition],
    notes: Sequence[str],
    options: argparse.Namespace,
) -> tuple[list[_Result], Path]:
    """Write the results of a photograph under names that are free or its own, and print them.

    Returns:
        What was written, and where.
    """
    folder, maps = _make_folder(options.output or source.folder / OUTPUT), options.colour_maps
    with (
        _write_pictures(folder, decompositions, picture.srgb, source.digest, maps) as pictures,
        _keep_names(folder),
    ):
        stem = choose_result_stem(folder, source, _list_all_ends(decompositions, maps))
        if stem != source.stem:
            others = f"{folder} holds other files of the name {source.stem}"
            notes = (*notes, f"{others}; the results of {source.name} are numbered: {stem}.")
        results = []
        for each in decompositions:
            summary = {"file": source.name, "input": source.describe(folder)} | each.to_dict()
            summary["notes"] = [*notes, *summary["notes"]]
            summary["map_files"] = _describe_map_files(maps)
            results.append(_Result(stem + _name_part(each, len(decompositions)), each, summary))
        _name_files(folder, results, pictures)
    for sentence in dict.fromkeys(each for summary in _list(results) for each in summary["notes"]):
        note(sentence)
    for result in results:
        _print(source, folder, result, len(_list_ends(maps)), options.json)
    return results, folder


@contextmanager
def _keep_names(folder: Path) -> Iterator[None]:
    """Keep all other photographs from choosing names in a folder; earlier ones have theirs."""
    wait_turn()
    with lock_folder(folder):
        yield


def _list(results: Sequence[_Result]) -> Iterator[dict[str, Any]]:
    return (result.summary for result in results)


def _print(source: Source, folder: Path, result: _Result, count: int, as_json: bool) -> None:
    stem, decomposition, summary = result
    if as_json:
        print_line(json.dumps(summary, allow_nan=False))
        return
    written = f"{count} files: {folder / stem}_*.png and {folder / stem}.json"
    several = (decomposition.faces_found or 0) > 1
    face = f", face {decomposition.face_id}" if several else ""
    print_line(f"{source.name}{face}: {_describe_skin(summary)}; {written}")


def _describe_skin(summary: dict[str, Any]) -> str:
    pigments, optics = summary["pigments"], summary["model"].get("optics")
    if pigments["melanin"]["mean"] is None:
        return "no skin was found"
    numbers = ", ".join(
        describe_reading(name, each["mean"], each["interval"], optics)
        for name, each in pigments.items()
    )
    return f"{numbers} on skin, {100 * summary['skin_share']:.2g} % of the crop"


def _read(found: Found) -> tuple[Source, Picture, tuple[str, ...]]:
    """Read a picture, with the record of its file and the notes on it."""
    if found.path != STDIN:
        path = Path(found.path)
        picture = read_picture(path, found.path)
        return Source(found.path, path, compute_digest(path)), picture, found.notes
    name = name_input(found)
    data = b"" if sys.stdin is None else read_stream(sys.stdin.buffer, name)
    notes = check_mark(read_mark(BytesIO(data)), name)
    picture = read_picture(BytesIO(data), name)
    return Source(name, None, hashlib.sha256(data).hexdigest()), picture, notes
