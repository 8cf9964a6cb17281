"""Finds all faces of a photograph."""

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from skinnet.images._arguments import check_photo
from skinnet.images.faces._detector import Detection, detect_faces
from skinnet.images.faces._face_mesh import find_landmarks
from skinnet.images.faces._face_place import place_face, to_box
from skinnet.images.faces._turned_square import TurnedSquare, measure_overlap
from skinnet.images.faces.face import Face

_LEAST_DETECTION, _LEAST_IN_PARTS = 0.4, 0.5
"""Least probability of a face for the detector, and in parts of a photograph, where patterns of
clothes look like small, unclear faces."""

_WEIGHT, _LEAST_EVIDENCE = 25.0, 25.0
"""Weight of the detector's probability beside the mesh's log odds, and the sum from which on
something is a face: the two together tell ties and lamps from half-hidden faces."""

_CLEAR = 35.0
"""Sum from which on the mesh is not read again."""

_MOVE = 60.0
"""Evidence that is lost if all landmarks move by a side of the face when the mesh is read again in
its own place; those of faces stay."""

_SURE = 13.8
"""Log odds of a face for the mesh from which on no other orientation is tried: bare faces that are
upright to it reach this, and one in forty of those that are upside down."""

_TURN_ODDS = 5.0
"""Log odds that another orientation must win; a half-hidden face is unclear in all of them."""

_TURNS = (math.pi, math.pi / 2, -math.pi / 2)
"""Other orientations, in radians: the detector takes faces that are upside down for upright."""

_MESH_MARGIN = 1.5
"""Side of the mesh's square in sides of the detector's, as MediaPipe has it."""

_VIEW_MARGIN = 2.5
"""Side of the view in which a detected face is looked for again, in its own sides."""

_SAME_FACE = 0.3
"""Overlap (intersection over union) of two finds of one face."""

_LARGE_PHOTO = 512
"""Longer side, in pixels, from which on parts are searched for small faces."""

_COARSE = 75
"""Longer side, in pixels, of a small photograph in which a noisy face is looked for."""

_FAR = 1.6
"""Side of a view from afar, for faces that fill the photograph, relative to the longer side."""

_PARTS = ((2, 0.6, 0.25), (3, 0.36, 0.1))
"""Numbers of parts in a row or column, their sides, and the side of the smallest face found below
which they are searched, relative to the longer side: people who are photographed together have
like sizes."""

_Mesh = tuple[NDArray[np.float32], float, float]
"""Landmarks, the mesh's log odds of a face, and the detector's probability."""

_Placed = tuple[TurnedSquare, Face]
"""A face with its square, which is turned as it is."""


def find_faces(photo: NDArray[np.uint8]) -> list[Face]:
    """Find all faces of a photograph, at every tilt and most poses.

    Args:
        photo: uint8 sRGB [H, W, 3].

    Returns:
        Faces from left to right. Of a large photograph, faces whose box is a fortieth of the longer
        side are found.

    Raises:
        InputError: The photograph has another shape or type.

    Source:
        BlazeFace (Bazarevsky et al. 2019) finds places, and Attention Mesh (Grishchenko et al.
        2020) confirms them and gives landmarks; both in MediaPipe's version.

    Example:
        >>> from skimage.data import astronaut
        >>> from skinnet.images import find_faces
        >>> find_faces(astronaut())
        [<Face Box(left=170, top=59, right=279, bottom=168), tilt 3 degrees, score 1.00>]
    """
    check_photo(photo)
    found: list[_Placed] = []
    _search_whole(photo, found)
    _search_parts(photo, found)
    if not found and max(photo.shape[:2]) < _LARGE_PHOTO:
        _search_whole(_smooth(photo), found)
    return sorted((face for _, face in found), key=lambda face: face.box.left + face.box.right)


def _search_whole(photo: NDArray[np.uint8], found: list[_Placed]) -> None:
    """Add the faces of the whole photograph; from afar only if none is seen otherwise."""
    _search(photo, _frame(photo.shape), _LEAST_DETECTION, found)
    if not found:
        _search(photo, _frame(photo.shape, _FAR), _LEAST_DETECTION, found)


def _search(
    photo: NDArray[np.uint8], view: TurnedSquare, least_score: float, found: list[_Placed]
) -> None:
    """Add the faces of a view that are not among those found."""
    for detection in detect_faces(photo, view, least_score):
        if not _is_known(detection.square, found):
            placed = _confirm(photo, detection)
            if placed is not None and not _is_known(placed[0], found):
                found.append(placed)


def _is_known(square: TurnedSquare, found: list[_Placed]) -> bool:
    return any(measure_overlap(square, other) > _SAME_FACE for other, _ in found)


def _search_parts(photo: NDArray[np.uint8], found: list[_Placed]) -> None:
    """Search parts of a large photograph, and smaller ones if there may be smaller faces."""
    longer = max(photo.shape[:2])
    for count, part, largest in _PARTS:
        smallest = min((square.side for square, _ in found), default=0.0)
        if longer < _LARGE_PHOTO or smallest > largest * longer:
            return
        for view in _list_parts(photo.shape, count, part * longer):
            _search(photo, view, _LEAST_IN_PARTS, found)


def _list_parts(shape: tuple[int, ...], count: int, side: float) -> Iterator[TurnedSquare]:
    """Squares that cover a photograph, at most `count` in a row or column."""
    rows, columns = (
        np.unique(np.linspace(side / 2, max(side / 2, length - side / 2), count))
        for length in shape[:2]
    )
    for y in rows:
        yield from (TurnedSquare(float(x), float(y), side) for x in columns)


def _frame(shape: tuple[int, ...], margin: float = 1.0) -> TurnedSquare:
    """A square around the whole photograph."""
    height, width = shape[:2]
    return TurnedSquare(width / 2, height / 2, margin * max(width, height))


def _smooth(photo: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Average over small squares; strong noise hides faces from the networks."""
    image = Image.fromarray(photo)
    smooth = image.reduce(max(2, round(max(image.size) / _COARSE)))
    return np.array(smooth.resize(image.size, Image.Resampling.BILINEAR))


def _confirm(photo: NDArray[np.uint8], detection: Detection) -> _Placed | None:
    """The face of a detection, with its square; None if the two networks together see none."""
    landmarks, odds, probability = _choose_turn(photo, detection)
    place = place_face(landmarks)
    evidence = odds + _WEIGHT * probability
    if evidence < _CLEAR:
        again, odds_again = _read_square(photo, place)
        moved = float(np.linalg.norm(again - landmarks, axis=1).mean()) / place.side
        evidence += (odds_again - odds) / 2 - _MOVE * moved
    if evidence < _LEAST_EVIDENCE:
        return None
    score = 1 / (1 + math.exp(_LEAST_EVIDENCE - evidence))
    return place, Face(to_box(place), math.degrees(place.tilt), score, landmarks)


def _choose_turn(photo: NDArray[np.uint8], detection: Detection) -> _Mesh:
    """Landmarks and odds in the orientation in which the face is clearest."""
    mesh = _read_mesh(photo, detection)
    if mesh[1] >= _SURE:
        return mesh
    turned = [each for turn in _TURNS if (each := _turn(photo, detection, turn)) is not None]
    others = [_read_mesh(photo, each) for each in turned]
    best = max([mesh, *others], key=lambda each: each[1])
    return best if best[1] > mesh[1] + _TURN_ODDS else mesh


def _read_mesh(photo: NDArray[np.uint8], detection: Detection) -> _Mesh:
    return *_read_square(photo, detection.square), detection.score


def _read_square(
    photo: NDArray[np.uint8], square: TurnedSquare
) -> tuple[NDArray[np.float32], float]:
    return find_landmarks(photo, square._replace(side=_MESH_MARGIN * square.side))


def _turn(photo: NDArray[np.uint8], detection: Detection, turn: float) -> Detection | None:
    """Detect a face again in a view that is turned; None if it is not seen there."""
    square = detection.square
    view = square._replace(side=_VIEW_MARGIN * square.side, tilt=square.tilt + turn)
    again = detect_faces(photo, view, _LEAST_DETECTION)
    here = [each for each in again if measure_overlap(each.square, square) > _SAME_FACE]
    return max(here, key=lambda each: each.score, default=None)
