import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from skinnet import Decomposer, Decomposition
from skinnet.errors import InputError, NoFaceError
from skinnet.images import Box, Picture, srgb_to_linear
from skinnet.inference import open_model

SaveModel = Callable[..., Path]


def test_maps_have_the_size_of_the_photograph(decomposition: Decomposition) -> None:
    outside = np.ones((512, 512), bool)
    outside[decomposition.box.slices] = False
    assert outside.any()
    for name, values in decomposition.maps().items():
        assert values.shape == (512, 512) and values.dtype == np.float32, name
        assert not values[outside].any(), name
    assert decomposition.offset.shape == (512, 512, 3)


def test_maps_are_the_networks(decomposer: Decomposer, astronaut: np.ndarray) -> None:
    decomposition = decomposer(astronaut, detail=False)
    grey = astronaut[decomposition.box.slices].mean(-1) / 255
    hemoglobin = decomposition.hemoglobin[decomposition.box.slices]
    assert np.abs(hemoglobin - 0.2 * grey).mean() < 0.01
    np.testing.assert_allclose(
        decomposition.melanin[decomposition.box.slices], 0.2 - hemoglobin, atol=1e-6
    )


def test_light_and_camera_are_named(decomposition: Decomposition) -> None:
    assert decomposition.light == {"D": 0.75, "A": 0.25, "temperature_k": 6504.0}
    assert decomposition.camera["components"] == [0.5, -0.5, 0.0]
    balance = decomposition.camera["white_balance"]
    assert balance == pytest.approx({"r_over_g": 1.02, "b_over_g": 0.97})


def test_the_reconstruction_is_the_photograph_outside_the_box(
    decomposition: Decomposition, astronaut: np.ndarray
) -> None:
    changed = (decomposition.reconstruction != astronaut).any(-1)
    assert changed[decomposition.box.slices].mean() > 0.9
    changed[decomposition.box.slices] = False
    assert not changed.any()


def test_paths_images_and_arrays_give_the_same(
    decomposer: Decomposer, decomposition: Decomposition, astronaut: np.ndarray, tmp_path: Path
) -> None:
    path = tmp_path / "a.png"
    Image.fromarray(astronaut).save(path)
    for image in (path, str(path), Image.fromarray(astronaut), astronaut / 255):
        np.testing.assert_array_equal(decomposer(image).melanin, decomposition.melanin)


def test_without_a_face_nothing_is_guessed(decomposer: Decomposer, tmp_path: Path) -> None:
    wall = np.full((90, 120, 3), (220, 180, 160), np.uint8)
    Image.fromarray(wall).save(tmp_path / "wall.png")
    with pytest.raises(NoFaceError, match=r"wall\.png\. .*--region skin .*region='skin'"):
        decomposer(tmp_path / "wall.png")
    with pytest.raises(NoFaceError, match="No face was found in the image"):
        decomposer.edit(wall, 2.0)
    read = decomposer(wall, whole_image=True)
    assert read.box == Box(0, 0, 120, 90)
    assert "bare patch of skin" in read.notes[-1]


@pytest.mark.parametrize("shape", [(9, 300), (37, 53), (200, 90)])
def test_skin_of_any_size_is_decomposed(decomposer: Decomposer, shape: tuple[int, int]) -> None:
    noise = np.random.default_rng(0).integers(0, 9, (*shape, 3), np.uint8)
    photo = np.array((200, 150, 130), np.uint8) + noise
    decomposition = decomposer(photo, region="skin")
    assert decomposition.melanin.shape == shape
    assert decomposition.reconstruction.shape == photo.shape
    assert decomposition.face_id is None and decomposition.faces_found is None
    assert decomposer.edit(photo, 2.0, 0.5, region="skin").shape == photo.shape


@pytest.mark.parametrize("shape", [(1, 1), (1, 300), (60, 60)])
def test_without_skin_nothing_is_guessed(decomposer: Decomposer, shape: tuple[int, int]) -> None:
    photo = np.random.default_rng(0).integers(0, 255, (*shape, 3), np.uint8)
    with pytest.raises(InputError, match="No skin was found in the image"):
        decomposer(photo, region="skin")
    with pytest.raises(InputError, match="No skin was found in the image"):
        decomposer.edit(photo, 2.0, region="skin")


def test_both_words_for_skin_give_the_same(decomposer: Decomposer, astronaut: np.ndarray) -> None:
    cheek = astronaut[110:150, 235:260]
    whole, skin = decomposer(cheek, whole_image=True), decomposer(cheek, region="skin")
    np.testing.assert_array_equal(whole.melanin, skin.melanin)
    assert (skin.mask > 0.5).mean() > 0.9
    with pytest.raises(InputError, match="faces='all' is asked for, but region='skin' looks for"):
        decomposer(cheek, region="skin", faces="all")


def test_several_faces_are_read_from_left_to_right(
    decomposer: Decomposer, astronaut: np.ndarray
) -> None:
    half = astronaut[:256, 96:352]
    small = np.array(Image.fromarray(half).resize((160, 160)))
    scene = np.full((256, 416, 3), 90, np.uint8)
    scene[:, :256], scene[48:208, 256:] = half, small[:, ::-1]
    left, right = decomposer(scene, faces="all")
    assert [(each.face_id, each.faces_found) for each in (left, right)] == [(1, 2), (2, 2)]
    assert left.summary()["id"] == 1 and left.summary()["faces_found"] == 2
    assert not ((left.mask > 0.5) & (right.mask > 0.5)).any()
    largest = decomposer(scene)
    np.testing.assert_array_equal(largest.melanin, left.melanin)
    assert largest.face_id == 1 and "1 more face was found in the image" in " ".join(largest.notes)
    assert "--faces all" in " ".join(largest.notes)
    assert [each.face_id for each in decomposer(scene, faces=2)] == [1, 2]
    assert [each.face_id for each in decomposer(scene, faces=1)] == [1]


def test_the_faces_that_are_asked_for_are_edited(
    decomposer: Decomposer, astronaut: np.ndarray
) -> None:
    scene = np.concatenate([astronaut[:256, 96:352], astronaut[:256, 351:95:-1]], 1)
    one, both = (decomposer.edit(scene, 3.0, faces=faces) for faces in ("largest", "all"))
    changed = [(edited != scene).any((0, 2)) for edited in (one, both)]
    assert changed[1][:256].any() and changed[1][256:].any()
    assert not (changed[0][:200].any() and changed[0][300:].any())


def test_no_faces_cannot_be_asked_for(decomposer: Decomposer, astronaut: np.ndarray) -> None:
    with pytest.raises(InputError, match="faces is all, largest, or how many of the largest"):
        decomposer(astronaut, faces=0)
    with pytest.raises(InputError, match=r"largest, from 1; got -1\."):
        decomposer.edit(astronaut, faces=-1)


def test_an_edit_leaves_all_but_skin_untouched(
    decomposer: Decomposer, decomposition: Decomposition, astronaut: np.ndarray
) -> None:
    edited = decomposer.edit(astronaut, melanin=3.0)
    untouched = decomposition.mask < 0.01
    np.testing.assert_array_equal(edited[untouched], astronaut[untouched])
    skin = decomposition.mask > 0.9
    assert (edited[skin] <= astronaut[skin]).all()
    assert srgb_to_linear(edited[skin]).mean() < 0.9 * srgb_to_linear(astronaut[skin]).mean()


@pytest.mark.parametrize("dtype", [np.float64, np.uint8])
def test_a_mask_weighs_an_edit(
    decomposer: Decomposer, astronaut: np.ndarray, dtype: type[np.generic]
) -> None:
    share = np.ones((512, 512))
    share[:, :200], share[:, 200:230] = 0, 0.5
    mask = share if dtype is np.float64 else np.rint(255 * share).astype(dtype)
    whole = decomposer.edit(astronaut, melanin=3.0)
    edited = decomposer.edit(astronaut, melanin=3.0, mask=mask)
    np.testing.assert_array_equal(edited[:, :200], astronaut[:, :200])
    np.testing.assert_array_equal(edited[:, 230:], whole[:, 230:])
    before, half, full = (srgb_to_linear(each[:, 200:230]) for each in (astronaut, edited, whole))
    assert (full != before).any()
    np.testing.assert_allclose(half - before, (full - before) / 2, atol=0.006)


def test_a_mask_of_another_size_is_refused(decomposer: Decomposer, astronaut: np.ndarray) -> None:
    with pytest.raises(InputError, match="The mask has 3 x 2 pixels, and the image 512 x 512"):
        decomposer.edit(astronaut, melanin=2.0, mask=np.ones((2, 3)))


def test_an_edit_of_blood_changes_green_most(
    decomposer: Decomposer, decomposition: Decomposition, astronaut: np.ndarray
) -> None:
    edited = decomposer.edit(astronaut, hemoglobin=2.0)
    skin = decomposition.mask > 0.9
    red, green, blue = (srgb_to_linear(edited[skin]) / srgb_to_linear(astronaut[skin])).mean(0)
    assert green < blue < red < 1


def test_factors_of_one_change_nothing(decomposer: Decomposer, astronaut: np.ndarray) -> None:
    np.testing.assert_array_equal(decomposer.edit(astronaut), astronaut)


@pytest.mark.parametrize("factor", [math.nan, math.inf, -1.0, 10.1])
@pytest.mark.parametrize("pigment", ["melanin", "hemoglobin"])
def test_factors_out_of_range_are_refused(
    decomposer: Decomposer, astronaut: np.ndarray, pigment: str, factor: float
) -> None:
    with pytest.raises(InputError, match=rf"{pigment} is multiplied by a number in \[0, 10\]; got"):
        decomposer.edit(astronaut, **{pigment: factor})


def test_files_are_opened_at_the_first_photograph_and_once(
    model_file: Path, astronaut: np.ndarray, monkeypatch: pytest.MonkeyPatch
) -> None:
    opened = []

    def counted(path: Path, kind: str, *options: object) -> object:
        opened.append(kind)
        return open_model(path, kind, *options)

    monkeypatch.setattr("skinnet.inference._subject_reader.open_model", counted)
    decomposer = Decomposer(model_file)
    assert opened == []
    decomposer(astronaut)
    decomposer(astronaut)
    assert sorted(opened) == ["decoder", "encoder"]


def test_threads_are_counted_from_one(model_file: Path) -> None:
    with pytest.raises(InputError, match=r"threads is a whole number of at least 1, .* got 0"):
        Decomposer(model_file, threads=0)


def test_lights_that_are_not_weighed_are_refused(
    save_model: SaveModel, astronaut: np.ndarray
) -> None:
    path = save_model(lights='["D", "A", "F2"]')
    with pytest.raises(InputError, match="names 3 lights, but gives 2 weights; export it again"):
        Decomposer(path)(astronaut)


@pytest.mark.parametrize("image", [np.full((4, 4, 3), np.nan), np.zeros((4, 4, 3), np.int32)])
def test_bad_arrays_are_value_errors(decomposer: Decomposer, image: np.ndarray) -> None:
    with pytest.raises(ValueError, match="A photograph"):
        decomposer(image)


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16])
def test_an_edit_of_a_picture_keeps_its_depth_and_alpha(
    decomposer: Decomposer, astronaut: np.ndarray, dtype: type
) -> None:
    top = np.iinfo(dtype).max
    pixels = astronaut.astype(dtype) * (top // 255)
    alpha = np.full(pixels.shape[:2], top, dtype)
    alpha[:, :200] = 0
    edited = decomposer.edit_picture(Picture("a", pixels, alpha), 2.0)
    assert edited.pixels.dtype == dtype and edited.alpha is alpha
    np.testing.assert_array_equal(edited.pixels[:, :200], pixels[:, :200])
    assert (edited.pixels[:, 200:] != pixels[:, 200:]).any()


def test_depth_and_colour_space_do_not_change_an_edit(
    decomposer: Decomposer, astronaut: np.ndarray
) -> None:
    right = decomposer.edit(astronaut, 2.0, 1.5).astype(int)
    deep = Picture("a", astronaut.astype(np.uint16) * 257)
    assert np.abs(decomposer.edit(deep, 2.0, 1.5) - right).max() <= 1
