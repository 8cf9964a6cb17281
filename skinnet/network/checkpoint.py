"""Checkpoints of training: what in them is ours, and reading them without running anything."""

import pickle
from pathlib import Path
from typing import Any

import torch

from skinnet._version import __version__
from skinnet.errors import InputError
from skinnet.network.autoencoder import FORMAT, AutoencoderConfig, SkinAutoencoder
from skinnet.network._weights import as_described

_PREFIX = "model."


def describe(config: AutoencoderConfig, trained_on: str) -> dict[str, Any]:
    """The entry `skinnet` of a checkpoint, in primitives."""
    return {
        "format": FORMAT,
        "version": __version__,
        "optics": config.optics,
        "widths": list(config.widths),
        "working_size": config.working_size,
        "trained_on": trained_on,
    }


def checkpoint_of(model: SkinAutoencoder, trained_on: str) -> dict[str, Any]:
    """What of a checkpoint `load_checkpoint` needs; training does not go on with it."""
    state = {f"{_PREFIX}{name}": value for name, value in model.state_dict().items()}
    return {"skinnet": describe(model.config, trained_on), "state_dict": state}


def read_checkpoint(path: str | Path) -> dict[str, Any]:
    """A checkpoint, loaded with `weights_only`.

    Raises `InputError` for a file that is missing, truncated, not ours or of another version.
    """
    if not Path(path).is_file():
        raise InputError(f"{path} is not a checkpoint file; give one, such as RUN/best.ckpt.")
    try:
        checkpoint = torch.load(path, map_location="cpu", weights_only=True)
    except (RuntimeError, EOFError, pickle.UnpicklingError, OSError, ValueError) as error:
        raise InputError(
            f"{path} is no whole checkpoint; give one that training wrote: RUN/best.ckpt."
        ) from error
    note = checkpoint.get("skinnet") if isinstance(checkpoint, dict) else None
    if not isinstance(note, dict):
        raise InputError(f"{path} is not a checkpoint of skinnet; something else wrote it.")
    if note.get("format") != FORMAT:
        raise InputError(
            f"{path} has format {note.get('format')}, this skinnet reads {FORMAT}; it was written "
            f"by version {note.get('version')}."
        )
    return dict(checkpoint)


def load_checkpoint(path: str | Path) -> tuple[SkinAutoencoder, str]:
    """The model of a checkpoint, in evaluation mode, and what it was trained on."""
    checkpoint = read_checkpoint(path)
    note = checkpoint["skinnet"]
    with as_described(path):
        config = AutoencoderConfig(note["optics"], tuple(note["widths"]), note["working_size"])
        model = SkinAutoencoder(config)
        entries = checkpoint["state_dict"].items()
        state = {name.removeprefix(_PREFIX): v for name, v in entries if name.startswith(_PREFIX)}
        model.load_state_dict(state)
        return model.eval(), note["trained_on"]
