"""The verb `predict`, with options that are parsed, and what other verbs share with it."""

import argparse
import hashlib
import json
import sys
from collections.abc import Sequence
from io import BytesIO
from pathlib import Path
from typing import Any

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
from skinnet.inference._messages import describe, note, print_line, report
from skinnet.inference._own_results import Source, choose_result_stem
from skinnet.inference._report.html_report import NAME, FaceReport
from skinnet.inference._told_capture import ToldCapture
from skinnet.inference._usual_values import describe_reading
from skinnet.inference.decomposer import Decomposer
from skinnet.inference.decomposition import Decomposition
from skinnet.inference.results import (
    _describe_map_files,
    _list_all_ends,
    _make_folder,
    _name_part,
    _Result,
    _write_all,
)


def predict(options: argparse.Namespace) -> bool:
    """Decompose every input; report bad inputs and continue. Returns whether none was bad."""
    check_choice(options.faces)
    decomposer = _make_decomposer(options)
    decomposer.load()
    found = walk(options.input, options.recursive)
    told = ToldCapture.from_options(options, decomposer, len(found.pictures))
    table, page = FaceTable(options.csv), FaceReport(_choose_report(options, found))
    totals = run_over(
        found,
        lambda picture: _predict_one(decomposer, picture, options, told, table, page),
        lambda name, error: _report_failure(table, page, name, error),
        quiet=options.json,
    )
    for sentence in (*found.notes, *table.notes):
        note(sentence)
    total = describe_totals(totals, found, "read", _describe_place(found, options.output))
    page.finish(total)
    if not is_one_file(found, options.input):
        note(total if page.path is None else f"{total} The report is {page.path}.")
    return not totals.failures


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
    """Make the decomposer that is asked for, and begin to open what finds faces."""
    if options.region == "face":
        open_ahead()
    return Decomposer(options.model, providers=options.provider)


def _predict_one(
    decomposer: Decomposer,
    found: Found,
    options: argparse.Namespace,
    told: ToldCapture,
    table: FaceTable,
    page: FaceReport,
) -> int:
    """Decompose a picture, and write its results. Returns the number of faces in them."""
    source, picture, notes = _read(found)
    known, told_notes = told.tell(picture)
    decompositions = decomposer(
        picture,
        name=source.name,
        detail=options.detail,
        faces=options.faces,
        region=options.region,
        capture=known,
    )
    try:
        results, folder = _write(source, picture, decompositions, (*notes, *told_notes), options)
        table.add(result.summary for result in results)
        page.add(picture.srgb, results, folder)
    except InputError as error:
        raise NotWrittenError(str(error)) from error
    return sum(each.face_id is not None for each in decompositions)


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
    folder = _make_folder(options.output or source.folder / OUTPUT)
    with lock_folder(folder):
        stem = choose_result_stem(
            folder, source, _list_all_ends(decompositions, options.colour_maps)
        )
        if stem != source.stem:
            others = f"{folder} holds other files of the name {source.stem}"
            notes = (*notes, f"{others}; the results of {source.name} are numbered: {stem}.")
        results = []
        for each in decompositions:
            summary = {"file": source.name, "input": source.describe(folder)} | each.to_dict()
            summary["notes"] = [*notes, *summary["notes"]]
            summary["map_files"] = _describe_map_files(options.colour_maps)
            results.append(_Result(stem + _name_part(each, len(decompositions)), each, summary))
        count = _write_all(folder, results, picture.srgb, source.digest, options.colour_maps)
    for sentence in dict.fromkeys(each for _, _, summary in results for each in summary["notes"]):
        note(sentence)
    for result in results:
        _print(source, folder, result, count, options.json)
    return results, folder


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
