"""Pigment detail of a photograph against the maps that it was made from."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from painted_skin import (
    SIZE,
    Maps,
    compress_jpeg,
    correlate,
    keep_detail,
    photograph_maps,
    reduce_maps,
)

from skinnet import SkinDecoder
from skinnet.images import resize
from skinnet.inference.full_resolution._colour_table import ColourTable
from skinnet.inference.full_resolution._detail import list_octaves, recover_detail


def recover_pigments(photo: np.ndarray, maps: Maps, table: ColourTable) -> Maps:
    with ThreadPoolExecutor(1) as pool:
        changes = recover_detail(photo, maps, table, pool)
    return {
        name: resize(maps[name], SIZE, SIZE) + resize(change, SIZE, SIZE)
        for name, change in zip(("melanin", "hemoglobin"), changes, strict=True)
    }


@pytest.mark.parametrize(
    ("quality", "melanin", "hemoglobin"), [(None, 0.95, 0.7), (92, 0.9, 0.4), (80, 0.8, 0.2)]
)
def test_freckles_are_recovered(
    skin: SkinDecoder,
    table: ColourTable,
    truth: Maps,
    quality: int | None,
    melanin: float,
    hemoglobin: float,
) -> None:
    photo, maps = photograph_maps(skin, truth), reduce_maps(truth)
    photo = photo if quality is None else compress_jpeg(photo, quality)
    recovered = recover_pigments(photo, maps, table)
    for name, least in (("melanin", melanin), ("hemoglobin", hemoglobin)):
        expected, actual = keep_detail(truth[name]), keep_detail(recovered[name])
        assert correlate(expected, actual) > least, name
        lost = np.sqrt(np.mean(keep_detail(resize(maps[name], SIZE, SIZE) - truth[name]) ** 2))
        assert np.sqrt(np.mean((actual - expected) ** 2)) < lost, name


@pytest.mark.parametrize(("quality", "most"), [(None, 0.01), (92, 0.05), (80, 0.1)])
def test_wrinkles_are_not_pigment(
    skin: SkinDecoder, table: ColourTable, truth: Maps, quality: int | None, most: float
) -> None:
    even = truth | {name: np.full_like(truth[name], 0.04) for name in ("melanin", "hemoglobin")}
    photo = photograph_maps(skin, even)
    photo = photo if quality is None else compress_jpeg(photo, quality)
    recovered = recover_pigments(photo, reduce_maps(even), table)
    depth = keep_detail(np.log(truth["shading"]))
    for name in ("melanin", "hemoglobin"):
        share = np.vdot(keep_detail(np.log(recovered[name])), depth) / np.vdot(depth, depth)
        assert abs(share) < most, name


def test_a_hair_on_skin_is_no_pigment(skin: SkinDecoder, table: ColourTable, truth: Maps) -> None:
    photo, maps = photograph_maps(skin, truth, noise=0), reduce_maps(truth)
    clean = recover_pigments(photo, maps, table)["melanin"]
    photo[200:260, 240:246] = (25, 22, 24)
    assert np.abs(recover_pigments(photo, maps, table)["melanin"] - clean).max() < 0.03


def test_sizes_halve_until_the_networks() -> None:
    sizes = [(1300, 1000), (650, 500), (325, 250), (128, 98)]
    assert list_octaves((1300, 1000), (128, 98)) == sizes
    assert list_octaves((128, 98), (128, 98)) == [(128, 98)]
    assert list_octaves((150, 16), (128, 16)) == [(150, 16), (128, 16)]
