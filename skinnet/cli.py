"""The `skinnet` command; each verb imports what is slow to import only when it runs."""

import argparse
import json
import os
import sys
from collections.abc import Iterator, Sequence
from io import BufferedIOBase
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO

from skinnet._version import __version__
from skinnet.errors import InputError

if TYPE_CHECKING:
    from skinnet.inference.decomposer import Decomposer

PIPELINE = {
    "fit-shape": "fit a shape model to scans",
    "maps": "make melanin and hemoglobin maps from scans: fit, warp, calibrate, invert",
    "build-model": "build a hybrid, a linear and a joint model from the maps of many people",
    "sample": "sample random faces from a model",
    "edit-maps": "scale, add to or paint on maps, and render the face again",
}
"""Verbs of the classic pipeline, which take their settings from YAML (`skinnet.pipeline`)."""

_STDIN = "-"
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
        "input", nargs="+", help="photographs, a folder of them, or - for standard input"
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
        help=".png or .jpg; by default INPUT_edited.png. JPEG changes every pixel a little",
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
    from skinnet.inference.decomposer import Decomposer

    decomposer = Decomposer(options.model)
    decomposer.load()
    code = _OK
    taken: set[tuple[Path, str]] = set()
    for source in _list_photographs(options.input):
        try:
            if isinstance(source, InputError):
                raise source
            folder, stem = _choose_stem(source, options.output, taken)
            _predict_one(decomposer, source, folder, stem, options)
        except InputError as error:
            code = _report(error)
    return code


def _predict_one(
    decomposer: "Decomposer", source: str, folder: Path, stem: str, options: argparse.Namespace
) -> None:
    from skinnet.images.photograph import read_picture
    from skinnet.inference.results import write_results

    name = _name(source)
    picture = read_picture(_open(source), name)
    decomposition = decomposer(picture, options.whole_image, name, options.detail)
    summary = {"file": name} | decomposition.summary()
    count = write_results(folder, stem, picture.srgb, decomposition, summary)
    for note in decomposition.notes:
        print(f"skinnet: {note}", file=sys.stderr)
    if options.json:
        _print(json.dumps(summary, allow_nan=False))
        return
    written = f"{count} files: {folder / stem}_*.png and {folder / stem}.json"
    means = {pigment: summary["maps"][pigment]["mean"] for pigment in ("melanin", "hemoglobin")}
    if means["melanin"] is None:
        _print(f"{name}: no skin was found; {written}")
        return
    numbers = ", ".join(f"{pigment} {mean:.3g}" for pigment, mean in means.items())
    _print(f"{name}: {numbers} on skin, {summary['skin_share']:.0%} of the crop; {written}")


def _edit(options: argparse.Namespace) -> int:
    """Write one photograph with its pigments multiplied."""
    from skinnet.images.photograph import read_photo
    from skinnet.inference.decomposer import Decomposer
    from skinnet.inference.results import _check_suffix, _write_picture

    source: str = options.input
    path = _as_path(source)
    target: Path = options.output or path.parent / f"{path.stem}_edited.png"
    _check_suffix(target)
    if source != _STDIN and target.exists() and path.exists() and target.samefile(path):
        raise InputError(f"{target} is the photograph itself; choose another file with -o.")
    decomposer = Decomposer(options.model)
    name = _name(source)
    photo = read_photo(_open(source), name)
    edited = decomposer.edit(photo, options.melanin, options.hemoglobin, options.whole_image, name)
    _write_picture(target, edited)
    _print(f"{name}: {target}")
    return _OK


def _list_photographs(inputs: Sequence[str]) -> Iterator[str | InputError]:
    """Each photograph, those of a folder in the order of their names; errors for bad folders."""
    for source in inputs:
        if not source:
            yield InputError("An empty name was given; name a photograph, a folder, or - .")
            continue
        try:
            if source != _STDIN and Path(source).is_dir():
                yield from _list_folder(Path(source))
            else:
                yield source
        except OSError as error:
            yield InputError(f"{source} cannot be read ({error.strerror}); check the path.")


def _list_folder(folder: Path) -> list[str | InputError]:
    from skinnet.images._decode import PHOTO_SUFFIXES

    visible = (file for file in sorted(folder.iterdir()) if not file.name.startswith("."))
    photographs = [
        str(file) for file in visible if file.suffix.lower() in PHOTO_SUFFIXES and file.is_file()
    ]
    suffixes = ", ".join(sorted(PHOTO_SUFFIXES))
    return [*photographs] or [
        InputError(f"The folder {folder} holds no photographs; they end in {suffixes}.")
    ]


def _choose_stem(
    source: str, output: Path | None, taken: set[tuple[Path, str]]
) -> tuple[Path, str]:
    """Folder and stem of a photograph's files; a stem that is taken gets a number."""
    path = _as_path(source)
    folder = output or path.parent / "skinmaps"
    stem, number = path.stem, 1
    while (folder, stem.casefold()) in taken:
        number += 1
        stem = f"{path.stem}-{number}"
    taken.add((folder, stem.casefold()))
    return folder, stem


def _as_path(source: str) -> Path:
    return Path("stdin" if source == _STDIN else source)


def _name(source: str) -> str:
    return "standard input" if source == _STDIN else source


def _open(source: str) -> str | BinaryIO | BufferedIOBase:
    return sys.stdin.buffer if source == _STDIN else source


def _print(text: str) -> None:
    """Print a line; characters that the output's encoding does not have become escapes."""
    encoding = sys.stdout.encoding or "utf-8"
    print(text.encode(encoding, "backslashreplace").decode(encoding), flush=True)


def _report(error: Exception) -> int:
    sentence = str(error)
    if isinstance(error, OSError):
        sentence = (
            f"{error.filename or 'A file'} cannot be used ({error.strerror}); check the path."
        )
    print(f"skinnet: {sentence}", file=sys.stderr)
    return _BAD_INPUT
