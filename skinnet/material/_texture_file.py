"""Texture files of any size, read and written by strips of rows (OpenImageIO)."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from skinnet.errors import InputError, _explain_missing

TYPES = ("uint8", "uint16", "half", "float")
"""Types of channels that an albedo may have, as OpenImageIO names them."""

_STRIP = 64
"""Rows of a strip of a file that is not tiled."""

_MAX_SIDE = 65536
_LINEAR_SPACES = frozenset({"linear", "lin_rec709", "lin_rec709_scene", "lin_srgb", "scene_linear"})
_COLOURS = ("R", "G", "B")
_FORMS = ("tiff:ColorSpace", "jpeg:ColorSpace")
_OTHER_COLOURS = ("CMYK", "COLOR SEPARATED", "YCBCRK", "YCCK", "CIELAB", "ICCLAB", "ITULAB", "LOGL",
                  "LOGLUV")  # fmt: skip
"""Colours that OpenImageIO gives as red, green and blue although they are none, or only by a rule
of thumb."""


@dataclass(frozen=True, eq=False)
class TextureFile:
    """An open texture with red, green and blue.

    Attributes:
        path: The file.
        spec: What OpenImageIO says of it; a copy describes a file of the same kind.
        rgb: Places of red, green and blue among the channels.
        alpha: Place of the opacity; None if there is none.
        linear: Whether its values are linear.
        input: The open file.
    """

    path: Path
    spec: Any
    rgb: tuple[int, int, int]
    alpha: int | None
    linear: bool
    input: Any

    @property
    def type(self) -> str:
        """Type of the channels, one of `TYPES`."""
        return str(self.spec.format)

    @property
    def is_float(self) -> bool:
        """Whether the channels are floating-point numbers."""
        return self.type in ("half", "float")

    @property
    def top(self) -> int:
        """The stored value of white; 1 for floating-point numbers."""
        return {"uint8": 255, "uint16": 65535}.get(self.type, 1)

    def read_strips(self) -> Iterator[NDArray[Any]]:
        """Read all channels [rows, width, channels], strip by strip from the top.

        Raises:
            InputError: The file is damaged.
        """
        spec = self.spec
        rows, end = spec.tile_height or _STRIP, spec.y + spec.height
        for top in range(spec.y, end, rows):
            strip = self._read(top, min(top + rows, end))
            if strip is None:
                said = " ".join(self.input.geterror().split())
                raise InputError(
                    f"{self.path} is damaged or cut short ({said}); copy or download it again."
                )
            yield np.asarray(strip)

    def _read(self, top: int, bottom: int) -> Any:
        spec, count = self.spec, self.spec.nchannels
        if spec.tile_width:
            right = spec.x + spec.width
            return self.input.read_tiles(spec.x, right, top, bottom, 0, 1, 0, count, self.type)
        return self.input.read_scanlines(top, bottom, 0, 0, count, self.type)

    def close(self) -> None:
        """Close the file."""
        self.input.close()


def open_texture(path: Path, space: str | None = None) -> TextureFile:
    """Open a texture.

    Args:
        path: A PNG, TIFF, EXR or JPEG file.
        space: sRGB or linear; None: what the file states; else linear for EXR, sRGB for others.

    Returns:
        The open texture.

    Raises:
        InputError: It is missing, damaged, has other channels or parts, or another colour space.
    """
    oiio = import_openimageio()
    if not path.exists():
        raise InputError(f"There is no file {path}; check the path.")
    settings = oiio.ImageSpec()
    settings.attribute("oiio:UnassociatedAlpha", 1)  # else colours are multiplied by it
    source = oiio.ImageInput.open(str(path), settings) if path.is_file() else None
    if source is None:
        oiio.geterror()
        raise InputError(f"{path} is not a texture that can be read; give a PNG, TIFF or EXR file.")
    spec = source.spec()
    rgb, alpha = _find_channels(list(spec.channelnames), path)
    _check_form(source, spec, path)
    return TextureFile(path, spec, rgb, alpha, _is_linear(source, spec, path, space), source)


def import_openimageio() -> Any:
    """Import OpenImageIO, which the extra `textures` brings."""
    try:
        import OpenImageIO
    except ModuleNotFoundError as error:
        raise _explain_missing(error, "textures", "A texture file") from error
    return OpenImageIO


def _find_channels(names: list[str], path: Path) -> tuple[tuple[int, int, int], int | None]:
    upper = [name.upper() for name in names]
    listed = ", ".join(names)
    if not all(name in upper for name in _COLOURS):
        raise InputError(
            f"{path} has the channels {listed}, and an albedo has R, G and B; give the texture of "
            "the colour, or rename its channels."
        )
    others = [name for name, one in zip(names, upper, strict=True) if one not in (*_COLOURS, "A")]
    if others:
        raise InputError(
            f"{path} has channels beside R, G, B and A: {', '.join(others)}; save the albedo alone."
        )
    red, green, blue = (upper.index(name) for name in _COLOURS)
    return (red, green, blue), upper.index("A") if "A" in upper else None


def _check_form(source: Any, spec: Any, path: Path) -> None:
    if str(spec.format) not in TYPES:
        raise InputError(
            f"{path} has values of the type {spec.format}; save it with 8 or 16 bits, or as half "
            "or float."
        )
    if spec.depth > 1 or (source.seek_subimage(1, 0) and spec.format in ("half", "float")):
        raise InputError(f"{path} has several parts; save the albedo alone.")
    source.seek_subimage(0, 0)
    for form in (str(spec.getattribute(name) or "") for name in _FORMS):
        if form.upper() in _OTHER_COLOURS:
            raise InputError(f"{path} stores its colours as {form}; convert it to RGB in sRGB.")
    if max(spec.width, spec.height) > _MAX_SIDE:
        raise InputError(
            f"{path} is {spec.width} x {spec.height}; the longest side is {_MAX_SIDE}. Cut it into "
            "UDIM tiles."
        )


def _is_linear(source: Any, spec: Any, path: Path, space: str | None) -> bool:
    if space is not None:
        return space == "linear"
    profile = spec.getattribute("ICCProfile:profile_description") or ""
    if profile and "srgb" not in str(profile).lower():
        raise InputError(
            f"{path} is in the colour space {profile}; convert it to sRGB, or say --space sRGB to "
            "read it as that."
        )
    stated = str(spec.getattribute("oiio:ColorSpace") or "").lower()
    return source.format_name() == "openexr" or stated in _LINEAR_SPACES


class TextureWriter:
    """Writes a texture from the top, strip by strip.

    Args:
        part: The temporary path to write to.
        spec: What OpenImageIO is to know of the file.

    Raises:
        InputError: The file cannot be written.
    """

    def __init__(self, part: Path, spec: Any) -> None:
        self._path, self._row = part, spec.y
        self._output = import_openimageio().ImageOutput.create(str(part))
        if self._output is None or not self._output.open(str(part), spec):
            self._fail()

    def write(self, strip: NDArray[Any]) -> None:
        """Write rows [rows, width, channels]."""
        after = self._row + len(strip)
        if not self._output.write_scanlines(self._row, after, 0, np.ascontiguousarray(strip)):
            self._fail()
        self._row = after

    def close(self) -> None:
        """Finish the file."""
        if not self._output.close():
            self._fail()

    def __enter__(self) -> "TextureWriter":
        return self

    def __exit__(self, kind: object, *_: object) -> None:
        if kind is None:
            self.close()
        else:
            with _silence():  # libpng would print that the file is not complete
                self._output.close()

    def _fail(self) -> None:
        said = self._output.geterror() if self._output else "unknown ending"
        raise OSError(None, f"it cannot be written: {said}", str(self._path))


@contextmanager
def _silence() -> Iterator[None]:
    """Hide what C libraries print to standard error."""
    kept, null = os.dup(2), os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(null, 2)
        yield
    finally:
        os.dup2(kept, 2)
        os.close(kept)
        os.close(null)


def describe_copy(texture: TextureFile, software: str) -> Any:
    """Describe a file of the same kind as a texture: type, compression, profile, metadata."""
    spec = import_openimageio().ImageSpec(texture.spec)
    spec.tile_width = spec.tile_height = 0
    spec.attribute("Software", software)
    _speed_up(spec)
    return spec


def describe_map(texture: TextureFile, channels: int, type_: str, texts: dict[str, str]) -> Any:
    """Describe a map of the size of a texture."""
    spec = import_openimageio().ImageSpec(texture.spec.width, texture.spec.height, channels, type_)
    for key, value in texts.items():
        spec.attribute(key, value)
    spec.attribute("oiio:ColorSpace", "lin_rec709_scene" if type_ == "float" else "data")
    if type_ == "float":
        spec.attribute("compression", "zips")
    _speed_up(spec)
    return spec


def _speed_up(spec: Any) -> None:
    # The low bits of maps are noise that no level compresses.
    spec.attribute("png:compressionLevel", 1)
    spec.attribute("png:filter", 32)
