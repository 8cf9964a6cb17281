"""Layers at full resolution against the photograph and the maps that it was made from."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from painted_skin import (
    SIZE,
    SMALL,
    TOP,
    Maps,
    correlate,
    keep_detail,
    photograph_maps,
    reduce_maps,
)
from scipy import ndimage

from skinnet import Decomposer, SkinDecoder
from skinnet.images import srgb_to_linear
from skinnet.inference.full_resolution import _layers
from skinnet.inference.full_resolution._colour_table import ColourTable
from skinnet.inference.full_resolution._layers import enlarge_layers, sharpen_layers

DECODED = np.full((SMALL, SMALL, 3), 7 / 255, np.float32)


def test_the_layers_add_up_to_the_photograph(
    skin: SkinDecoder, table: ColourTable, truth: Maps
) -> None:
    photo = photograph_maps(skin, truth)
    layers = sharpen_layers(photo, reduce_maps(truth), DECODED, table, 4.0, 1)
    diffuse = layers.shading[..., None] * table(layers.melanin, layers.hemoglobin)
    total = diffuse + layers.specular[..., None] + layers.offset
    np.testing.assert_allclose(total, srgb_to_linear(photo), atol=1e-5)
    assert correlate(keep_detail(layers.shading), keep_detail(truth["shading"])) > 0.9
    assert np.sqrt(np.mean(layers.offset**2)) < 0.01
    assert np.abs(layers.reconstruction.astype(float) - photo).mean() < 2


def test_inputs_are_not_changed(skin: SkinDecoder, table: ColourTable, truth: Maps) -> None:
    photo, maps = photograph_maps(skin, truth), reduce_maps(truth)
    before = photo.copy(), {name: value.copy() for name, value in maps.items()}
    sharpen_layers(photo, maps, DECODED, table, 4.0, 1)
    np.testing.assert_array_equal(photo, before[0])
    for name, value in maps.items():
        np.testing.assert_array_equal(value, before[1][name])


def test_blocks_and_threads_change_nothing(
    skin: SkinDecoder, table: ColourTable, truth: Maps, monkeypatch: pytest.MonkeyPatch
) -> None:
    photo, maps = photograph_maps(skin, truth), reduce_maps(truth)
    one = sharpen_layers(photo, maps, DECODED, table, 4.0, threads=1)
    monkeypatch.setattr(_layers, "_BLOCK", 7 * SIZE)
    other = sharpen_layers(photo, maps, DECODED, table, 4.0, threads=3)
    for a, b in zip(one, other, strict=True):
        np.testing.assert_array_equal(a, b)


@pytest.mark.parametrize("shape", [(1, 1), (3, 400), (41, 40), (81, 79), (200, 333)])
@pytest.mark.parametrize("kind", ["noise", "black", "white", "red"])
def test_any_photograph_gives_finite_maps(
    table: ColourTable, truth: Maps, shape: tuple[int, int], kind: str
) -> None:
    height, width = shape
    photo = np.random.default_rng(0).integers(0, 256, (height, width, 3)).astype(np.uint8)
    if kind != "noise":
        photo[:] = {"black": (0, 0, 0), "white": (255, 255, 255), "red": (255, 0, 0)}[kind]
    layers = sharpen_layers(photo, reduce_maps(truth), DECODED, table, 4.0, 1)
    for name, layer in layers._asdict().items():
        assert layer.shape[:2] == shape, name
        assert np.isfinite(layer).all() and (name == "offset" or layer.min() >= 0), name
    assert layers.melanin.max() <= TOP[0] and layers.hemoglobin.max() <= TOP[1]
    assert layers.shading.max() <= 4 and layers.offset.max() <= 1


def test_layers_are_the_networks_off_skin(
    skin: SkinDecoder, table: ColourTable, truth: Maps
) -> None:
    maps = reduce_maps(truth)
    maps["mask"][:, : SMALL // 2] = 0
    before = enlarge_layers(maps, DECODED, SIZE, SIZE)
    after = sharpen_layers(photograph_maps(skin, truth), maps, DECODED, table, 4.0, 1)
    left = np.s_[:, : SIZE // 2 - 2 * SIZE // SMALL]
    for a, b in zip(before, after, strict=True):
        np.testing.assert_array_equal(a[left], b[left])
    assert np.abs(after.shading - before.shading)[:, SIZE // 2 :].mean() > 0.01


def test_the_decomposer_adds_detail_where_there_is_some(
    model_file: Path, astronaut: np.ndarray
) -> None:
    decompose = Decomposer(model_file, threads=1)
    soft, fine = (decompose(astronaut, detail=detail) for detail in (False, True))
    skin = fine.mask == 1
    rest = np.abs(soft.shading[skin] - ndimage.gaussian_filter(soft.shading, 1)[skin])
    finer = np.abs(fine.shading[skin] - ndimage.gaussian_filter(fine.shading, 1)[skin])
    assert finer.mean() > 2 * rest.mean()
    np.testing.assert_array_equal(fine.shading[fine.mask == 0], soft.shading[fine.mask == 0])
    tiny = astronaut[100:130, 210:240]
    soft, fine = (decompose(tiny, whole_image=True, detail=detail) for detail in (False, True))
    np.testing.assert_array_equal(soft.shading, fine.shading)


def test_detail_needs_no_torch(model_file: Path) -> None:
    program = (
        "import sys\nimport numpy as np\nfrom skinnet import Decomposer\n"
        "patch = np.full((200, 200, 3), (200, 150, 130), np.uint8)\n"
        f"Decomposer({str(model_file)!r})(patch, True)\n"
        "print('torch' in sys.modules or 'jaxtyping' in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert done.stdout == "False\n", done.stderr
