"""The `skinnet` command. What is heavy to import is imported by the verb that needs it."""

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
    "maps": "scans to maps of melanin and hemoglobin: fit, warp, calibrate, invert",
    "build-model": "maps of many people to a hybrid, a linear and a joint model",
    "sample": "random faces from a model",
    "edit-maps": "scale, add to or paint on maps, and render the face again",
}
"""Verbs of the classic pipeline, which take their settings from YAML (`skinnet.pipeline`)."""

OK, UNREAD, BAD_INPUT, INTERRUPTED = 0, 1, 2, 130
STDIN = "-"


def main(argv: Sequence[str] | None = None) -> int:
    """Run one verb; the exit code is 0, 2 for bad input, or 130 after Ctrl-C."""
    parser = argparse.ArgumentParser(
        prog="skinnet", description="Reads a photograph as skin: melanin and hemoglobin."
    )
    parser.add_argument("--version", action="version", version=f"skinnet {__version__}")
    verbs = parser.add_subparsers(title="verbs", required=True, metavar="VERB")
    for add in (_add_predict, _add_edit):
        add(verbs)
    for verb, help_ in PIPELINE.items():
        verbs.add_parser(verb, help=help_, add_help=False)
    given = list(sys.argv[1:] if argv is None else argv)
    try:
        if given and given[0] in PIPELINE:
            return _pipeline(given[0], given[1:])
        options = parser.parse_args(given)
        code: int = options.run(options)
    except BrokenPipeError:
        # Nobody reads on; Python would complain when it flushes at its end.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return UNREAD
    except (InputError, OSError) as error:
        return _report(error)
    except KeyboardInterrupt:
        return INTERRUPTED
    return code


def _pipeline(verb: str, arguments: list[str]) -> int:
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
    verb = verbs.add_parser("predict", help="photographs to maps, a panel and numbers")
    verb.add_argument(
        "input", nargs="+", help="photographs, a folder of them, or - for standard input"
    )
    verb.add_argument(
        "-o", "--output", type=Path, metavar="DIR", help="default: skinmaps beside the photograph"
    )
    verb.add_argument("--json", action="store_true", help="print the numbers, one object a line")
    verb.add_argument(
        "--no-detail",
        dest="detail",
        action="store_false",
        help="leave the maps as soft as the network sees; faster",
    )
    _add_common(verb)
    verb.set_defaults(run=predict)


def _add_edit(verbs: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    verb = verbs.add_parser("edit", help="multiply the pigments of a photograph")
    verb.add_argument("input", help="a photograph, or - for standard input")
    verb.add_argument(
        "-o",
        "--output",
        type=Path,
        metavar="FILE",
        help=".png or .jpg; default: INPUT_edited.png. JPEG changes every pixel a little",
    )
    for pigment in ("melanin", "hemoglobin"):
        verb.add_argument(f"--{pigment}", type=float, default=1.0, metavar="X", help="factor, 0-10")
    _add_common(verb)
    verb.set_defaults(run=edit)


def _add_common(verb: argparse.ArgumentParser) -> None:
    verb.add_argument(
        "--model", type=Path, metavar="FILE", help="encoder, X.onnx, with X.decoder.onnx beside it"
    )
    verb.add_argument("--whole-image", action="store_true", help="do not look for a face")


def predict(options: argparse.Namespace) -> int:
    """Decompose every input; report the bad ones and go on. 2 if any was bad."""
    from skinnet.inference.decomposer import Decomposer

    decomposer = Decomposer(options.model)
    decomposer.load()
    code = OK
    taken: set[tuple[Path, str]] = set()
    for source in _photographs(options.input):
        try:
            if isinstance(source, InputError):
                raise source
            folder, stem = _place(source, options.output, taken)
            _predict_one(decomposer, source, folder, stem, options)
        except InputError as error:
            code = _report(error)
    return code


def _predict_one(
    decomposer: "Decomposer", source: str, folder: Path, stem: str, options: argparse.Namespace
) -> None:
    from skinnet.images.photograph import read_photo
    from skinnet.inference.results import write_results

    photo = read_photo(_readable(source), _name(source))
    decomposition = decomposer(photo, options.whole_image, _name(source), options.detail)
    summary = {"file": _name(source)} | decomposition.summary()
    count = write_results(folder, stem, photo, decomposition, summary)
    if options.json:
        _say(json.dumps(summary, allow_nan=False))
        return
    written = f"{count} files: {folder / stem}_*.png and {folder / stem}.json"
    mean = {name: summary["maps"][name]["mean"] for name in ("melanin", "hemoglobin")}
    if mean["melanin"] is None:
        _say(f"{_name(source)}: no skin was found; {written}")
        return
    numbers = ", ".join(f"{name} {value:.3g}" for name, value in mean.items())
    _say(
        f"{_name(source)}: {numbers} over {summary['skin_share']:.0%} of the head's crop; {written}"
    )


def edit(options: argparse.Namespace) -> int:
    """Write one photograph with its pigments multiplied."""
    from skinnet.images.photograph import read_photo
    from skinnet.inference.decomposer import Decomposer
    from skinnet.inference.results import _check_suffix, _write_picture

    source: str = options.input
    target: Path = options.output or _beside(source).parent / f"{_stem(source)}_edited.png"
    _check_suffix(target)
    if source != STDIN and target.exists() and Path(source).exists() and target.samefile(source):
        raise InputError(f"{target} is the photograph itself; choose another file with -o.")
    decomposer = Decomposer(options.model)
    photo = read_photo(_readable(source), _name(source))
    edited = decomposer.edit(
        photo, options.melanin, options.hemoglobin, options.whole_image, _name(source)
    )
    _write_picture(target, edited)
    _say(f"{_name(source)}: {target}")
    return OK


def _photographs(inputs: Sequence[str]) -> Iterator[str | InputError]:
    """Each photograph, a folder's in the order of their names, and an error for a bad folder."""
    for source in inputs:
        if not source:
            yield InputError("An empty name was given; name a photograph, a folder, or - .")
            continue
        try:
            if source != STDIN and Path(source).is_dir():
                yield from _inside(Path(source))
            else:
                yield source
        except OSError as error:
            yield InputError(f"{source} cannot be read ({error.strerror}); check the path.")


def _inside(folder: Path) -> list[str | InputError]:
    from skinnet.images._decode import PHOTO_SUFFIXES

    shown = (file for file in sorted(folder.iterdir()) if not file.name.startswith("."))
    found = [
        str(file) for file in shown if file.suffix.lower() in PHOTO_SUFFIXES and file.is_file()
    ]
    suffixes = ", ".join(sorted(PHOTO_SUFFIXES))
    return [*found] or [
        InputError(f"The folder {folder} holds no photographs; they end in {suffixes}.")
    ]


def _place(source: str, output: Path | None, taken: set[tuple[Path, str]]) -> tuple[Path, str]:
    """Folder and stem of a photograph's files, the stem counted on if this run has used it."""
    folder = output or _beside(source).parent / "skinmaps"
    stem = _stem(source)
    number = 1
    while (folder, stem.casefold()) in taken:
        number += 1
        stem = f"{_stem(source)}-{number}"
    taken.add((folder, stem.casefold()))
    return folder, stem


def _beside(source: str) -> Path:
    return Path("stdin" if source == STDIN else source)


def _stem(source: str) -> str:
    return _beside(source).stem


def _name(source: str) -> str:
    return "standard input" if source == STDIN else source


def _readable(source: str) -> str | BinaryIO | BufferedIOBase:
    return sys.stdin.buffer if source == STDIN else source


def _say(text: str) -> None:
    """Print a line; characters that the terminal or the pipe cannot take are written as escapes."""
    encoding = sys.stdout.encoding or "utf-8"
    print(text.encode(encoding, "backslashreplace").decode(encoding), flush=True)


def _report(error: Exception) -> int:
    sentence = str(error)
    if isinstance(error, OSError):
        sentence = (
            f"{error.filename or 'A file'} cannot be used ({error.strerror}); check the path."
        )
    print(f"skinnet: {sentence}", file=sys.stderr)
    return BAD_INPUT
