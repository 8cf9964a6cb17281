"""The names of exported files: another checkpoint's, or a user's, are not replaced."""

import json
import os
from pathlib import Path
from typing import Any

from skinnet.errors import InputError
from skinnet.files import READ_ERRORS
from skinnet.images._result_names import choose_stem, compute_digest, describe_input
from skinnet.inference._onnx_pair import get_decoder_path

DEFAULT = Path("skin.onnx")


def choose_output(checkpoint: Path, given: Path | None) -> Path:
    """Choose the encoder's file.

    Args:
        checkpoint: What is exported.
        given: The file that the user names; None: `DEFAULT`, with a number where files of another
            checkpoint have that name.

    Returns:
        The file.

    Raises:
        InputError: The user names a file that is there and was not exported from this checkpoint.
    """
    if given is None:
        ends = [file.name.removeprefix(DEFAULT.stem) for file in _list_files(DEFAULT)]
        stem = choose_stem(
            DEFAULT.parent, DEFAULT.stem, ends, lambda file: _owns(checkpoint, _find_encoder(file))
        )
        return DEFAULT.with_name(f"{stem}.onnx")
    for file in _list_files(given):
        if os.path.lexists(file) and not _owns(checkpoint, given):
            raise InputError(
                f"{file} is there already and was not exported from {checkpoint}; give another "
                "name with -o, or move it away."
            )
    return given


def describe_checkpoint(checkpoint: Path, output: Path) -> str:
    """Describe the checkpoint by path and digest, for the documentation of the encoder."""
    return json.dumps(describe_input(checkpoint, compute_digest(checkpoint), output.parent))


def _list_files(encoder: Path) -> list[Path]:
    return [encoder, get_decoder_path(encoder), encoder.with_suffix(".safetensors")]


def _find_encoder(file: Path) -> Path:
    return file.with_name(file.name.partition(".")[0] + ".onnx")


def _owns(checkpoint: Path, encoder: Path) -> bool:
    """Whether an encoder was exported from this checkpoint, also from an earlier state of it."""
    known = _read_checkpoint(encoder)
    place = known.get("path")
    same_place = isinstance(place, str) and os.path.realpath(
        encoder.parent / place
    ) == os.path.realpath(checkpoint)
    return same_place or (
        checkpoint.is_file() and known.get("sha256") == compute_digest(checkpoint)
    )


def _read_checkpoint(encoder: Path) -> dict[str, Any]:
    import onnx
    from google.protobuf.message import DecodeError  # type: ignore[import-untyped]

    try:
        known = json.loads(onnx.load(encoder, load_external_data=False).doc_string)
    except (DecodeError, *READ_ERRORS):
        return {}
    return known if isinstance(known, dict) else {}
