import json
import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import onnx
import pytest
from onnx import TensorProto, helper
from PIL import Image

from skinnet import Decomposer, Decomposition, __version__
from skinnet.errors import InputError, NoFaceError
from skinnet.images import Box, srgb_to_linear
from skinnet.inference import draw_panel, open_model, round_up
from skinnet.inference._editing import apply_gain, compute_gain, fade_edges

SaveModel = Callable[..., Path]


@pytest.fixture(scope="module")
def decomposer(model_file: Path) -> Decomposer:
    return Decomposer(model_file, threads=1)


@pytest.fixture(scope="module")
def decomposition(decomposer: Decomposer, astronaut: np.ndarray) -> Decomposition:
    return decomposer(astronaut)


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


def test_the_summary_is_json_of_what_the_arrays_hold(decomposition: Decomposition) -> None:
    summary = json.loads(json.dumps(decomposition.summary(), allow_nan=False))
    skin = decomposition.mask > 0.5
    melanin = summary["maps"]["melanin"]
    assert melanin["unit"] == "melanosome volume fraction"
    assert melanin["mean"] == pytest.approx(decomposition.melanin[skin].mean(), rel=1e-4)
    assert melanin["std"] == pytest.approx(decomposition.melanin[skin].std(), rel=1e-4)
    assert melanin["p5"] < melanin["mean"] < melanin["p95"]
    assert summary["skin_share"] == pytest.approx(skin[decomposition.box.slices].mean(), rel=1e-4)
    assert summary["box"] == decomposition.box._asdict()
    assert summary["photo"] == {"width": 512, "height": 512}
    assert summary["version"] == __version__
    assert summary["model"] == {"version": "0.1.0", "trained_on": "nothing"}


def test_without_skin_the_numbers_are_none(skinless_file: Path, astronaut: np.ndarray) -> None:
    decomposition = Decomposer(skinless_file)(astronaut)
    summary = decomposition.summary()
    assert summary["skin_share"] == 0
    assert summary["maps"]["hemoglobin"]["mean"] is None
    assert draw_panel(astronaut, decomposition).dtype == np.uint8
    np.testing.assert_array_equal(Decomposer(skinless_file).edit(astronaut, 3.0), astronaut)


def test_without_a_face_nothing_is_guessed(decomposer: Decomposer, tmp_path: Path) -> None:
    wall = np.full((90, 120, 3), 200, np.uint8)
    Image.fromarray(wall).save(tmp_path / "wall.png")
    with pytest.raises(NoFaceError, match=r"wall\.png; .*--whole-image .*whole_image=True"):
        decomposer(tmp_path / "wall.png")
    with pytest.raises(NoFaceError, match="No face was found in the image"):
        decomposer.edit(wall, 2.0)
    assert decomposer(wall, whole_image=True).box == Box(0, 0, 120, 90)


@pytest.mark.parametrize("shape", [(1, 1), (1, 300), (37, 53), (200, 90)])
def test_any_size_is_decomposed_whole(decomposer: Decomposer, shape: tuple[int, int]) -> None:
    photo = np.random.default_rng(0).integers(0, 255, (*shape, 3), np.uint8)
    decomposition = decomposer(photo, whole_image=True)
    assert decomposition.melanin.shape == shape
    assert decomposition.reconstruction.shape == photo.shape
    assert decomposer.edit(photo, 2.0, 0.5, whole_image=True).shape == photo.shape


def test_an_edit_leaves_all_but_skin_untouched(
    decomposer: Decomposer, decomposition: Decomposition, astronaut: np.ndarray
) -> None:
    edited = decomposer.edit(astronaut, melanin=3.0)
    untouched = decomposition.mask < 0.01
    np.testing.assert_array_equal(edited[untouched], astronaut[untouched])
    skin = decomposition.mask > 0.9
    assert (edited[skin] <= astronaut[skin]).all()
    assert srgb_to_linear(edited[skin]).mean() < 0.9 * srgb_to_linear(astronaut[skin]).mean()


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


def test_gain_is_exactly_one_where_nothing_changes() -> None:
    colours = np.random.default_rng(0).random((6, 5, 3), np.float32)
    colours[0] = 0
    assert (compute_gain(colours, colours, np.zeros((6, 5), np.float32)) == 1).all()


def test_gloss_is_not_tinted() -> None:
    crop = np.full((8, 8, 3), 200, np.uint8)
    ones = np.ones((4, 4), np.float32)
    gain = np.full((4, 4, 3), 0.5, np.float32)
    np.testing.assert_array_equal(apply_gain(crop, gain, ones, ones), crop)
    assert (apply_gain(crop, gain, 0 * ones, ones) < 150).all()


def test_edits_fade_towards_edges_inside_the_photograph() -> None:
    fade = fade_edges((50, 50), Box(0, 10, 60, 70), (100, 60))
    assert fade[25, 0] == fade[25, -1] == 1
    assert fade[0, 25] < 0.2 and fade[-1, 25] < 0.2


def test_files_are_opened_at_the_first_photograph_and_once(
    model_file: Path, astronaut: np.ndarray, monkeypatch: pytest.MonkeyPatch
) -> None:
    opened = []

    def counted(path: Path, kind: str, threads: int | None) -> object:
        opened.append(kind)
        return open_model(path, kind, threads)

    monkeypatch.setattr("skinnet.inference.decomposer.open_model", counted)
    decomposer = Decomposer(model_file)
    assert opened == []
    decomposer(astronaut)
    decomposer(astronaut)
    assert sorted(opened) == ["decoder", "encoder"]


def test_threads_are_counted_from_one(model_file: Path) -> None:
    with pytest.raises(InputError, match="threads is at least 1, or None for all cores; got 0"):
        Decomposer(model_file, threads=0)


@pytest.mark.parametrize("content", [b"", b"onnx?" * 50, "truncated"])
def test_damaged_model_files_are_refused(save_model: SaveModel, content: bytes | str) -> None:
    path = save_model()
    whole = path.read_bytes()
    path.write_bytes(whole[: len(whole) // 2] if isinstance(content, str) else content)
    with pytest.raises(InputError, match=r"changed\.onnx is not a complete ONNX file .*python -m"):
        Decomposer(path).load()


def test_missing_model_files_are_named(save_model: SaveModel, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"There is no encoder file .*none\.onnx; give"):
        Decomposer(tmp_path / "none.onnx").load()
    path = save_model()
    path.with_name("changed.decoder.onnx").unlink()
    with pytest.raises(InputError, match=r"There is no decoder file .*changed\.decoder\.onnx"):
        Decomposer(path).load()


@pytest.mark.parametrize(
    ("notes", "words"),
    [
        ({"kind": None}, "is an ONNX file, but not one of skinnet's"),
        ({"format": "2"}, "has format 2, and this skinnet reads format 1; export it again"),
        ({"format": None}, "has format None"),
        ({"kind": "decoder"}, "is a decoder, but an encoder is needed"),
        ({"lights": "D, A"}, "The metadata of .* is damaged"),
        ({"working_size": "large"}, "The metadata of .* is damaged"),
        ({"working_size": "0"}, "The metadata of .* is damaged"),
        ({"outputs": "{}"}, "The metadata of .* is damaged"),
        ({"outputs": None}, "The metadata of .* is damaged"),
    ],
)
def test_other_metadata_are_refused(
    save_model: SaveModel, notes: dict[str, str | None], words: str
) -> None:
    with pytest.raises(InputError, match=words):
        Decomposer(save_model(**notes)).load()


def test_a_file_with_other_outputs_is_refused(tmp_path: Path) -> None:
    value = helper.make_tensor_value_info("x", TensorProto.FLOAT, [1])
    other = helper.make_tensor_value_info("y", TensorProto.FLOAT, [1])
    graph = helper.make_graph([helper.make_node("Neg", ["x"], ["y"])], "g", [value], [other])
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 20)], ir_version=10)
    helper.set_model_props(model, {"skinnet.kind": "encoder", "skinnet.format": "1"})
    onnx.save(model, tmp_path / "a.onnx")
    with pytest.raises(
        InputError, match="says that it is an encoder, but its inputs are x and its outputs y"
    ):
        Decomposer(tmp_path / "a.onnx").load()


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


def test_the_panel_shows_eight_pictures(
    decomposition: Decomposition, astronaut: np.ndarray
) -> None:
    picture = draw_panel(astronaut, decomposition)
    assert picture.shape == (806, 1290, 3) and picture.dtype == np.uint8
    tiles = [picture[y + 30 : y + 330, x : x + 300] for y in (18, 412) for x in (18, 336, 654, 972)]
    assert all(tile.std() > 10 for tile in tiles)


@pytest.mark.parametrize(
    ("value", "top"), [(0.14, 0.15), (0.15, 0.15), (0.9, 1), (1, 1), (0, 1e-6), (37, 40)]
)
def test_scales_end_at_round_numbers(value: float, top: float) -> None:
    assert round_up(float(value)) == pytest.approx(top)
