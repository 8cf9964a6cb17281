"""Weights of an autoencoder as one safetensors file, with what is needed to rebuild it."""

import json
import math
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

import torch
from safetensors import SafetensorError, safe_open
from safetensors.torch import save
from torch import Tensor

from skinnet._version import __version__
from skinnet.errors import InputError, _clip
from skinnet.files import READ_ERRORS, write_atomically
from skinnet.files._content import describe_content, explain_format
from skinnet.network._earlier_weights import EARLIER_FORMAT

WEIGHTS_FORMAT = 4
"""Version of weights and checkpoints; increase it whenever the meaning of a weight changes."""

KIND = "autoencoder"
_LARGEST = 1e5
"""Largest weight of an encoder; those of the shipped one stay below a thousandth of it."""

_REMEDY = "give one that training wrote, such as RUN/best.ckpt"
_CONTENTS = {".ckpt": "a checkpoint of torch", ".safetensors": "weights in safetensors"}
SHIPPED_WEIGHTS = Path(__file__).parents[1] / "inference" / "models" / "skin.safetensors"


class SavedModel(NamedTuple):
    """What a file holds of a model: fields of its configuration, its origin, and its weights.

    `version` is that of the skinnet that wrote the file, if it says so, and `format` the file's.
    """

    config: Mapping[str, Any]
    trained_on: str
    state: dict[str, Tensor]
    version: str | None = None
    format: int = WEIGHTS_FORMAT


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
    except (SafetensorError, *READ_ERRORS) as error:
        what = describe_other_content(path, ".safetensors")
        raise InputError(f"{path} is not a complete safetensors file{what} ({error}).") from error
    if metadata.get("skinnet.kind") != KIND:
        raise InputError(f"{path} does not hold weights of skinnet; another program wrote it.")
    if metadata.get("skinnet.format") not in (str(WEIGHTS_FORMAT), str(EARLIER_FORMAT)):
        found, version = metadata.get("skinnet.format"), metadata.get("skinnet.version")
        raise make_format_error(path, found, version)
    with refuse_mismatch(path, metadata.get("skinnet.version")):
        check_state(path, state)
        config = json.loads(metadata["skinnet.config"])
        version, number = metadata.get("skinnet.version"), int(metadata["skinnet.format"])
        return SavedModel(config, metadata["skinnet.trained_on"], state, version, number)


def check_state(path: Path, state: Mapping[str, Any]) -> None:
    """Check that weights are numbers, and of a size that training may find.

    Raises:
        InputError: A weight is no tensor, NaN, infinite, or larger.
    """
    for name, value in state.items():
        if not isinstance(value, Tensor) or value.layout != torch.strided:
            raise InputError(f"{path} holds {name}, which is no plain tensor; {_REMEDY}.")
        values = value.detach().abs() if value.is_floating_point() else torch.zeros(1)
        # The constants of the physics have units, in which they may be large.
        largest = _LARGEST if "encoder." in name else math.inf
        wrong = ~(values.isfinite() & (values <= largest))
        if wrong.any():
            found = value.detach()[wrong].flatten()[0].item()
            raise InputError(
                f"{path} has weights that are no weights of a trained model: {found:g} in {name}; "
                f"{_REMEDY}."
            )


@contextmanager
def refuse_mismatch(path: Path, version: object = None) -> Iterator[None]:
    """Turn an error of rebuilding a model from its description into `InputError`."""
    try:
        yield
    except InputError as error:
        if version in (None, __version__):
            raise
        raise InputError(f"{error} ({path}: {_name_versions(version)})") from error
    except (KeyError, TypeError, ValueError, RuntimeError, AttributeError, OverflowError) as error:
        wrote = "" if version in (None, __version__) else f"; {_name_versions(version)}"
        raise InputError(f"{path} does not hold the model that it describes{wrote}.") from error


def _name_versions(version: object) -> str:
    return f"skinnet {version} wrote it, and this is skinnet {__version__}"


def make_format_error(path: str | Path, found: object, version: object) -> InputError:
    """Make the error for weights of another format."""
    return InputError(
        f"{path} has format {_clip(found)}, this skinnet reads {WEIGHTS_FORMAT}; train it again "
        "with this version, or use the one that wrote it "
        f"({explain_format(found, WEIGHTS_FORMAT, version)})."
    )


def describe_other_content(path: Path, suffix: str) -> str:
    """Say in brackets what a file is instead of weights with that suffix; nothing if unknown."""
    content = describe_content(path) if path.is_file() else None
    if content is None or content[0] == _CONTENTS[suffix]:
        return ""
    what, remedy = content
    for other, own in _CONTENTS.items():
        if what == own:
            remedy = f"give it a name that ends in {other}"
    return f" (it is {what}; {remedy})" if remedy else f" (it is {what})"
