"""Flags that several verbs of photographs have."""

import argparse
from collections.abc import Callable
from pathlib import Path

_FILE_ENDS = (".png", ".tif", ".tiff", ".exr", ".jpg", ".jpeg", ".json")


def add_photographs(verb: argparse.ArgumentParser) -> None:
    """Add the photographs that a verb reads."""
    verb.add_argument(
        "input",
        nargs="+",
        help="photographs, folders of them, patterns such as '*.jpg', or - for standard input",
    )
    verb.add_argument(
        "-r", "--recursive", action="store_true", help="search the subfolders of folders too"
    )


def add_inputs(verb: argparse.ArgumentParser) -> None:
    """Add the photographs that a verb reads, and the folder of its results."""
    add_photographs(verb)
    add_folder(verb, "skinmaps in the photograph's folder")


def add_json(verb: argparse.ArgumentParser, what: str = "the summary") -> None:
    """Add the flag for one line of JSON."""
    verb.add_argument(
        "--json", action="store_true", help=f"print {what} as one line of JSON, nothing else"
    )


def add_folder(
    verb: argparse.ArgumentParser, usual: str, read: Callable[[str], Path] | None = None
) -> None:
    """Add the folder to write to, and which one it is by default."""
    verb.add_argument(
        "-o",
        "--output",
        type=read or read_folder,
        metavar="DIR",
        help=f"folder to write to; by default {usual}",
    )


def read_folder(word: str) -> Path:
    """Read the name of a folder of results.

    Raises:
        argparse.ArgumentTypeError: It is that of standard output.
    """
    if word == "-":
        raise argparse.ArgumentTypeError(
            "-o is a folder, since several files are written; --json prints the numbers to "
            "standard output."
        )
    return Path(word)


def read_texture_folder(word: str) -> Path:
    """Read the name of a folder of textures, which are easily named as one file.

    Raises:
        argparse.ArgumentTypeError: It is that of a file, or of standard output.
    """
    folder = read_folder(word)
    if folder.suffix.lower() in _FILE_ENDS and not folder.is_dir():
        raise argparse.ArgumentTypeError(
            f"it is a folder, in which files are named after what they are made from; got {word}"
        )
    return folder


def add_model(verb: argparse.ArgumentParser) -> None:
    """Add the encoder, and what runs it."""
    verb.add_argument(
        "--model",
        type=Path,
        metavar="FILE",
        help="encoder, X.onnx, with X.decoder.onnx in the same folder; by default the shipped one",
    )
    verb.add_argument(
        "--provider",
        type=lambda names: [name.strip() for name in names.split(",")],
        metavar="NAME",
        help="what runs the networks: cpu, cuda, coreml or directml; cuda,cpu takes the processor "
        "where there is no CUDA; by default the processor",
    )


def add_common(verb: argparse.ArgumentParser) -> None:
    """Add which skin is read, by which encoder, and what is known of the capture."""
    add_model(verb)
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
    add_known(verb, "the session")


def add_known(verb: argparse.ArgumentParser, session: str) -> None:
    """Add what may be known of the light and the camera."""
    verb.add_argument(
        "--capture",
        type=Path,
        metavar="FILE.yaml",
        help=f"the profile of {session}, which skinnet capture makes",
    )
    add_references(verb)
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


def add_references(verb: argparse.ArgumentParser) -> None:
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
