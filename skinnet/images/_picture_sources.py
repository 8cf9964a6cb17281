"""What a picture may be read from, and how arrays and tensors are told from the rest."""

from io import BufferedIOBase
from os import PathLike
from typing import Any, BinaryIO, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from skinnet.errors import InputError
from skinnet.images.picture import Picture


@runtime_checkable
class TensorLike(Protocol):
    """A tensor of torch, by its methods: torch itself is never imported."""

    def detach(self) -> Any:
        """The tensor without its gradient."""

    def cpu(self) -> Any:
        """The tensor in the memory of the processor."""

    def numpy(self) -> Any:
        """The tensor as an array."""


PathSource = str | PathLike[str]
ArraySource = NDArray[Any] | TensorLike
PictureSource = (
    PathSource
    | bytes
    | bytearray
    | memoryview
    | BinaryIO
    | BufferedIOBase
    | Image.Image
    | ArraySource
    | Picture
)
"""A path, the bytes of a file, an open binary file, a Pillow image, an array, a tensor of torch, or
a picture that has been read."""


def is_array(source: object) -> bool:
    """Whether a source is an array, a tensor, or has NumPy's protocol `__array__`."""
    if isinstance(source, np.ndarray | TensorLike):
        return True
    return hasattr(source, "__array__") and not isinstance(source, Image.Image | np.generic)


def convert_tensor(tensor: TensorLike) -> NDArray[Any]:
    """Convert a tensor of any device and type to an array; bfloat16 becomes float32.

    Raises:
        InputError: It has no values as an array has, such as a sparse or a meta tensor.
    """
    kind = getattr(tensor, "dtype", "?")
    try:
        values = tensor.detach().cpu()
        if str(getattr(values, "dtype", "")) == "torch.bfloat16":
            values = values.float()
        return np.asarray(values.numpy())
    except (TypeError, ValueError, RuntimeError, NotImplementedError) as error:
        raise InputError(
            f"A tensor of the type {kind} cannot be read as a picture "
            f"({str(error).splitlines()[0]:.100}); give a dense one of uint8 or float32."
        ) from error
