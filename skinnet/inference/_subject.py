"""What is read in a photograph: some of its faces, or bare skin."""

import math
from collections.abc import Sequence
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from skinnet.errors import InputError, NoFaceError
from skinnet.images._bare_skin import segment_bare_skin
from skinnet.images._colour_content import check_colour, refuse_grey
from skinnet.images.box import Box
from skinnet.images.faces.face import Face
from skinnet.images.faces.finder import find_faces
from skinnet.inference._face_checks import check_face
from skinnet.inference._face_choice import FaceChoice, check_choice, choose_faces, note_others
from skinnet.inference._head_crop import HeadCrop, crop_head, crop_patch
from skinnet.inference.decomposition import SKIN_THRESHOLD

Region = Literal["face", "skin"]
"""Faces, or whatever skin the photograph shows."""

_BARE_SKIN = (
    "The whole image was read, without a search for a face. The network learnt from faces: melanin "
    "of a bare patch of skin can be a third more or less than that of the same skin in its face, "
    "and dark skin less than half. "
    "What has the colours of skin, such as wood or a beige wall, is taken for skin."
)

_FACE, _NECK = 0.65, 1.2
"""Radius of a face, and distance from its middle to the end of the neck, in sides of its box."""


class Subject(NamedTuple):
    """A face that is read, or the whole photograph.

    Attributes:
        crop: The part of the photograph that is read.
        face: The face in it; None if none was looked for.
        face_id: Number of the face, from 1, from left to right among all faces of the photograph.
        faces: All faces of the photograph, from left to right; None if none was looked for.
        skin: Probability of skin in a photograph in which no face was looked for, float32 [H, W].
        notes: Sentences that the user should read.
    """

    crop: HeadCrop
    face: Face | None = None
    face_id: int | None = None
    faces: Sequence[Face] | None = None
    skin: NDArray[np.float32] | None = None
    notes: tuple[str, ...] = ()

    def describe(self, name: str) -> str:
        """Describe what is read in a photograph of a name, within a sentence."""
        if self.face is None:
            return f"skin in {name}"
        several = self.faces is not None and len(self.faces) > 1
        return f"face {self.face_id} in {name}" if several else f"the face in {name}"

    def keep_own_skin(self, mask: NDArray[np.float32]) -> NDArray[np.float32]:
        """Set a mask [h, w] to 0 where another face is nearer, measured in sides of each face."""
        others = [face for face in self.faces or () if face is not self.face]
        if self.face is None or not others:
            return mask
        distance = [_measure_distance(face, self.crop.box, mask.shape) for face in others]
        own = _measure_distance(self.face, self.crop.box, mask.shape) <= np.min(distance, 0)
        kept: NDArray[np.float32] = mask * own.astype(np.float32)
        return kept


def find_subjects(
    photo: NDArray[np.uint8], name: str, faces: FaceChoice | None, region: Region
) -> list[Subject]:
    """Find what is to be read in a photograph, from left to right.

    Args:
        photo: uint8 sRGB [H, W, 3].
        name: Its name in messages.
        faces: The faces that are asked for; None for the largest.
        region: "skin" to read the whole photograph, without a search for a face.

    Raises:
        InputError: An argument is none of those, the photograph has no colour, no face of those
            that are asked for can be read, or no skin was found.
        NoFaceError: No face was found.
    """
    choice = "largest" if faces is None else faces
    check_choice(choice)
    if not isinstance(region, str) or region not in ("face", "skin"):
        raise InputError(f"region is face or skin; got {region!r:.60}.")
    if region == "face":
        return _find_face_subjects(photo, name, choice)
    if choice != "largest":
        raise InputError(
            f"faces={choice!r} is asked for, but region='skin' looks for no face; leave out one."
        )
    return [_find_bare_skin(photo, name)]


def _find_bare_skin(photo: NDArray[np.uint8], name: str) -> Subject:
    box = Box(0, 0, photo.shape[1], photo.shape[0])
    check_colour(photo, box, None, name)
    skin = segment_bare_skin(photo)
    if not (skin > SKIN_THRESHOLD).any():
        raise InputError(
            f"No skin was found in {name}: too little of it has the colours of skin under usual "
            "light. Give a picture that skin fills, in daylight."
        )
    return Subject(crop_patch(photo.shape), skin=skin, notes=(_BARE_SKIN,))


def _find_face_subjects(photo: NDArray[np.uint8], name: str, faces: FaceChoice) -> list[Subject]:
    found = find_faces(photo)
    if not found:
        refuse_grey(photo, name)
        raise NoFaceError(
            f"No face was found in {name}. --region skin (in Python region='skin') reads skin "
            "without a face."
        )
    chosen = choose_faces(found, faces)
    subjects, refused = [], []
    for index in chosen:
        face = found[index]
        who = f"The face in {name}" if len(found) == 1 else f"Face {index + 1} in {name}"
        crop = crop_head(face, photo.shape)
        try:
            notes = check_face(photo, crop, face, who, name)
        except InputError as error:
            refused.append(error)
        else:
            subjects.append(Subject(crop, face, index + 1, found, notes=notes))
    if not subjects:
        raise refused[0]
    notes = (*note_others(len(found), len(chosen), name), *_note_refused(refused, len(chosen)))
    return [each._replace(notes=(*each.notes, *notes)) for each in subjects]


def _note_refused(refused: Sequence[InputError], count: int) -> tuple[str, ...]:
    """Note how many of the faces that were asked for are left out."""
    if not refused:
        return ()
    were = "was" if len(refused) == 1 else "were"
    return (f"{len(refused)} of {count} faces {were} left out. {refused[0]}",)


def _measure_distance(face: Face, box: Box, shape: tuple[int, ...]) -> NDArray[np.float64]:
    """Distances [h, w] of a grid's pixels over a box from a person, in sides of the face.

    They are those from the line between the middle of the face and the neck. Within a face, no
    other person's neck is nearer.
    """
    x = box.left + (np.arange(shape[1]) + 0.5) * box.width / shape[1]
    y = box.top + (np.arange(shape[0]) + 0.5) * box.height / shape[0]
    tilt, side = math.radians(face.tilt), face.box.width
    right = (x - (face.box.left + face.box.right) / 2) / side
    below = (y[:, None] - (face.box.top + face.box.bottom) / 2) / side
    across = right * math.cos(tilt) + below * math.sin(tilt)
    along = below * math.cos(tilt) - right * math.sin(tilt)
    within = np.hypot(across, along)
    to_line = np.hypot(across, along - along.clip(0, _NECK))
    distance: NDArray[np.float64] = np.where(within < _FACE, within - 1, to_line)
    return distance
