"""A turned photograph is read as the upright one, and its maps lie where its pixels do."""

import math
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from skimage.data import astronaut

from skinnet import Decomposer, Decomposition
from skinnet.images import read_photo, resize

FACES = Path("../shared/data/faces")
TURNS = (15, 30, 45, 90, 180)


@pytest.fixture(scope="module")
def decomposer() -> Decomposer:
    return Decomposer(threads=1)


def turn(photo: np.ndarray, degrees: int) -> np.ndarray:
    """Turn a photograph clockwise; it goes on as its mirror image, and becomes larger."""
    angle, (height, width) = math.radians(degrees), photo.shape[:2]
    cos, sin = abs(math.cos(angle)), abs(math.sin(angle))
    size = width * cos + height * sin, height * cos + width * sin
    margin = max(width, height) // 2
    around = np.pad(photo, ((margin, margin), (margin, margin), (0, 0)), "symmetric")
    image = Image.fromarray(around).rotate(-degrees, Image.Resampling.BICUBIC)
    x, y = ((whole - part) / 2 for whole, part in zip(image.size, size, strict=True))
    return np.array(image.crop((round(x), round(y), round(x + size[0]), round(y + size[1]))))


def turn_back(values: np.ndarray, degrees: int, shape: tuple[int, ...]) -> np.ndarray:
    image = Image.fromarray(values).rotate(degrees, Image.Resampling.BILINEAR, expand=True)
    x, y = (round((image.size[k] - shape[1 - k]) / 2) for k in (0, 1))
    return np.array(image.crop((x, y, x + shape[1], y + shape[0])))


def compare(one: Decomposition, other: Decomposition) -> tuple[float, float]:
    """How much more melanin and hemoglobin the other has, as shares."""
    means = [
        [getattr(each, name)[each.mask > 0.5].mean() for name in ("melanin", "hemoglobin")]
        for each in (one, other)
    ]
    return means[1][0] / means[0][0] - 1, means[1][1] / means[0][1] - 1


@pytest.mark.parametrize("degrees", TURNS)
def test_the_astronaut_is_read_at_every_tilt(decomposer: Decomposer, degrees: int) -> None:
    photo = np.ascontiguousarray(astronaut()[:256, 96:352])
    upright, turned = (decomposer(each, detail=False) for each in (photo, turn(photo, degrees)))
    assert np.abs(compare(upright, turned)).max() < 0.1
    mask, melanin = (
        turn_back(getattr(turned, name), degrees, photo.shape) for name in ("mask", "melanin")
    )
    both = (mask > 0.5) & (upright.mask > 0.5)
    assert both.sum() > 0.88 * ((mask > 0.5) | (upright.mask > 0.5)).sum()
    assert np.corrcoef(melanin[both], upright.melanin[both])[0, 1] > 0.93


@pytest.mark.parametrize("degrees", [30, 90])
def test_the_astronaut_is_edited_at_every_tilt(decomposer: Decomposer, degrees: int) -> None:
    photo = np.ascontiguousarray(astronaut()[:256, 96:352])
    turned = turn(photo, degrees)
    changes = [
        decomposer.edit(each, melanin=2.5).astype(np.float32).mean(-1)
        - each.astype(np.float32).mean(-1)
        for each in (photo, turned)
    ]
    back = turn_back(changes[1], degrees, photo.shape)
    assert np.corrcoef(back.ravel(), changes[0].ravel())[0, 1] > 0.93
    assert back.min() < -35


@pytest.mark.slow
@pytest.mark.skipif(not FACES.is_dir(), reason="needs ../shared/data/faces")
@pytest.mark.parametrize("degrees", TURNS)
def test_portraits_are_read_at_every_tilt(decomposer: Decomposer, degrees: int) -> None:
    paths = sorted(FACES.glob("london/*.jpg"))[::16] + sorted(FACES.glob("congress/*.jpg"))[::150]
    differences = []
    for path in paths:
        photo, upright = read_upright(decomposer, path)
        turned = decomposer(turn(photo, degrees), detail=False)
        differences.append(np.abs(compare(upright, turned)))
    assert np.median(differences, 0).max() < 0.07


@cache
def read_upright(decomposer: Decomposer, path: Path) -> tuple[np.ndarray, Decomposition]:
    """A portrait of at most 700 pixels as it is, which each tilt is compared with."""
    photo = read_photo(path)
    if max(photo.shape) > 700:
        photo = resize(photo, 675, 675)
    return photo, decomposer(photo, detail=False)


@pytest.mark.parametrize("left", [190, 205, 220])
def test_a_face_cut_by_the_edge_is_read_as_the_whole_one(decomposer: Decomposer, left: int) -> None:
    whole = decomposer(astronaut(), detail=False)
    part = decomposer(np.ascontiguousarray(astronaut()[:, left:]), detail=False)
    both = (whole.mask[:, left:] > 0.5) & (part.mask > 0.5)
    assert np.count_nonzero(both) > 0.9 * np.count_nonzero(whole.mask[:, left:] > 0.5)
    for name in ("melanin", "hemoglobin"):
        ratio = getattr(part, name)[both] / getattr(whole, name)[:, left:][both]
        assert abs(np.median(ratio) - 1) < 0.25 and np.percentile(ratio, 95) < 1.5
    assert any("inside the picture" in note for note in part.notes)


def test_nothing_is_read_outside_the_turned_square(decomposer: Decomposer) -> None:
    turned = np.array(Image.fromarray(astronaut()).rotate(-45, Image.Resampling.BICUBIC))
    read = decomposer(turned)
    corner = read.box.slices[0].start, read.box.slices[1].start
    assert read.offset[corner].tolist() == [0, 0, 0] and read.shading[corner] == 0
    assert read.reconstruction[corner].tolist() == turned[corner].tolist()
    upright = decomposer(astronaut())
    assert read.skin_share == pytest.approx(upright.skin_share, rel=0.15)
    assert read.tilt is not None and abs(read.tilt - 45) < 8
