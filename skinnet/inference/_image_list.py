"""One image or many, and what messages call them."""

from collections.abc import Iterable, Iterator, Mapping, Set
from contextlib import contextmanager
from os import PathLike
from typing import Any

from PIL import Image

from skinnet.errors import InputError
from skinnet.images._arguments import check_text
from skinnet.images._picture_sources import PictureSource, is_array
from skinnet.images.picture import Picture

ImageLike = PictureSource
"""Whatever `skinnet.images.read_picture` reads."""


def is_many(images: object) -> bool:
    """Whether there are many images: an iterable of them, or a batch with one more axis.

    Raises:
        InputError: They have no order.
    """
    if is_array(images):
        return getattr(images, "ndim", 0) == 4
    one = (str, PathLike, bytes, bytearray, memoryview, Image.Image, Picture)
    if isinstance(images, one) or hasattr(images, "read"):
        return False
    if isinstance(images, Mapping | Set):
        raise InputError(
            f"Images are given as a list, whose order is that of the results; got "
            f"{type(images).__name__}. list(...) makes one; of a dict, list(images.values())."
        )
    return isinstance(images, Iterable)


def name_all(images: Iterable[Any], name: str | None) -> Iterator[tuple[Any, str, str]]:
    """Yield each image, its name, and its place, which is images[0] and so on.

    The name is that which is given, with the place; or its own, such as its path; or its place.
    """
    for index, image in enumerate(images):
        place = f"{name or 'images'}[{index}]"
        yield image, place if name else name_image(image) or place, place


@contextmanager
def locate_errors(image: object, name: str, place: str) -> Iterator[None]:
    """Read one of several images: an `InputError` that does not name it names its place.

    Raises:
        InputError: The image is a list or a batch itself.
    """
    try:
        if is_many(image):
            raise InputError(
                f"{place} is several images itself, a {type(image).__name__}; give one list of all "
                "images."
            )
        yield
    except InputError as error:
        if name in str(error):
            raise
        raise type(error)(f"{place}: {error}") from error


def drop_frames(error: InputError) -> InputError:
    """Return an error without the frames in which it was raised, which hold its image."""
    error.__cause__ = error.__context__ = None
    return error.with_traceback(None)


def name_image(image: object, name: str | None = None) -> str | None:
    """The name of an image in messages: that which is given, or its own; None if it has none."""
    if name is not None:
        return check_text("The name of an image", name)
    if isinstance(image, Picture):
        return image.name
    return str(image) if isinstance(image, str | PathLike) else None
