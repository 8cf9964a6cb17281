"""Maps of a face at rest: melanin, hemoglobin and gloss, pooled from several frames of a shot."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from skinnet.errors import InputError
from skinnet.images.box import Box
from skinnet.images.faces.face import Face
from skinnet.images.photograph import read_picture
from skinnet.inference._capture_inputs import join_captures
from skinnet.inference._face_checks import check_face
from skinnet.inference._head_crop import crop_head
from skinnet.inference._references.profile_use import apply_profile
from skinnet.inference._subject import Subject
from skinnet.inference._uncertainty import PIGMENTS
from skinnet.inference.decomposer import Decomposer
from skinnet.inference.onnx_model import CAPTURE_NAMES
from skinnet.video._texture_space import Points, TextureSpace, sample

_MAPS = ("melanin", "hemoglobin", "shading", "specular", "mask", "melanin_sd", "hemoglobin_sd")

_MOST_GLOSS = 0.5
_LEAST = 1e-4

Captures = dict[str, NDArray[np.float32]]


class Look(NamedTuple):
    """What is read of one frame.

    Attributes:
        maps: Maps of the covered texels by name, [texels] each.
        capture: Light and camera, as the decoder takes them, [1, ...].
        face_sd: Standard deviations of the logarithms of the face's mean melanin and hemoglobin.
        notes: Sentences that the user should read.
    """

    maps: dict[str, NDArray[np.float32]]
    capture: Captures
    face_sd: NDArray[np.float64]
    notes: tuple[str, ...]


class RestingMaps(NamedTuple):
    """A face at rest.

    Attributes:
        melanin: Volume fraction of each covered texel, [texels].
        hemoglobin: The same.
        gloss: Specular reflection over shading, [texels].
        shading: Diffuse shading, [texels].
        skin: Which texels are skin, [texels].
        capture: Light and camera, as the decoder takes them.
        pixel_sd: Standard deviations of the logarithms of both pigments, [2, texels].
        face_sd: The same of the face's means, [2].
        looks: Number of frames.
    """

    melanin: NDArray[np.float32]
    hemoglobin: NDArray[np.float32]
    gloss: NDArray[np.float32]
    shading: NDArray[np.float32]
    skin: NDArray[np.bool_]
    capture: Captures
    pixel_sd: NDArray[np.float32]
    face_sd: NDArray[np.float64]
    looks: int


def read_look(
    decomposer: Decomposer,
    frame: NDArray[np.uint8],
    face: Face,
    space: TextureSpace,
    name: str,
    capture: object | None = None,
) -> Look:
    """Read a frame [H, W, 3] with the network, in a texture space.

    Raises:
        InputError: The face cannot be read: it is too small, drawn, or has no colour.
    """
    applied = apply_profile(read_picture(frame, name), capture)
    known, notes = join_captures(applied.picture, applied.capture, decomposer.encoder)
    crop = crop_head(face, frame.shape)
    checked = check_face(frame, crop, face, "The face in the video", name)
    subject = Subject(crop, face, 1, [face], notes=checked)
    outputs, _ = decomposer._read(applied.picture.srgb, subject, known)
    stacked = np.stack([outputs[each][0] for each in _MAPS], -1)
    maps = sample(stacked, _place_in_box(space, face.landmarks, crop.box, stacked.shape))
    named = dict(zip(_MAPS, np.ascontiguousarray(maps.T), strict=True))
    told = {each: outputs[each] for each in CAPTURE_NAMES}
    doubts = (*applied.picture.notes, *notes, *checked)
    return Look(named, told, outputs["face_sd"][0].astype(np.float64), doubts)


def _place_in_box(
    space: TextureSpace, landmarks: Points, box: Box, shape: tuple[int, ...]
) -> NDArray[np.float32]:
    """Places of the texels in maps of a shape [h, w, ...] over a box of the frame."""
    scale = np.array([shape[1] / box.width, shape[0] / box.height])
    placed: NDArray[np.float32] = ((space.place(landmarks) - (box.left, box.top)) * scale).astype(
        np.float32
    )
    return placed


def pool_looks(looks: list[Look]) -> RestingMaps:
    """Pool looks of one shot by their medians, so that a bad one does no harm.

    Args:
        looks: One or more.

    Raises:
        InputError: No look shows skin.
    """
    maps = {name: np.stack([look.maps[name] for look in looks]) for name in _MAPS}
    skin = np.median(maps["mask"], 0) > 0.5
    if not skin.any():
        raise InputError(
            "No skin was found in the face of the video; give a video that shows it uncovered."
        )
    gloss = maps["specular"] / np.maximum(maps["shading"], 0.02)
    return RestingMaps(
        _pool_fractions(maps["melanin"]),
        _pool_fractions(maps["hemoglobin"]),
        np.median(np.clip(gloss, 0, _MOST_GLOSS), 0).astype(np.float32),
        np.maximum(np.median(maps["shading"], 0), 0.02).astype(np.float32),
        skin,
        _pool_captures([look.capture for look in looks]),
        np.stack([np.median(maps[f"{name}_sd"], 0) for name in PIGMENTS]),
        np.median([look.face_sd for look in looks], 0),
        len(looks),
    )


def _pool_fractions(looks: NDArray[np.float32]) -> NDArray[np.float32]:
    """Median of logarithms [looks, texels]."""
    logs = np.log(np.maximum(looks, _LEAST))
    return np.asarray(np.exp(np.median(logs, 0)), np.float32)


def _pool_captures(captures: list[Captures]) -> Captures:
    pooled = {
        name: np.median([each[name] for each in captures], 0).astype(np.float32)
        for name in captures[0]
    }
    total = max(float(pooled["light"].sum()), 1e-6)
    return pooled | {"light": pooled["light"] / np.float32(total)}
