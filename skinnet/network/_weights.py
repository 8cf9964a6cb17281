"""Weights of an autoencoder as one safetensors file, with what is needed to rebuild it."""

import json
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict
from pathlib import Path

from safetensors import SafetensorError, safe_open
from safetensors.torch import save
from torch import Tensor

from skinnet._version import __version__
from skinnet.errors import InputError
from skinnet.files import write_atomically
from skinnet.network.autoencoder import FORMAT, AutoencoderConfig, SkinAutoencoder

KIND = "autoencoder"
SHIPPED = Path(__file__).parents[1] / "inference" / "models" / "skin.safetensors"


def save_weights(model: SkinAutoencoder, path: str | Path, trained_on: str) -> None:
    """Write the weights and the configuration of `model`; `trained_on` says what made them."""
    metadata = {
        "skinnet.kind": KIND,
        "skinnet.format": str(FORMAT),
        "skinnet.version": __version__,
        "skinnet.config": json.dumps(asdict(model.config)),
        "skinnet.trained_on": trained_on,
    }
    state = {name: value.detach().cpu().contiguous() for name, value in model.state_dict().items()}
    with write_atomically(Path(path)) as part:
        part.write_bytes(save(state, metadata))


def load_weights(path: str | Path = SHIPPED) -> SkinAutoencoder:
    """The autoencoder saved at `path`, in evaluation mode; without a path, the shipped one.

    Raises `InputError` for a file that is missing, truncated, not ours or of another format.
    """
    metadata, state = read_weights(path)
    with as_described(path):
        fields = json.loads(metadata["skinnet.config"])
        config = AutoencoderConfig(**{**fields, "widths": tuple(fields["widths"])})
        model = SkinAutoencoder(config)
        model.load_state_dict(state)
    return model.eval()


@contextmanager
def as_described(path: str | Path) -> Iterator[None]:
    """Turns what goes wrong in rebuilding the model of a file into `InputError`."""
    try:
        yield
    except (KeyError, TypeError, ValueError, RuntimeError) as error:
        raise InputError(f"{path} does not hold the model that it describes.") from error


def read_weights(path: str | Path) -> tuple[dict[str, str], dict[str, Tensor]]:
    """Metadata and tensors of a weights file, checked to be ours."""
    if not Path(path).is_file():
        raise InputError(f"{path} is not a file; give the path of a .safetensors file.")
    try:
        with safe_open(str(path), framework="pt") as file:
            metadata = file.metadata() or {}
            state = {name: file.get_tensor(name) for name in file.keys()}
    except SafetensorError as error:
        raise InputError(f"{path} is no complete safetensors file ({error}).") from error
    if metadata.get("skinnet.kind") != KIND:
        raise InputError(f"{path} holds no skinnet weights; it was written by something else.")
    if metadata.get("skinnet.format") != str(FORMAT):
        raise InputError(
            f"{path} has format {metadata.get('skinnet.format')}, this skinnet reads {FORMAT}; "
            f"it was written by version {metadata.get('skinnet.version')}."
        )
    return metadata, state
