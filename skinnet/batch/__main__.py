"""`python -m skinnet.batch INPUT OUTPUT` reads any number of photographs into Parquet files."""

import argparse
import sys
from collections.abc import Sequence

from skinnet.errors import InputError
from skinnet.inference._command.shared_arguments import add_json, add_model
from skinnet.inference._command.verb_parser import VerbParser, read_verbosity
from skinnet.inference._messages import keep_verbosity, note, report, set_verbosity

_OK, _BAD_INPUT, _INTERRUPTED = 0, 2, 130

_COMMAND = "python -m skinnet.batch"
_EXAMPLES = (
    (f"{_COMMAND} photos faces -r", "a folder and those below it; again: only what is new"),
    (f"{_COMMAND} list.csv faces --path-column file", "the paths and URLs in a column"),
    (
        f"{_COMMAND} faces.parquet out --bytes-column image.bytes --name-column image.path",
        "pictures in a Parquet file, such as those of Hugging Face",
    ),
    (
        f"{_COMMAND} s3://bucket/photos s3://bucket/faces -r --address auto",
        "an object store, on a machine of a Ray cluster",
    ),
)


def main(argv: Sequence[str] | None = None) -> int:
    """Read photographs into Parquet files.

    Args:
        argv: The arguments; those of the process by default.

    Returns:
        The exit code: 0; 2 for bad input, or if a photograph could not be read; 130 after Ctrl-C.
    """
    with keep_verbosity():
        try:
            options = make_parser().parse(list(sys.argv[1:] if argv is None else argv))
            set_verbosity(read_verbosity(options))
            from skinnet.batch._run import run

            return _OK if run(options) else _BAD_INPUT
        except ModuleNotFoundError as error:
            if (error.name or "").partition(".")[0] not in ("ray", "pyarrow"):
                raise
            report(InputError(f'{_COMMAND} needs the ray extra: pip install "skinnet[ray]"'))
            return _BAD_INPUT
        except (InputError, OSError) as error:
            report(error)
            return _BAD_INPUT
        except KeyboardInterrupt:
            note("Interrupted. What is written stays; the same command reads the rest.")
            return _INTERRUPTED


def make_parser() -> VerbParser:
    """Make the parser of the command."""
    description = (
        "Read any number of photographs, on the cores of this machine or of a Ray cluster. OUTPUT "
        "becomes a folder of Parquet files with a row for each face, and one with the reason for "
        "each photograph that is not read. What is in OUTPUT already is not read again. The exit "
        "code is 2 if a photograph could not be read."
    )
    return VerbParser(_COMMAND, description, _EXAMPLES, _add_arguments)


def _add_arguments(verb: argparse.ArgumentParser) -> None:
    verb.add_argument(
        "input",
        metavar="INPUT",
        help="a folder of photographs; a list of paths (.txt, or .csv and .tsv with a column "
        "path); Parquet with the columns bytes and name; a path or a URL such as s3://bucket/folder",
    )
    verb.add_argument("output", metavar="OUTPUT", help="a folder for Parquet files; a path or URL")
    verb.add_argument(
        "-r", "--recursive", action="store_true", help="search the subfolders of a folder too"
    )
    _add_columns(verb)
    _add_reading(verb)
    _add_work(verb)
    add_json(verb, "the counts")


def _add_columns(verb: argparse.ArgumentParser) -> None:
    group = verb.add_argument_group("columns of the input")
    group.add_argument(
        "--path-column",
        metavar="NAME",
        help="paths and URLs in a CSV or Parquet file; path by default in CSV",
    )
    group.add_argument("--bytes-column", metavar="NAME", help="files of pictures; bytes by default")
    group.add_argument("--name-column", metavar="NAME", help="their names; name by default")


def _add_reading(verb: argparse.ArgumentParser) -> None:
    group = verb.add_argument_group("what is read")
    add_model(verb)
    group.add_argument(
        "--faces",
        type=lambda word: int(word) if word.lstrip("-").isdecimal() else word,
        default="largest",
        metavar="all|largest|N",
        help="which faces of a photograph of several people; by default the largest one",
    )
    group.add_argument(
        "--region",
        choices=("face", "skin"),
        default="face",
        help="skin for photographs of skin without a face; face by default",
    )
    group.add_argument(
        "--no-detail",
        dest="detail",
        action="store_false",
        help="do not add the photograph's detail to the network's maps; faster",
    )
    group.add_argument(
        "--maps", action="store_true", help="write the maps too, as 16-bit PNG in columns map_..."
    )


def _add_work(verb: argparse.ArgumentParser) -> None:
    group = verb.add_argument_group("how the work is done")
    group.add_argument(
        "--retry-failed",
        action="store_true",
        help="read again what could not be read before; its rows are replaced",
    )
    group.add_argument(
        "--address",
        metavar="HOST:PORT",
        help="a Ray cluster, or auto for the one that runs on this machine; by default RAY_ADDRESS "
        "from the environment, or the cores of this machine",
    )
    group.add_argument(
        "--workers",
        type=_count,
        metavar="N",
        help="most processes, each on one core; by default all cores",
    )
    group.add_argument(
        "--block",
        type=_count,
        metavar="N",
        help="photographs in one Parquet file; by default up to 256, and 16 with --maps",
    )


def _count(word: str) -> int:
    number = int(word)
    if number < 1:
        raise argparse.ArgumentTypeError(f"A number from 1 is needed; got {word}.")
    return number


if __name__ == "__main__":
    sys.exit(main())
