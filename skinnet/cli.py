"""The `skinnet` command; each verb imports what is slow to import only when it runs."""

import argparse
import os
import sys
from collections.abc import Sequence
from pathlib import Path

from skinnet._version import __version__
from skinnet.errors import InputError
from skinnet.inference._messages import report

PIPELINE = {
    "fit-shape": "fit a shape model to scans",
    "maps": "make melanin and hemoglobin maps from scans: fit, warp, calibrate, invert",
    "build-model": "build a hybrid, a linear and a joint model from the maps of many people",
    "sample": "sample random faces from a model",
    "edit-maps": "scale, add to or paint on maps, and render the face again",
}
"""Verbs of the classic pipeline, which take their settings from YAML (`skinnet.pipeline`)."""

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
    _add_person(verbs)
    _add_compare(verbs)
    _add_capture_verb(verbs)
    _add_web(verbs)
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
        report(error)
        return _BAD_INPUT
    except KeyboardInterrupt:
        return _INTERRUPTED
    return code


def _run_pipeline(verb: str, arguments: list[str]) -> int:
    try:
        from skinnet.pipeline._command import run_verb

        return run_verb(verb, arguments, PIPELINE[verb])
    except ModuleNotFoundError as error:
        if (error.name or "").partition(".")[0] == "skinnet":
            raise
        raise InputError(
            f'skinnet {verb} needs the scans extra: pip install "skinnet[scans]"'
        ) from error


def _add_predict(verbs: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    verb = verbs.add_parser("predict", help="make maps, a panel and a summary of photographs")
    _add_inputs(verb)
    _add_json(verb, "each summary")
    verb.add_argument(
        "--csv",
        type=Path,
        metavar="FILE",
        help="append one row for each face, and one with the reason for each file that is not read",
    )
    verb.add_argument(
        "--no-detail",
        dest="detail",
        action="store_false",
        help="do not add the photograph's detail to the network's maps; faster",
    )
    _add_common(verb)
    verb.set_defaults(run=_predict)


def _add_person(verbs: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    verb = verbs.add_parser(
        "person",
        help="fuse shots of one person by their uncertainty, and check that they agree",
        description="Fuse two shots or more of one person, region by region, into a panel and a "
        "summary. One shot that is plainly unlike the others is left out. The exit code is 2 if "
        "not all shots could be used.",
    )
    _add_inputs(verb)
    _add_json(verb)
    _add_common(verb)
    verb.set_defaults(run=_person)


def _add_inputs(verb: argparse.ArgumentParser) -> None:
    verb.add_argument(
        "input",
        nargs="+",
        help="photographs, folders of them, patterns such as '*.jpg', or - for standard input",
    )
    verb.add_argument(
        "-r", "--recursive", action="store_true", help="search the subfolders of folders too"
    )
    _add_folder(verb, "the photograph's folder")


def _add_edit(verbs: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    verb = verbs.add_parser(
        "edit", help="multiply the pigments of a photograph: --melanin X, --hemoglobin X, or both"
    )
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


def _add_capture_verb(verbs: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    verb = verbs.add_parser(
        "capture",
        help="make a profile of a session from a picture of a colour chart or a white reference",
    )
    verb.add_argument("input", help="a picture of a colour chart, or of something white or grey")
    verb.add_argument(
        "-o",
        "--output",
        type=Path,
        metavar="FILE",
        required=True,
        help="the profile, a .yaml file, for --capture of predict and edit",
    )
    _add_references(verb)
    verb.set_defaults(run=_capture)


def _add_references(verb: argparse.ArgumentParser) -> None:
    """Add what a picture shows of its own light and camera."""
    group = verb.add_argument_group("references in the picture")
    group.add_argument(
        "--white",
        metavar="X,Y[,X1,Y1]",
        help="where something white or grey is, lit as the face: a point, or a box, in pixels from "
        "the upper left corner of the upright picture",
    )
    group.add_argument(
        "--white-colour",
        metavar="COLOUR",
        help="what is there: the share of light that it reflects, such as 0.18 for a grey card, or "
        "its colour in sRGB, such as 230,225,210 or #e6e1d2",
    )
    group.add_argument(
        "--chart",
        metavar="classic|FILE.csv",
        help="a colour chart: classic for the ColorChecker Classic and Passport, or the patches of "
        "another in a CSV file with the columns row, column, and L, a, b or wavelengths; needs the "
        "chart extra",
    )


def _add_compare(verbs: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    verb = verbs.add_parser(
        "compare", help="find how melanin and hemoglobin of a face differ in two photographs"
    )
    verb.add_argument("before", help="a photograph, or - for standard input")
    verb.add_argument("after", help="another one of the same face, from the same side")
    _add_folder(verb, "the folder of the first photograph")
    _add_json(verb)
    _add_model(verb)
    _add_told(verb, "the session of both")
    verb.set_defaults(run=_compare)


def _add_web(verbs: "argparse._SubParsersAction[argparse.ArgumentParser]") -> None:
    verb = verbs.add_parser(
        "web",
        help="open a page that reads and edits photographs in the browser",
        description="Serve a page that reads and edits photographs in the browser, on this "
        "computer alone: no photograph leaves the page. Ctrl-C ends it.",
    )
    verb.add_argument(
        "--port", type=int, default=8765, metavar="N", help="8765 by default; 0 for any free one"
    )
    verb.add_argument(
        "--host",
        default="127.0.0.1",
        metavar="ADDRESS",
        help="127.0.0.1 by default, for this computer alone; 0.0.0.0 opens the page to the "
        "network, which a container needs",
    )
    verb.add_argument(
        "--no-open", dest="open", action="store_false", help="do not open the browser"
    )
    verb.set_defaults(run=_web)


def _add_json(verb: argparse.ArgumentParser, what: str = "the summary") -> None:
    verb.add_argument(
        "--json", action="store_true", help=f"print {what} as one line of JSON, nothing else"
    )


def _add_folder(verb: argparse.ArgumentParser, usual: str) -> None:
    verb.add_argument(
        "-o",
        "--output",
        type=Path,
        metavar="DIR",
        help=f"folder to write to; by default skinmaps in {usual}",
    )


def _add_model(verb: argparse.ArgumentParser) -> None:
    verb.add_argument(
        "--model",
        type=Path,
        metavar="FILE",
        help="encoder, X.onnx, with X.decoder.onnx in the same folder; by default the shipped one",
    )


def _add_common(verb: argparse.ArgumentParser) -> None:
    _add_model(verb)
    verb.add_argument(
        "--faces",
        type=lambda word: int(word) if word.lstrip("-").isdecimal() else word,
        default="largest",
        metavar="all|largest|N",
        help="which faces of a photograph of several people; N are the N largest; by default the "
        "largest one",
    )
    verb.add_argument(
        "--region",
        choices=("face", "skin"),
        default="face",
        help="skin for photographs of skin without a face, such as a forearm; face by default",
    )
    verb.add_argument(
        "--whole-image",
        dest="region",
        action="store_const",
        const="skin",
        help="the same as --region skin",
    )
    _add_told(verb, "the session")


def _add_told(verb: argparse.ArgumentParser, session: str) -> None:
    """Add what may be known of the light and the camera."""
    verb.add_argument(
        "--capture",
        type=Path,
        metavar="FILE.yaml",
        help=f"the profile of {session}, which skinnet capture makes",
    )
    _add_references(verb)
    known = verb.add_argument_group("what is known of the light and the camera")
    known.add_argument(
        "--camera",
        metavar="NAME",
        help="the camera, such as 'Nikon D700', or exif for the one that each photograph's EXIF "
        "names; RAW files name theirs themselves",
    )
    known.add_argument(
        "--light",
        metavar="NAME",
        help="the light: daylight, D65 or D5500K for daylight of a temperature, flash, tungsten (A)"
        ", FL2, FL7 or FL11 (fluorescent), LED-B1, LED-B3, LED-B5 or LED-V1",
    )


def _predict(options: argparse.Namespace) -> int:
    from skinnet.inference._photo_verbs import predict

    return _OK if predict(options) else _BAD_INPUT


def _person(options: argparse.Namespace) -> int:
    from skinnet.inference._person_verb import person

    return _OK if person(options) else _BAD_INPUT


def _capture(options: argparse.Namespace) -> int:
    from skinnet.inference._capture_verb import capture

    capture(options)
    return _OK


def _edit(options: argparse.Namespace) -> int:
    from skinnet.inference._photo_verbs import edit

    edit(options)
    return _OK


def _compare(options: argparse.Namespace) -> int:
    from skinnet.inference._compare_verb import compare

    compare(options)
    return _OK


def _web(options: argparse.Namespace) -> int:
    from skinnet.inference._web.web_verb import web

    web(options)
    return _OK
