"""A face followed from frame to frame by its landmarks."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from skinnet.errors import InputError, NoFaceError
from skinnet.images.faces._face_mesh import MESH_POINTS, find_landmarks
from skinnet.images.faces._face_place import place_face
from skinnet.images.faces._turned_square import TurnedSquare
from skinnet.images.faces.face import Face
from skinnet.images.faces.finder import find_faces
from skinnet.images.resizing import resize
from skinnet.inference._face_choice import choose_faces

FaceChoice = int | str | None
"""The number of a face from left to right, "largest", or None if there is to be only one."""

_LEAST_ODDS = 0.0
"""Log odds of the mesh from which on a face is still there."""

_SEARCH = 0.25
"""Seconds between two searches for a face that is lost."""

_MARGIN = 1.5
_SMOOTH = 0.15
"""Seconds over which the bending of the mesh is smoothed; an affine movement is not."""

_CUT, _THUMBNAIL = 0.35, (32, 18)
"""Change of a small picture, relative to its contrast, from which on it is another scene."""


class Followed(NamedTuple):
    """A face in a frame.

    Attributes:
        landmarks: Columns and rows [478, 2]; None if the face is lost.
        is_cut: Whether the frame begins another scene.
        bend: Root mean square of what an affine map leaves of the movement since the first frame,
            in sides of the face.
    """

    landmarks: NDArray[np.float32] | None
    is_cut: bool
    bend: float = 0.0


class FaceFollower:
    """Finds a face, and follows it.

    Args:
        choice: Which face, where there are several.
    """

    def __init__(self, choice: FaceChoice = None) -> None:
        self._choice = choice
        self._landmarks: NDArray[np.float32] | None = None
        self._rest: NDArray[np.float64] | None = None
        self._bent: NDArray[np.float64] | None = None
        self._thumbnail: NDArray[np.float64] | None = None
        self._time, self._searched = -np.inf, -np.inf
        self._place: TurnedSquare | None = None

    def follow(self, frame: NDArray[np.uint8], time: float) -> Followed:
        """Find the face in the next frame [H, W, 3], at a time in seconds."""
        is_cut = self._notice_cut(frame)
        if is_cut:
            self._landmarks, self._rest, self._searched = None, None, -np.inf
        if self._landmarks is not None:
            square = place_face(self._landmarks)
            landmarks, odds = find_landmarks(frame, square._replace(side=_MARGIN * square.side))
            self._landmarks = landmarks if odds > _LEAST_ODDS else None
            self._place = place_face(landmarks) if odds > _LEAST_ODDS else self._place
        if self._landmarks is None and time - self._searched >= _SEARCH:
            self._searched, self._bent = time, None
            self._landmarks = self._search(frame)
        if self._landmarks is None:
            return Followed(None, is_cut)
        smooth, bend = self._smooth(self._landmarks.astype(np.float64), time)
        return Followed(smooth.astype(np.float32), is_cut, bend)

    def _search(self, frame: NDArray[np.uint8]) -> NDArray[np.float32] | None:
        faces = find_faces(frame)
        if not faces:
            return None
        if self._place is None:
            face = choose_face(faces, self._choice)
        else:  # numbers of faces change when one is hidden
            face = min(faces, key=lambda each: _measure_distance(each, self._place))
        self._place = place_face(face.landmarks)
        return face.landmarks

    def _smooth(
        self, points: NDArray[np.float64], time: float
    ) -> tuple[NDArray[np.float64], float]:
        """Smooth what bends over time, and leave what moves, turns and stretches."""
        if self._rest is None:
            self._rest = points
        affine = _fit_affine(self._rest, points)
        bent = points - affine
        if self._bent is None:
            self._bent = bent
        share = 1 - np.exp(-max(time - self._time, 0.0) / _SMOOTH)
        self._bent = self._bent + share * (bent - self._bent)
        self._time = time
        side = place_face(points.astype(np.float32)).side
        bend = float(np.sqrt((self._bent[:MESH_POINTS] ** 2).sum(1).mean())) / side
        return affine + self._bent, bend

    def _notice_cut(self, frame: NDArray[np.uint8]) -> bool:
        """Whether the whole picture has changed, its brightness aside."""
        step = max(1, frame.shape[1] // (4 * _THUMBNAIL[0]))
        small = resize(np.ascontiguousarray(frame[::step, ::step]), *_THUMBNAIL).astype(np.float64)
        grey = small.mean(-1)
        now = (grey - grey.mean()) / max(float(grey.std()), 2.0)
        before, self._thumbnail = self._thumbnail, now
        return before is not None and float(((now - before) ** 2).mean()) / 2 > _CUT


def _measure_distance(face: Face, place: TurnedSquare | None) -> float:
    assert place is not None
    other = place_face(face.landmarks)
    return abs(complex(other.x - place.x, other.y - place.y)) + abs(other.side - place.side)


def choose_face(faces: list[Face], choice: FaceChoice) -> Face:
    """Choose one of the faces of a frame.

    Raises:
        InputError: There are several, and none is chosen; or there are fewer than its number.
    """
    if choice is None and len(faces) > 1:
        places = ", ".join(
            f"{number} at {round((face.box.left + face.box.right) / 2)},"
            f"{round((face.box.top + face.box.bottom) / 2)}"
            for number, face in enumerate(faces, 1)
        )
        raise InputError(
            f"The video shows {len(faces)} faces, from left to right {places} (column,row of the "
            "picture). Which one is meant? Give --face with its number, or --face largest "
            "(in Python Tracker(face=...))."
        )
    if isinstance(choice, int):
        if not 1 <= choice <= len(faces):
            raise NoFaceError(
                f"Face {choice} is asked for, and the video shows {len(faces)}; numbers are from 1."
            )
        return faces[choice - 1]
    return faces[choose_faces(faces, "largest")[0]]


def _fit_affine(source: NDArray[np.float64], target: NDArray[np.float64]) -> NDArray[np.float64]:
    """The source's points under the affine map that takes them next to the target's."""
    ones = np.ones((len(source), 1))
    known = np.concatenate([source, ones], 1)
    matrix, *_ = np.linalg.lstsq(known[:MESH_POINTS], target[:MESH_POINTS], rcond=None)
    return np.asarray(known @ matrix)
