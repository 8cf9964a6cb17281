"""Transparent skin is mixed with white before it is read, and a note says so."""

import numpy as np
import pytest
from skimage.data import astronaut

from skinnet import Decomposer
from skinnet.images import read_picture


@pytest.fixture(scope="module")
def decomposer() -> Decomposer:
    return Decomposer(threads=1)


def with_alpha(alpha: np.ndarray | int) -> np.ndarray:
    photo = astronaut()
    opacity = np.broadcast_to(alpha, photo.shape[:2]).astype(np.uint8)[..., None]
    return np.concatenate([photo, opacity], -1)


def ramp() -> np.ndarray:
    """A face whose left half fades out."""
    return np.clip(np.arange(512) * 255 // 240, 0, 255)[None]


def find_notes(notes: tuple[str, ...]) -> list[str]:
    """Those on transparency."""
    return [note for note in notes if "transparen" in note]


@pytest.mark.parametrize(("alpha", "share"), [(128, "100%"), (200, "100%"), (ramp(), "%")])
def test_transparent_skin_is_said(
    decomposer: Decomposer, alpha: np.ndarray | int, share: str
) -> None:
    picture = read_picture(with_alpha(alpha), "a")
    (note,) = find_notes(decomposer(picture, detail=False).notes)
    assert f"{share} of the skin in a is transparent and was mixed with white" in note
    assert note in decomposer.edit_picture(picture, melanin=2.0).notes


def test_a_cut_out_whose_skin_is_opaque_is_read_without_a_note(decomposer: Decomposer) -> None:
    background = np.full((512, 512), 0)
    background[30:330, 110:340] = 255
    found = decomposer(read_picture(with_alpha(background), "a"), detail=False)
    assert find_notes(found.notes) == []


def test_an_opaque_picture_has_no_note(decomposer: Decomposer) -> None:
    assert find_notes(decomposer(with_alpha(255), detail=False).notes) == []
