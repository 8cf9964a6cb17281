"""Flags of each verb of photographs."""

import argparse
from pathlib import Path

from skinnet.inference._command.shared_arguments import (
    add_common,
    add_folder,
    add_inputs,
    add_json,
    add_known,
    add_model,
    add_photographs,
    add_references,
)

FORMATS = ("jpg", "png", "tif", "webp", "avif", "heic", "bmp", "jp2", "ppm")
"""Formats that edits are written in, by their usual suffixes."""


def add_predict(verb: argparse.ArgumentParser) -> None:
    """Add the flags of `skinnet predict`."""
    add_inputs(verb)
    add_json(verb, "each summary")
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
    verb.add_argument(
        "--report",
        nargs="?",
        type=Path,
        const=Path(),
        metavar="FILE.html",
        help="write a page with a row for each face, which needs no other file; by default "
        "report.html beside the maps",
    )
    verb.add_argument(
        "--colour-maps",
        choices=("pigments", "all", "none"),
        default="pigments",
        help="which maps are written in colour too, as NAME_melanin_colour.png: those of the "
        "pigments by default; all adds shading and specular reflection",
    )
    add_common(verb)
    _add_workers(verb)


def add_edit(verb: argparse.ArgumentParser) -> None:
    """Add the flags of `skinnet edit`."""
    add_photographs(verb)
    verb.add_argument(
        "-o",
        "--output",
        metavar="FILE|DIR",
        help="a file for one photograph, whose suffix chooses the format; a folder for several, or "
        "if it ends in /; - for standard output; by default INPUT_edited beside each photograph, "
        "with a number if that is another file",
    )
    for pigment in ("melanin", "hemoglobin"):
        verb.add_argument(
            f"--{pigment}",
            type=float,
            default=1.0,
            metavar="X",
            help=f"factor of {pigment}, from 0 to 10; 1 by default",
        )
    verb.add_argument(
        "--state",
        nargs=2,
        action="append",
        metavar=("NAME", "AMOUNT"),
        help="what the blood of a face does, from 0 (at rest) to 1: flush, pallor, exertion, "
        "smile, frown, surprise, disgust, anger or pulse; may be given several times, and goes "
        "before --hemoglobin",
    )
    verb.add_argument(
        "--mask",
        type=Path,
        metavar="FILE",
        help="a grey picture of the photograph's size: skin is edited fully where it is white, "
        "partly where grey, and not where black",
    )
    verb.add_argument(
        "--format",
        type=_name_format,
        choices=FORMATS,
        metavar="FORMAT",
        help=f"{', '.join(FORMATS[:-1])} or {FORMATS[-1]}; that of each photograph by default",
    )
    verb.add_argument(
        "--quality",
        type=int,
        metavar="N",
        help="of JPEG, WebP, AVIF and HEIC, from 1 to 100; by default that of a JPEG photograph, "
        "WebP without loss stays so, and others have 95",
    )
    add_json(verb, "a summary of each edit")
    add_common(verb)
    _add_workers(verb)


def _add_workers(verb: argparse.ArgumentParser) -> None:
    verb.add_argument(
        "--workers",
        type=int,
        metavar="N",
        help="processes that share the photographs; by default one for each core, and fewer for "
        "few photographs or little memory; the results are the same",
    )


def _name_format(word: str) -> str:
    """A format by its usual suffix."""
    name = word.lower().removeprefix(".")
    return {"jpeg": "jpg", "tiff": "tif", "heif": "heic"}.get(name, name)


def add_person(verb: argparse.ArgumentParser) -> None:
    """Add the flags of `skinnet person`."""
    add_inputs(verb)
    add_json(verb)
    add_common(verb)


def add_compare(verb: argparse.ArgumentParser) -> None:
    """Add the flags of `skinnet compare`."""
    verb.add_argument("before", help="a photograph, or - for standard input")
    verb.add_argument("after", help="another one of the same face, from the same side")
    add_folder(verb, "skinmaps in the folder of the first photograph")
    add_json(verb)
    add_model(verb)
    add_known(verb, "the session of both")


def add_track(verb: argparse.ArgumentParser) -> None:
    """Add the flags of `skinnet track`."""
    verb.add_argument(
        "input",
        nargs="?",
        help="a video, or a folder of frames with their time stamps in times.csv (file,time)",
    )
    add_folder(verb, "skinmaps in the video's folder")
    verb.add_argument(
        "--face",
        type=lambda word: int(word) if word.lstrip("-").isdecimal() else word,
        metavar="N|largest",
        help="which face, where the video begins with several: its number from left to right",
    )
    verb.add_argument(
        "--baseline",
        type=_read_seconds,
        default=(0.0, 3.0),
        metavar="A,B",
        help="first and last second of the baseline, from the start of each shot; 0,3 by default",
    )
    verb.add_argument(
        "--fps", type=float, metavar="N", help="frames a second, where there are no time stamps"
    )
    verb.add_argument(
        "--seconds", type=float, metavar="N", help="read the first N seconds; all by default"
    )
    verb.add_argument(
        "--no-map", dest="map", action="store_false", help="write no video of the map; faster"
    )
    add_json(verb)
    add_model(verb)
    add_known(verb, "the session")


def _read_seconds(word: str) -> tuple[float, float]:
    """Two numbers with a comma between them."""
    try:
        begin, end = (float(each) for each in word.split(","))
    except ValueError as error:
        raise argparse.ArgumentTypeError(
            f"--baseline is its first and last second, such as 0,3; got {word!r:.40}."
        ) from error
    return begin, end


def add_capture(verb: argparse.ArgumentParser) -> None:
    """Add the flags of `skinnet capture`."""
    verb.add_argument("input", help="a picture of a colour chart, or of something white or grey")
    verb.add_argument(
        "-o",
        "--output",
        type=Path,
        metavar="FILE",
        required=True,
        help="the profile, a .yaml file, for --capture of the other verbs",
    )
    add_json(verb, "the profile")
    add_references(verb)


def add_web(verb: argparse.ArgumentParser) -> None:
    """Add the flags of `skinnet web`."""
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
