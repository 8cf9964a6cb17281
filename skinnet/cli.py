"""The `skinnet` command; each verb imports what is slow to import only when it runs."""

import argparse
import hashlib
import json
import os
import sys
from collections import Counter
from collections.abc import Sequence
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

from skinnet._version import __version__
from skinnet.errors import InputError

if TYPE_CHECKING:
    from skinnet.images._walk import Found, Walk
    from skinnet.images.picture import Picture
    from skinnet.inference._own_results import Source
    from skinnet.inference.decomposer import Decomposer
    from skinnet.inference.decomposition import Decomposition

PIPELINE = {
    "fit-shape": "fit a shape model to scans",
    "maps": "make melanin and hemoglobin maps from scans: fit, warp, calibrate, invert",
    "build-model": "build a hybrid, a linear and a joint model from the maps of many people",
    "sample": "sample random faces from a model",
    "edit-maps": "scale, add to or paint on maps, and render the face again",
}
"""Verbs of the classic pipeline, which take their settings from YAML (`skinnet.pipeline`)."""

_STDIN = "-"
_READ, _FACELESS, _WRITTEN_NOT, _READ_NOT = (
    "read",
    "without a face",
    "could not be written",
    "could not be read",
)
"""What becomes of an input, as the count at the end of a run says it."""

_OK, _BROKEN_PIPE, _BAD_INPUT, _INTERRUPTED = 0, 1, 2, 130
"""Exit codes; the second is for an output pipe whose reader has closed it."""


def main(argv: Sequence[str] | None = None) -> int:
    """Run one verb of the command.

    Args:
        argv: The arguments; those of the process by default.

    Returns:
        The exit code: 0, 1 for a closed output pipe, 2 for bad input, or 130 after Ctrl-C.

    Example:
        >>> main(["predict", "absent.jpg"])  # prints to standard error
        2
    """
    parser = argparse.ArgumentParser(
        prog="skinnet", description="Melanin and hemoglobin maps of a photograph of skin."
    )
    parser.add_argument("--version", action="version", version=f"skinnet {__version__}")
    verbs = parser.add_subparsers(title="verbs", required=True, metavar="VERB")
    _add_predict(verbs)
    _add_edit(verbs)
    for verb, help_ in PIPELINE.items():
        verbs.add_parser(verb, help=help_, add_help=False)
    arguments = list(sys.argv[1:] if argv is None else argv)
    try:
        if arguments and arguments[0] in PIPELINE:
            return _run_pipeline(arguments[0], arguments[1:])
        options = parser.parse_args(arguments)
        code: int = options.run(options)
    except BrokenPipeError:
        # The reader has closed the pipe. Python would report that when it flushes at exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return _BROKEN_PIPE
    except (InputError, OSError) as error:
        return _report(error)
    except KeyboardInterrupt:
        return _INTERRUPTED
    return code


def _run_pipeline(verb: str, arguments: list[str]) -> int:
    try:
        from skinnet.pipeline.command import run_verb

        return run_verb(verb, arguments, PIPELINE[verb])
    except ModuleNotFoundError as error:
        if (error.name or "").partition(".")[0] == "skinnet":
            raise
        raise InputError(
            f'skinnet {verb} needs the scans extra: pip install "skinnet[scans]"'
        ) from error


def _add_predict(verbs: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    verb = verbs.add_parser("predict", help="make maps, a panel and a summary of photographs")
    verb.add_argument(
        "input",
        nargs="+",
        help="photographs, folders of them, patterns such as '*.jpg', or - for standard input",
    )
    verb.add_argument(
        "-r", "--recursive", action="store_true", help="search the subfolders of folders too"
    )
    verb.add_argument(
        "-o",
        "--output",
        type=Path,
        metavar="DIR",
        help="folder to write to; by default skinmaps in the photograph's folder",
    )
    verb.add_argument(
        "--json", action="store_true", help="print each summary as one line of JSON, nothing else"
    )
    verb.add_argument(
        "--no-detail",
        dest="detail",
        action="store_false",
        help="do not add the photograph's detail to the network's maps; faster",
    )
    _add_common(verb)
    verb.set_defaults(run=_predict)


def _add_edit(verbs: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    verb = verbs.add_parser("edit", help="multiply the pigments of a photograph")
    verb.add_argument("input", help="a photograph, or - for standard input")
    verb.add_argument(
        "-o",
        "--output",
        type=Path,
        metavar="FILE",
        help="its suffix chooses the format; by default INPUT_edited in the format of the input, "
        "with a number if that is another file. JPEG changes every pixel a little",
    )
    for pigment in ("melanin", "hemoglobin"):
        verb.add_argument(
            f"--{pigment}",
            type=float,
            default=1.0,
            metavar="X",
            help=f"factor of {pigment}, from 0 to 10; 1 by default",
        )
    _add_common(verb)
    verb.set_defaults(run=_edit)


def _add_common(verb: argparse.ArgumentParser) -> None:
    verb.add_argument(
        "--model",
        type=Path,
        metavar="FILE",
        help="encoder, X.onnx, with X.decoder.onnx in the same folder; by default the shipped one",
    )
    verb.add_argument(
        "--whole-image",
        action="store_true",
        help="take the whole image, without a search for a face",
    )


def _predict(options: argparse.Namespace) -> int:
    """Decompose every input; report bad inputs and continue. The exit code is 2 if any was bad."""
    from skinnet.images._walk import walk
    from skinnet.inference.decomposer import Decomposer

    decomposer = Decomposer(options.model)
    decomposer.load()
    found = walk(options.input, options.recursive)
    counts: Counter[str] = Counter()
    for picture in found.pictures:
        try:
            counts[_predict_one(decomposer, picture, options)] += 1
        except InputError as error:
            counts[_READ_NOT] += 1
            _report(error)
    for note in found.notes:
        _note(note)
    single = len(found.pictures) == 1 and found.pictures[0].path == options.input[0]
    if not single or found.passed_over or len(options.input) > 1:
        _note(_describe_run(counts, found))
    return _OK if counts.total() == counts[_READ] else _BAD_INPUT


def _predict_one(decomposer: "Decomposer", found: "Found", options: argparse.Namespace) -> str:
    """Decompose a picture, and write its results. Returns under what it is counted."""
    from skinnet.errors import NoFaceError

    if found.error is not None:
        raise found.error
    source, picture, notes = _read(found)
    try:
        decomposition = decomposer(picture, options.whole_image, source.name, options.detail)
    except NoFaceError as error:
        _report(error)
        return _FACELESS
    try:
        _write(source, picture, decomposition, notes, options)
    except InputError as error:
        _report(error)
        return _WRITTEN_NOT
    return _READ


def _write(
    source: "Source",
    picture: "Picture",
    decomposition: "Decomposition",
    notes: Sequence[str],
    options: argparse.Namespace,
) -> None:
    """Write the results of a photograph under a name that is free or its own, and print them."""
    from skinnet.images._result_names import lock_folder
    from skinnet.inference._own_results import OUTPUT, choose_result_stem
    from skinnet.inference.results import _list_ends, _make_folder, write_results

    folder = _make_folder(options.output or source.folder / OUTPUT)
    with lock_folder(folder):
        stem = choose_result_stem(folder, source, _list_ends(decomposition))
        if stem != source.stem:
            others = f"{folder} holds other files of the name {source.stem}"
            notes = (*notes, f"{others}; the results of {source.name} are numbered: {stem}.")
        summary = {"file": source.name, "input": source.describe(folder)} | decomposition.summary()
        summary["notes"] = [*notes, *summary["notes"]]
        count = write_results(folder, stem, picture.srgb, decomposition, summary, source.digest)
    for note in summary["notes"]:
        _note(note)
    if options.json:
        _print(json.dumps(summary, allow_nan=False))
        return
    written = f"{count} files: {folder / stem}_*.png and {folder / stem}.json"
    _print(f"{source.name}: {_describe_skin(summary)}; {written}")


def _describe_skin(summary: dict[str, Any]) -> str:
    means = {pigment: summary["maps"][pigment]["mean"] for pigment in ("melanin", "hemoglobin")}
    if means["melanin"] is None:
        return "no skin was found"
    numbers = ", ".join(f"{pigment} {mean:.3g}" for pigment, mean in means.items())
    return f"{numbers} on skin, {summary['skin_share']:.0%} of the crop"


def _describe_run(counts: Counter[str], found: "Walk") -> str:
    """How many pictures were read, passed over and not read, and the reasons."""
    parts = [f"{counts[_READ]} {_READ}", f"{len(found.passed_over)} passed over"]
    parts += [f"{counts[each]} {each}" for each in (_FACELESS, _WRITTEN_NOT) if counts[each]]
    reasons = found.describe_passed_over()
    passed_over = f" Passed over: {reasons}." if reasons else ""
    return f"{', '.join(parts)}, {counts[_READ_NOT]} {_READ_NOT}.{passed_over}"


def _edit(options: argparse.Namespace) -> int:
    """Write one photograph with its pigments multiplied."""
    from skinnet.images._mark import EDITED, Mark
    from skinnet.images._walk import find_one
    from skinnet.images._write import choose_suffix, find_format, write_picture
    from skinnet.inference._own_results import choose_edit_target
    from skinnet.inference.decomposer import Decomposer

    if options.output is not None:
        find_format(options.output)
    decomposer = Decomposer(options.model)
    source, picture, notes = _read(find_one(options.input))
    suffix, changes = choose_suffix(picture, "" if source.path is None else source.path.suffix)
    target = choose_edit_target(source, options.output, suffix)
    edited = decomposer.edit_picture(
        picture, options.melanin, options.hemoglobin, options.whole_image, source.name
    )
    losses = write_picture(target, edited, Mark("edit", EDITED, source.digest))
    changes = () if options.output else changes
    for note in (*notes, *edited.notes, *changes, *losses):
        _note(note)
    _print(f"{source.name}: {target}")
    return _OK


def _read(found: "Found") -> tuple["Source", "Picture", tuple[str, ...]]:
    """Read a picture, with the record of its file and the notes on it."""
    from skinnet.images._mark import read_mark
    from skinnet.images._result_names import compute_digest
    from skinnet.images._walk import check_mark
    from skinnet.images.photograph import read_picture
    from skinnet.inference._own_results import Source

    if found.path != _STDIN:
        path = Path(found.path)
        picture = read_picture(path, found.path)
        return Source(found.path, path, compute_digest(path)), picture, found.notes
    name, data = "standard input", b"" if sys.stdin is None else sys.stdin.buffer.read()
    notes = check_mark(read_mark(BytesIO(data)), name)
    picture = read_picture(BytesIO(data), name)
    return Source(name, None, hashlib.sha256(data).hexdigest()), picture, notes


def _print(text: str) -> None:
    print(_escape(text, sys.stdout.encoding), flush=True)


def _note(sentence: str) -> None:
    print(_escape(f"skinnet: {sentence}", sys.stderr.encoding), file=sys.stderr, flush=True)


def _escape(text: str, encoding: str | None) -> str:
    """Replace characters that an encoding does not have by escapes."""
    encoding = encoding or "utf-8"
    return text.encode(encoding, "backslashreplace").decode(encoding)


def _report(error: Exception) -> int:
    sentence = str(error)
    if isinstance(error, OSError):
        sentence = (
            f"{error.filename or 'A file'} cannot be used ({error.strerror}); check the path."
        )
    _note(sentence)
    return _BAD_INPUT
