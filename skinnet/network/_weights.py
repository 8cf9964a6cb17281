"""Weights of an autoencoder as one safetensors file, with what is needed to rebuild it."""

import json
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

from safetensors import SafetensorError, safe_open
from safetensors.torch import save
from torch import Tensor

from skinnet._version import __version__
from skinnet.errors import InputError
from skinnet.files import write_atomically

WEIGHTS_FORMAT = 3
"""Version of weights and checkpoints; increase it whenever the meaning of a weight changes."""

KIND = "autoencoder"
SHIPPED_WEIGHTS = Path(__file__).parents[1] / "inference" / "models" / "skin.safetensors"


class SavedModel(NamedTuple):
    """What a file holds of a model: fields of its configuration, its origin, and its weights."""

    config: Mapping[str, Any]
    trained_on: str
    state: dict[str, Tensor]


def write_weights(saved: SavedModel, path: Path) -> None:
    """Write a model as a safetensors file."""
    metadata = {
        "skinnet.kind": KIND,
        "skinnet.format": str(WEIGHTS_FORMAT),
        "skinnet.version": __version__,
        "skinnet.config": json.dumps(saved.config),
        "skinnet.trained_on": saved.trained_on,
    }
    state = {name: value.detach().cpu().contiguous() for name, value in saved.state.items()}
    with write_atomically(path) as part:
        part.write_bytes(save(state, metadata))


def read_weights(path: Path) -> SavedModel:
    """Read a model from a safetensors file.

    Raises:
        InputError: For a file that is missing, truncated, of another format or not of skinnet.
    """
    if not path.is_file():
        raise InputError(f"{path} is not a file; give the path of a .safetensors file.")
    try:
        with safe_open(str(path), framework="pt") as file:
            metadata = file.metadata() or {}
            state = {name: file.get_tensor(name) for name in file.keys()}
    except SafetensorError as error:
        raise InputError(f"{path} is not a complete safetensors file ({error}).") from error
    if metadata.get("skinnet.kind") != KIND:
        raise InputError(f"{path} does not hold weights of skinnet; another program wrote it.")
    if metadata.get("skinnet.format") != str(WEIGHTS_FORMAT):
        raise InputError(
            f"{path} has format {metadata.get('skinnet.format')}, this skinnet reads "
            f"{WEIGHTS_FORMAT}; it was written by version {metadata.get('skinnet.version')}."
        )
    with refuse_mismatch(path):
        config = json.loads(metadata["skinnet.config"])
        return SavedModel(config, metadata["skinnet.trained_on"], state)


@contextmanager
def refuse_mismatch(path: Path) -> Iterator[None]:
    """Turn an error of rebuilding a model from its description into `InputError`."""
    try:
        yield
    except (KeyError, TypeError, ValueError, RuntimeError) as error:
        raise InputError(f"{path} does not hold the model that it describes.") from error
