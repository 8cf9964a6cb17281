"""Checkpoints of training, read without running any code from them."""

import pickle
import zipfile
from pathlib import Path
from typing import Any

import torch

from skinnet._version import __version__
from skinnet.errors import InputError
from skinnet.files import READ_ERRORS
from skinnet.files._npz import check_zip
from skinnet.network._weights import (
    WEIGHTS_FORMAT,
    SavedModel,
    check_state,
    describe_other_content,
    make_format_error,
    refuse_mismatch,
)

_PREFIX = "model."
_CONFIG = "optics", "widths", "working_size", "white_balance_max"


def read_checkpoint(path: str | Path) -> dict[str, Any]:
    """Load a checkpoint of training with `weights_only`.

    `SkinAutoencoder.from_pretrained` makes a model from it.

    Args:
        path: A .ckpt file, such as RUN/best.ckpt.

    Returns:
        The checkpoint as Lightning wrote it. Its entry `skinnet` describes the model.

    Raises:
        InputError: For a file that is missing, truncated, of another format or not of skinnet.

    Example:
        >>> from skinnet.network import read_checkpoint
        >>> read_checkpoint("absent.ckpt")
        Traceback (most recent call last):
        ...
        skinnet.errors.InputError: There is no checkpoint absent.ckpt; give RUN/best.ckpt or RUN/last.ckpt.
    """  # noqa: E501 - a message of one line
    if not Path(path).is_file():
        raise InputError(f"There is no checkpoint {path}; give RUN/best.ckpt or RUN/last.ckpt.")
    check_zip(Path(path))
    try:
        checkpoint = torch.load(path, map_location="cpu", weights_only=True)
    except (pickle.UnpicklingError, zipfile.BadZipFile, *READ_ERRORS) as error:
        raise InputError(_explain_unreadable(Path(path), error)) from error
    description = checkpoint.get("skinnet") if isinstance(checkpoint, dict) else None
    if not isinstance(description, dict):
        raise InputError(f"{path} is not a checkpoint of skinnet; another program wrote it.")
    if description.get("format") != WEIGHTS_FORMAT:
        raise make_format_error(path, description.get("format"), description.get("version"))
    if not isinstance(checkpoint.get("state_dict"), dict):
        raise InputError(f"{path} has no weights; give one that training wrote: RUN/best.ckpt.")
    check_state(Path(path), checkpoint["state_dict"])
    return dict(checkpoint)


def _explain_unreadable(path: Path, error: Exception) -> str:
    if isinstance(error, pickle.UnpicklingError) and zipfile.is_zipfile(path):
        return (
            f"{path} holds other objects than weights, and they are not loaded, since they could "
            "run code; another program or a newer version of it wrote the file. Give a checkpoint "
            "that skinnet's training wrote, such as RUN/best.ckpt."
        )
    what = describe_other_content(path, ".ckpt")
    return (
        f"{path} is not a complete checkpoint{what}; give one that training wrote, such as "
        "RUN/best.ckpt."
    )


def _read_model(path: Path) -> SavedModel:
    """The model in a checkpoint of training."""
    checkpoint = read_checkpoint(path)
    description = checkpoint["skinnet"]
    with refuse_mismatch(path, description.get("version")):
        config = {name: description[name] for name in _CONFIG}
        entries = checkpoint["state_dict"].items()
        state = {name.removeprefix(_PREFIX): v for name, v in entries if name.startswith(_PREFIX)}
        return SavedModel(config, description["trained_on"], state, description.get("version"))


def _describe(saved: SavedModel) -> dict[str, Any]:
    """The entry `skinnet` of a checkpoint, in primitives."""
    return {
        "format": WEIGHTS_FORMAT,
        "version": __version__,
        **saved.config,
        "widths": list(saved.config["widths"]),
        "trained_on": saved.trained_on,
    }


def _make_checkpoint(saved: SavedModel) -> dict[str, Any]:
    """A checkpoint that holds a model and nothing of its training."""
    state = {f"{_PREFIX}{name}": value for name, value in saved.state.items()}
    return {"skinnet": _describe(saved), "state_dict": state}
