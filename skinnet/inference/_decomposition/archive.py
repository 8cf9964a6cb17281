"""The file of a decomposition: all of it, with its photograph, exactly."""

import math
from collections.abc import Mapping
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from skinnet._version import __version__
from skinnet.errors import InputError
from skinnet.images._arguments import check_path
from skinnet.images._decode import MAX_PIXELS
from skinnet.images.box import Box
from skinnet.images.colour_space import ColourSpace
from skinnet.images.faces._turned_square import TurnedSquare
from skinnet.images.picture import Picture
from skinnet.inference._decomposition.array_file import (
    DAMAGES,
    ArrayFile,
    describe_damage,
    open_arrays,
    write_arrays,
)
from skinnet.inference._decomposition.edit import get_source
from skinnet.inference._decomposition.face_record import record_parts, restore_box, restore_parts
from skinnet.inference._decomposition.maps import SkinMaps
from skinnet.inference._head_crop import HeadCrop
from skinnet.inference._pigment_edit import EDITED_MAPS, EditSource, ModelPair
from skinnet.inference._uncertainty import PIGMENTS, Uncertainty
from skinnet.inference.onnx_model import OutputInfo

_KIND, _FORMAT = "skinnet.Decomposition", 1
_SUFFIX = ".npz"
_MAPS = ("melanin", "hemoglobin", "shading", "specular", "mask")
_CAPTURE = {"light": 2, "temperature": 1, "camera": 2, "white_balance": 2}
"""Axes of the encoder's capture."""

_PLAIN = (
    *("light", "camera", "model", "face_id", "faces_found", "tilt", "pixels_read", "provider"),
    "exif",
)
_TUPLES = ("notes", "capture_known")
"""Fields that JSON holds as they are, and those that are tuples of sentences or names."""


def write_archive(maps: SkinMaps, path: str | PathLike[str]) -> None:
    """Write a decomposition, as `Decomposition.save` describes."""
    file = check_path("The file of a decomposition", path)
    if file.suffix.lower() != _SUFFIX:
        raise InputError(f"{file} must end in {_SUFFIX}, the kind of file that is written.")
    source, part = get_source(maps), maps.box.slices
    # Outside the box, maps are 0 and the reconstruction is the photograph.
    arrays = {name: getattr(maps, name)[part] for name in (*_MAPS, "offset", "reconstruction")}
    arrays |= {f"log_sd_{name}": maps.uncertainty.of_pixels(name) for name in PIGMENTS}
    header = {
        "kind": _KIND,
        "format": _FORMAT,
        "version": __version__,
        "shape": list(maps.mask.shape),
        "box": list(maps.box),
        **{name: getattr(maps, name) for name in (*_PLAIN, *_TUPLES, "skin_chromaticity")},
        "output_info": {name: list(info) for name, info in maps.output_info.items()},
        "uncertainty": [list(maps.uncertainty.face), list(maps.uncertainty.region_share)],
        "colour_space": _record_space(maps.colour_space, "profile", arrays),
        "face_parts": record_parts(maps.face_parts, arrays),
        "source": _record_source(source, arrays),
    }
    write_arrays(file, header, arrays)


def read_archive(path: str | PathLike[str], models: ModelPair | None) -> dict[str, Any]:
    """Read the fields of a decomposition that `write_archive` wrote.

    Raises:
        InputError: The file is missing, damaged, of another kind or of another format.
    """
    file = check_path("The file of a decomposition", path)
    if models is not None and not hasattr(type(models), "decoder"):
        raise InputError(f"decomposer is a Decomposer; got {models!r:.60}.")
    with open_arrays(file) as archive:
        try:
            content = ArrayFile(archive)
            _check_format(file, content.header)
            return _restore(content, models)
        except InputError:
            raise
        except DAMAGES as error:
            raise describe_damage(file, error) from error


def _check_format(path: Path, header: Mapping[str, Any]) -> None:
    if header["kind"] != _KIND:
        raise ValueError(f"it is of the kind {header['kind']!r:.40}")
    if header["format"] != _FORMAT:
        raise InputError(
            f"{path} has format {header['format']}, and this skinnet reads {_FORMAT}; read it with "
            f'the version that wrote it: pip install "skinnet=={header["version"]}".'
        )


def _restore(file: ArrayFile, models: ModelPair | None) -> dict[str, Any]:
    header = file.header
    height, width = (int(side) for side in header["shape"])
    if height < 1 or width < 1 or height * width > MAX_PIXELS:
        raise ValueError(f"it is of a photograph of {width} x {height} pixels")
    shape = height, width
    box = restore_box(header["box"], shape)
    source = _restore_source(header["source"], file, shape, models)
    return {
        **{name: header[name] for name in _PLAIN},
        **{name: tuple(str(each) for each in header[name]) for name in _TUPLES},
        **_paste_maps(file, box, source.picture.srgb),
        "box": box,
        "output_info": {name: _restore_info(*one) for name, one in header["output_info"].items()},
        "uncertainty": _restore_uncertainty(header["uncertainty"], file),
        "colour_space": _restore_space(header["colour_space"], "profile", file),
        "face_parts": restore_parts(header["face_parts"], file, shape),
        "skin_chromaticity": header["skin_chromaticity"] and (*header["skin_chromaticity"],),
        "_source": source,
    }


def _paste_maps(file: ArrayFile, box: Box, photo: NDArray[np.uint8]) -> dict[str, NDArray[Any]]:
    """Paste the maps of the box into those of the photograph's size."""
    size = box.height, box.width
    pasted: dict[str, NDArray[Any]] = {}
    for name in (*_MAPS, "offset"):
        channels = (3,) if name == "offset" else ()
        pasted[name] = np.zeros((*photo.shape[:2], *channels), np.float32)
        pasted[name][box.slices] = file.read(name, (*size, *channels), "float32")
    pasted["reconstruction"] = photo.copy()
    pasted["reconstruction"][box.slices] = file.read("reconstruction", (*size, 3), "uint8")
    return pasted


def _restore_info(unit: str, ends: list[float], description: str) -> OutputInfo:
    low, high = ends
    return OutputInfo(unit, (float(low), float(high)), description)


def _restore_uncertainty(record: Any, file: ArrayFile) -> Uncertainty:
    melanin, hemoglobin = (
        file.read(f"log_sd_{name}", (None, None), "float32") for name in PIGMENTS
    )
    if not melanin.size or melanin.shape != hemoglobin.shape:
        raise ValueError(f"the uncertainty is of {list(melanin.shape)} pixels")
    (face, other_face), (share, other_share) = record
    numbers = [float(each) for each in (face, other_face, share, other_share)]
    if not all(0 <= each < math.inf for each in numbers):
        raise ValueError(f"the uncertainty is {numbers}")
    return Uncertainty(melanin, hemoglobin, (face, other_face), (share, other_share))


def _record_source(source: EditSource, arrays: dict[str, NDArray[Any]]) -> dict[str, Any]:
    picture, square = source.picture, source.crop.square
    arrays["photo"] = picture.pixels
    if picture.alpha is not None:
        arrays["alpha"] = picture.alpha
    if source.landmarks is not None:
        arrays["landmarks"] = source.landmarks
    outputs = source.outputs or {}
    arrays |= {f"edit_{name}": values for name, values in outputs.items()}
    return {
        "name": picture.name,
        "alpha": picture.alpha is not None,
        "colour_space": _record_space(picture.colour_space, "photo_profile", arrays),
        "notes": list(picture.notes),
        "crop": list(source.crop.box),
        "square": None if square is None else list(square),
        "edit": source.outputs is not None,
        "landmarks": source.landmarks is not None,
        "pixels": [list(picture.pixels.shape), picture.pixels.dtype.name],
    }


def _restore_source(
    record: Any, file: ArrayFile, shape: tuple[int, int], models: ModelPair | None
) -> EditSource:
    stored, dtype = record["pixels"]
    if tuple(stored[:2]) != shape or stored[2:] not in ([], [3], [4]):
        raise ValueError(f"its photograph is of shape {stored}")
    if dtype not in ("uint8", "uint16"):
        raise ValueError(f"its photograph is of type {dtype}")
    picture = Picture(
        str(record["name"]),
        file.read("photo", tuple(stored), dtype),
        file.read("alpha", shape, dtype) if record["alpha"] else None,
        _restore_space(record["colour_space"], "photo_profile", file),
        notes=tuple(str(note) for note in record["notes"]),
    )
    square = None if record["square"] is None else TurnedSquare(*record["square"])
    crop = HeadCrop(restore_box(record["crop"], shape), square)
    outputs = _restore_outputs(file) if record["edit"] else None
    has_landmarks = record.get("landmarks", False)  # files of earlier versions have none
    landmarks = file.read("landmarks", (478, 2), "float32") if has_landmarks else None
    return EditSource(picture, crop, outputs, models, landmarks)


def _restore_outputs(file: ArrayFile) -> dict[str, NDArray[np.float32]]:
    """The encoder's maps, all of one size, and its capture."""
    size = file.types["edit_melanin"].shape[1:]
    outputs = {name: file.read(f"edit_{name}", (1, *size), "float32") for name in EDITED_MAPS}
    for name, axes in _CAPTURE.items():
        outputs[name] = file.read(f"edit_{name}", (1, *[None] * (axes - 1)), "float32")
    return outputs


def _record_space(
    space: ColourSpace, profile: str, arrays: dict[str, NDArray[Any]]
) -> dict[str, Any]:
    if space.profile is not None:
        arrays[profile] = np.frombuffer(space.profile, np.uint8)
    has_profile = space.profile is not None
    return {"name": space.name, "known_from": space.known_from, "profile": has_profile}


def _restore_space(record: Any, profile: str, file: ArrayFile) -> ColourSpace:
    content = file.read(profile, (None,), "uint8").tobytes() if record["profile"] else None
    return ColourSpace(str(record["name"]), str(record["known_from"]), content)
