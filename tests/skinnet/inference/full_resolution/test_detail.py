"""Detail that only the photograph has, against maps that made it."""

import io
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
import torch
from PIL import Image
from scipy import ndimage

from skinnet import Decomposer, SkinDecoder
from skinnet.images import linear_to_srgb, resize, srgb_to_linear, to_uint8
from skinnet.inference import SHIPPED_ENCODER, get_decoder_path, open_model
from skinnet.inference.full_resolution import _layers as full_size
from skinnet.inference.full_resolution._colour_table import ColourTable, tabulate
from skinnet.inference.full_resolution._detail import octaves, pigment_detail
from skinnet.inference.full_resolution._layers import Layers, sharpen

SIZE, SMALL, TOP = 480, 40, (0.43, 0.15)
Maps = dict[str, np.ndarray]


@pytest.fixture(scope="module")
def skin() -> SkinDecoder:
    return SkinDecoder(fast=False)


@pytest.fixture(scope="module")
def table(skin: SkinDecoder) -> ColourTable:
    capture = skin.camera.standard()._asdict()
    codes = {name: np.float32(value.numpy())[None] for name, value in capture.items()}
    return tabulate(open_model(get_decoder_path(SHIPPED_ENCODER), "decoder", 1), codes, TOP)


@pytest.fixture(scope="module")
def truth() -> Maps:
    """Freckles, spots of blood, wrinkles and pores on smooth skin."""
    lot = np.random.default_rng(0)
    flat = np.ones((SIZE, SIZE), np.float32)
    rows = np.arange(SIZE)[:, None] + 12 * np.sin(np.arange(SIZE) / 40)
    lines = sum(0.3 * np.exp(-((rows - y) ** 2) / 12) for y in (60, 170, 300, 390))
    return {
        "melanin": 0.035 * flat * (1 + spots(lot, 120, (2, 5), 0.9)),
        "hemoglobin": 0.045 * flat * (1 + spots(lot, 60, (3, 6), 0.7)),
        "shading": 0.7 * flat * np.exp(-lines - spots(lot, 1500, (1, 1.5), 0.12)),
        "specular": 0.01 * flat,
    }


def spots(
    lot: np.random.Generator, count: int, radii: tuple[float, float], height: float
) -> np.ndarray:
    drawn = np.zeros((SIZE, SIZE), np.float32)
    for radius in np.linspace(*radii, 4):
        one = np.zeros((SIZE, SIZE))
        one[tuple(lot.integers(0, SIZE, (2, count // 4)))] = 2 * np.pi * radius**2 * height
        drawn += ndimage.gaussian_filter(one, radius).astype(np.float32)
    return drawn


def small(maps: Maps) -> Maps:
    """What a network could know at best."""
    codes = {name: resize(value.astype(np.float32), SMALL, SMALL) for name, value in maps.items()}
    shape = codes["melanin"].shape
    return codes | {"mask": np.ones(shape, np.float32), "offset": np.zeros((*shape, 3), np.float32)}


def photograph(skin: SkinDecoder, maps: Maps, noise: float = 0.7) -> np.ndarray:
    with torch.no_grad():
        tensors = [torch.from_numpy(np.float32(value))[None] for value in maps.values()]
        linear = skin(*tensors)[0].permute(1, 2, 0).numpy()
    grain = np.random.default_rng(1).standard_normal(linear.shape) * noise / 255
    return to_uint8(linear_to_srgb(linear) + grain)


def jpeg(photo: np.ndarray, quality: int) -> np.ndarray:
    file = io.BytesIO()
    Image.fromarray(photo).save(file, "JPEG", quality=quality)
    return np.array(Image.open(file))


def high(values: np.ndarray) -> np.ndarray:
    """What the network's size has lost."""
    values = np.float32(values)
    return values - resize(resize(values, SMALL, SMALL), SIZE, SIZE)


def pigments(photo: np.ndarray, codes: Maps, table: ColourTable) -> Maps:
    with ThreadPoolExecutor(1) as pool:
        changes = pigment_detail(photo, codes, table, pool)
    return {
        name: resize(codes[name], SIZE, SIZE) + resize(change, SIZE, SIZE)
        for name, change in zip(("melanin", "hemoglobin"), changes, strict=True)
    }


def layers_of(codes: Maps, width: int, height: int) -> Layers:
    maps = {name: resize(codes[name], width, height) for name in codes if name != "offset"}
    return Layers(
        **maps,
        offset=np.zeros((height, width, 3), np.float32),
        reconstruction=np.full((height, width, 3), 7, np.uint8),
    )


def correlation(a: np.ndarray, b: np.ndarray) -> float:
    return float(np.corrcoef(a.ravel(), b.ravel())[0, 1])


@pytest.mark.parametrize(
    ("quality", "melanin", "hemoglobin"), [(None, 0.95, 0.7), (92, 0.9, 0.4), (80, 0.8, 0.2)]
)
def test_freckles_are_found_again(
    skin: SkinDecoder,
    table: ColourTable,
    truth: Maps,
    quality: int | None,
    melanin: float,
    hemoglobin: float,
) -> None:
    photo = photograph(skin, truth)
    found = pigments(photo if quality is None else jpeg(photo, quality), small(truth), table)
    for name, least in (("melanin", melanin), ("hemoglobin", hemoglobin)):
        wanted, got = high(truth[name]), high(found[name])
        assert correlation(wanted, got) > least, name
        lost = np.sqrt(np.mean(high(resize(small(truth)[name], SIZE, SIZE) - truth[name]) ** 2))
        assert np.sqrt(np.mean((got - wanted) ** 2)) < lost, name


@pytest.mark.parametrize(("quality", "most"), [(None, 0.01), (92, 0.05), (80, 0.1)])
def test_wrinkles_are_not_pigment(
    skin: SkinDecoder, table: ColourTable, truth: Maps, quality: int | None, most: float
) -> None:
    even = truth | {name: np.full_like(truth[name], 0.04) for name in ("melanin", "hemoglobin")}
    photo = photograph(skin, even)
    found = pigments(photo if quality is None else jpeg(photo, quality), small(even), table)
    depth = high(np.log(truth["shading"]))
    for name in ("melanin", "hemoglobin"):
        leak = np.vdot(high(np.log(found[name])), depth) / np.vdot(depth, depth)
        assert abs(leak) < most, name


def test_the_layers_make_the_photograph(skin: SkinDecoder, table: ColourTable, truth: Maps) -> None:
    photo = photograph(skin, truth)
    layers = layers_of(small(truth), SIZE, SIZE)
    sharpen(layers, photo, small(truth), table, 4.0, 1)
    body = layers.shading[..., None] * table(layers.melanin, layers.hemoglobin)
    made = body + layers.specular[..., None] + layers.offset
    np.testing.assert_allclose(made, srgb_to_linear(photo), atol=1e-5)
    assert correlation(high(layers.shading), high(truth["shading"])) > 0.9
    assert np.sqrt(np.mean(layers.offset**2)) < 0.01
    assert np.abs(layers.reconstruction.astype(float) - photo).mean() < 2


def test_blocks_and_threads_change_nothing(
    skin: SkinDecoder, table: ColourTable, truth: Maps, monkeypatch: pytest.MonkeyPatch
) -> None:
    photo, codes = photograph(skin, truth), small(truth)
    one, other = (layers_of(codes, SIZE, SIZE) for _ in range(2))
    sharpen(one, photo, codes, table, 4.0, threads=1)
    monkeypatch.setattr(full_size, "_BLOCK", 7 * SIZE)
    sharpen(other, photo, codes, table, 4.0, threads=3)
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
    layers = layers_of(small(truth), width, height)
    sharpen(layers, photo, small(truth), table, 4.0, 1)
    for name, layer in layers._asdict().items():
        assert np.isfinite(layer).all() and (name == "offset" or layer.min() >= 0), name
    assert layers.melanin.max() <= TOP[0] and layers.hemoglobin.max() <= TOP[1]
    assert layers.shading.max() <= 4 and layers.offset.max() <= 1


def test_what_is_not_skin_stays_as_it_was(
    skin: SkinDecoder, table: ColourTable, truth: Maps
) -> None:
    codes = small(truth)
    codes["mask"][:, : SMALL // 2] = 0
    before, after = (layers_of(codes, SIZE, SIZE) for _ in range(2))
    sharpen(after, photograph(skin, truth), codes, table, 4.0, 1)
    left = np.s_[:, : SIZE // 2 - 2 * SIZE // SMALL]
    for a, b in zip(before, after, strict=True):
        np.testing.assert_array_equal(a[left], b[left])
    assert np.abs(after.shading - before.shading)[:, SIZE // 2 :].mean() > 0.01


def test_a_hair_on_skin_is_no_pigment(skin: SkinDecoder, table: ColourTable, truth: Maps) -> None:
    photo, codes = photograph(skin, truth, noise=0), small(truth)
    clean = pigments(photo, codes, table)["melanin"]
    photo[200:260, 240:246] = (25, 22, 24)
    assert np.abs(pigments(photo, codes, table)["melanin"] - clean).max() < 0.03


def test_sizes_halve_until_the_networks() -> None:
    assert octaves((1300, 1000), (128, 98)) == [(1300, 1000), (650, 500), (325, 250), (128, 98)]
    assert octaves((128, 98), (128, 98)) == [(128, 98)]
    assert octaves((150, 16), (128, 16)) == [(150, 16), (128, 16)]


def test_the_table_is_the_decoder(skin: SkinDecoder, table: ColourTable) -> None:
    lot = np.random.default_rng(0)
    melanin, hemoglobin = (lot.uniform(0, top, (50, 60)).astype(np.float32) for top in TOP)
    melanin[0], hemoglobin[:, 0], melanin[-1] = 0, 0, TOP[0]
    with torch.no_grad():
        exact = skin(torch.from_numpy(melanin), torch.from_numpy(hemoglobin)).permute(1, 2, 0)
    # The decoder's pictures are clipped at black, which the darkest skin reaches in blue.
    np.testing.assert_allclose(table(melanin, hemoglobin), exact.clamp(min=0).numpy(), atol=8e-4)


def test_the_decomposer_takes_detail_where_there_is_some(
    model_file: Path, astronaut: np.ndarray
) -> None:
    decompose = Decomposer(model_file, threads=1)
    soft, fine = (decompose(astronaut, detail=detail) for detail in (False, True))
    skin = fine.mask == 1
    rest = np.abs(soft.shading[skin] - ndimage.gaussian_filter(soft.shading, 1)[skin])
    finer = np.abs(fine.shading[skin] - ndimage.gaussian_filter(fine.shading, 1)[skin])
    assert finer.mean() > 2 * rest.mean()
    np.testing.assert_array_equal(fine.shading[fine.mask == 0], soft.shading[fine.mask == 0])
    tiny = astronaut[40:100, 190:250]
    soft, fine = (decompose(tiny, whole_image=True, detail=detail) for detail in (False, True))
    np.testing.assert_array_equal(soft.shading, fine.shading)


def test_detail_needs_no_torch(model_file: Path) -> None:
    program = (
        "import sys\nimport numpy as np\nfrom skinnet import Decomposer\n"
        f"Decomposer({str(model_file)!r})(np.full((200, 200, 3), 180, np.uint8), True)\n"
        "print('torch' in sys.modules or 'jaxtyping' in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert done.stdout == "False\n", done.stderr
