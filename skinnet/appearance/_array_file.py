"""Arrays with a header in .npz files: nothing is pickled, all is written or nothing."""

import json
import zipfile
import zlib
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from skinnet._version import __version__
from skinnet.errors import InputError, _clip, _explain_fault
from skinnet.files import write_atomically
from skinnet.files._content import describe_content, explain_format
from skinnet.files._npz import read_npz

MODEL_FORMAT = 1
"""Version of the layout of these files."""

ARCHIVE_ERRORS = (
    *(OSError, EOFError, KeyError, TypeError, ValueError, AttributeError),
    *(zipfile.BadZipFile, zlib.error, NotImplementedError, MemoryError),
)
"""Errors that NumPy, zipfile and JSON raise on damaged .npz files."""

Array = NDArray[Any]


def write_arrays(
    path: Path,
    kind: str,
    header: dict[str, Any],
    arrays: dict[str, Any],
    compress: bool = False,
) -> None:
    """Write arrays with a header that gives their kind and format."""
    if path.suffix != ".npz":
        raise InputError(f"{path} does not end in .npz; models and maps are .npz files.")
    header = {"kind": kind, "format": MODEL_FORMAT, "skinnet": __version__} | header
    try:
        with write_atomically(path) as part:
            save = np.savez_compressed if compress else np.savez
            save(part, header=np.array(json.dumps(header)), **arrays)
    except OSError as error:
        raise InputError(f"{path} cannot be written {_explain_fault(error)}.") from error


def read_arrays(
    path: Path, kind: str, names: tuple[str, ...]
) -> tuple[dict[str, Any], dict[str, Array]]:
    """Read the header and arrays of a file of that kind; anything else is an `InputError`."""
    if not path.is_file():
        raise InputError(f"There is no file {path}; check the path.")
    try:
        header = json.loads(str(read_npz(path, ["header"])["header"]))
        _check_header(path, kind, header)
        return header, read_npz(path, names)
    except InputError:
        raise
    except ARCHIVE_ERRORS as error:
        raise make_damage_error(path) from error


def make_damage_error(path: Path) -> InputError:
    """Make the error for a file that is damaged or of another kind."""
    content = describe_content(path) if path.is_file() else None
    what = "damaged, cut short, or another kind"
    if content is not None and content[0] != "an .npz archive of arrays":
        what = "; ".join(filter(None, (f"it is {content[0]}", content[1])))
    return InputError(f"{path} is not a complete file of skinnet's ({what}); make it again.")


def _check_header(path: Path, kind: str, header: dict[str, Any]) -> None:
    if header["format"] != MODEL_FORMAT:
        raise InputError(
            f"{path} has format {_clip(header['format'])}, and this skinnet reads format "
            f"{MODEL_FORMAT}; "
            "make it again with this version, or use the one that wrote it "
            f"({explain_format(header['format'], MODEL_FORMAT, header.get('skinnet'))})."
        )
    if header["kind"] != kind:
        raise InputError(f"{path} is a {_clip(header['kind'])}, and a {kind} is needed.")
