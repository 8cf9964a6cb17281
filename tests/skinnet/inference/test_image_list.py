"""One image of any kind, or many of them in a list, a generator or a batch."""

import io
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch
from PIL import Image

from skinnet import Decomposer, Decomposition
from skinnet.errors import InputError, NoFaceError
from skinnet.images import read_picture, srgb_to_linear
from skinnet.inference import Capture, compare_photographs


def encode(photo: np.ndarray) -> bytes:
    buffer = io.BytesIO()
    Image.fromarray(photo).save(buffer, "PNG")
    return buffer.getvalue()


def to_tensor(photo: np.ndarray) -> torch.Tensor:
    return torch.tensor(photo).permute(2, 0, 1)


KINDS: dict[str, Callable[[np.ndarray], Any]] = {
    "image": Image.fromarray,
    "bytes": encode,
    "file": lambda photo: io.BytesIO(encode(photo)),
    "uint16": lambda photo: photo.astype(np.uint16) * 257,
    "float64": lambda photo: photo / 255,
    "float32": lambda photo: (photo / 255).astype(np.float32),
    "tensor": to_tensor,
    "float tensor": lambda photo: to_tensor(photo) / 255,
    "picture": read_picture,
    "linear": lambda photo: read_picture(srgb_to_linear(photo), colour_space="linear sRGB"),
}


@pytest.mark.parametrize("kind", KINDS)
def test_every_kind_reads_exactly_as_the_file(
    decomposer: Decomposer, decomposition: Decomposition, astronaut: np.ndarray, kind: str
) -> None:
    read = decomposer(KINDS[kind](astronaut))
    for name, values in decomposition.maps().items():
        np.testing.assert_array_equal(read.get_map(name), values)
    if kind not in ("image", "bytes", "file", "tensor", "picture"):
        return  # the edit of 16 bits is rounded once, to 8 bits
    edited = decomposer.edit(KINDS[kind](astronaut), 2.0)
    np.testing.assert_array_equal(edited, decomposition.edit(2.0))


@pytest.mark.parametrize("kind", ["uint16", "float32", "float tensor", "linear"])
def test_edits_of_deep_arrays_are_those_of_the_file_to_a_level(
    decomposer: Decomposer, decomposition: Decomposition, astronaut: np.ndarray, kind: str
) -> None:
    edited = decomposer.edit(KINDS[kind](astronaut), 2.0).astype(int)
    assert np.abs(edited - decomposition.edit(2.0)).max() <= 1


def test_noise_below_eight_bits_hardly_changes_the_reading(
    decomposition: Decomposition, decomposer: Decomposer, astronaut: np.ndarray
) -> None:
    noise = np.random.default_rng(0).uniform(-0.49, 0.49, astronaut.shape)
    read = decomposer(((astronaut + noise) / 255).clip(0, 1))
    np.testing.assert_array_equal(read.melanin, decomposition.melanin)
    rough = decomposer((to_tensor(astronaut) / 255).bfloat16())  # 8 bits of mantissa
    for name, mean in decomposition.means.items():
        assert rough.means[name] == pytest.approx(mean, rel=0.02)


def test_many_give_a_list_in_order(decomposer: Decomposer, astronaut: np.ndarray) -> None:
    both = [astronaut, astronaut[:, ::-1]]
    expected = [decomposer(each, detail=False).means for each in both]
    batch = np.stack(both)
    tensor = torch.tensor(batch).permute(0, 3, 1, 2)
    for many in (both, tuple(both), iter(both), (each for each in both), batch, tensor):
        read = decomposer(many, detail=False)
        assert [each.means for each in read] == expected
    assert decomposer([]) == []
    nested = decomposer(both, detail=False, faces="all")
    assert [[each.face_id for each in faces] for faces in nested] == [[1], [1]]


def test_many_are_edited_in_order(decomposer: Decomposer, astronaut: np.ndarray) -> None:
    both = [astronaut, astronaut[:, ::-1]]
    for one, edited in zip(both, decomposer.edit(both, 2.0), strict=True):
        np.testing.assert_array_equal(edited, decomposer.edit(one, 2.0))
    with pytest.raises(InputError, match="A mask belongs to one image"):
        decomposer.edit(both, 2.0, mask=np.ones(astronaut.shape[:2], bool))
    with pytest.raises(InputError, match=r"images\[1\]\. "):
        decomposer.edit([astronaut, astronaut[:40, :40]], 2.0)


def test_what_fails_is_named(decomposer: Decomposer, astronaut: np.ndarray, tmp_path: Path) -> None:
    with pytest.raises(NoFaceError, match=r"No face was found in images\[1\]\."):
        decomposer([astronaut, astronaut[:40, :40]], detail=False)
    with pytest.raises(NoFaceError, match=r"No face was found in day\[0\]\."):
        decomposer([astronaut[:40, :40]], name="day")
    with pytest.raises(InputError, match=r"^images\[0\]: A photograph is uint8.* got int64"):
        decomposer([astronaut.astype(np.int64)])
    with pytest.raises(InputError, match=r"There is no file .*a\.png"):
        decomposer([tmp_path / "a.png"])
    with pytest.raises(InputError, match=r"images\[0\] is several images itself, a ndarray"):
        decomposer([astronaut[None]])


def test_a_stream_goes_on_after_errors(decomposer: Decomposer, astronaut: np.ndarray) -> None:
    photos = (photo for photo in (astronaut, astronaut[:40, :40], astronaut[None], astronaut))
    first, second, third, last = decomposer.stream(photos, detail=False, errors="return")
    assert isinstance(first, Decomposition) and isinstance(last, Decomposition)
    assert first.means == last.means
    assert isinstance(second, NoFaceError) and "images[1]" in str(second)
    assert isinstance(third, InputError) and "images[2] is several images" in str(third)
    for error in (second, third):  # frames would keep the photographs in memory
        assert error.__traceback__ is error.__cause__ is error.__context__ is None
    with pytest.raises(NoFaceError):
        list(decomposer.stream([astronaut[:40, :40]]))


def test_a_stream_reads_when_it_is_asked(decomposer: Decomposer, astronaut: np.ndarray) -> None:
    def fail() -> Any:
        yield astronaut
        raise AssertionError("the second photograph was fetched too early")

    assert next(decomposer.stream(fail(), detail=False)).means
    with pytest.raises(InputError, match="stream takes many images, such as a list; got a ndarray"):
        decomposer.stream(astronaut)
    with pytest.raises(InputError, match="stream takes many images, such as a list; got a str"):
        decomposer.stream("a.jpg")


@pytest.mark.parametrize("many", [{"a": 1}, {"a.jpg"}, frozenset(), {}.keys()])
def test_what_has_no_order_is_refused(decomposer: Decomposer, many: Any) -> None:
    with pytest.raises(InputError, match="Images are given as a list, whose order is that of"):
        decomposer(many)


def test_other_verbs_take_every_kind(astronaut: np.ndarray) -> None:
    decomposer = Decomposer(threads=1)
    compared = compare_photographs(encode(astronaut), to_tensor(astronaut), decomposer=decomposer)
    assert compared.face.unchanged
    assert compared.names == ("the first photograph", "the second photograph")
    box = (300, 20, 320, 40)
    expected = Capture.from_reference(astronaut, box)
    assert Capture.from_reference(to_tensor(astronaut), box) == expected
    assert Capture.from_reference(encode(astronaut), box) == expected
