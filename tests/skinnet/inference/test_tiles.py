"""Tiles have labels that fit, blank where there is no skin, and words for what is off the scale."""

import numpy as np
import pytest

from skinnet.inference import _colour_scales, _tiles
from skinnet.inference._colour_scales import MELANIN, SPECULAR, Scale
from skinnet.inference._tiles import (
    BLANK,
    TILE,
    draw_grid,
    draw_map,
    draw_picture,
    draw_pigment_map,
    draw_plain_map,
    place_labels,
)

SCALES = {name: one for name, one in vars(_colour_scales).items() if isinstance(one, Scale)}
TOP = _tiles._CAPTION


def get_picture(tile: object) -> np.ndarray:
    return np.asarray(tile)[TOP : TOP + TILE]


@pytest.mark.parametrize("scale", SCALES.values(), ids=SCALES)
def test_labels_lie_in_the_tile_and_apart(scale: Scale) -> None:
    _, left, right = zip(*place_labels(scale), strict=True)
    assert left[0] >= 0 and right[-1] <= TILE
    assert (np.array(left[1:]) - right[:-1] >= 6).all()
    assert _tiles._load_font(15).getlength(scale.measure) <= TILE


def test_a_map_has_the_colours_of_its_scale_and_is_blank_off_skin() -> None:
    mask = np.repeat([[1.0, 0.0]], 2, 0)
    tile = get_picture(draw_pigment_map("melanin", np.array([[0.03, np.nan]] * 2), mask))
    np.testing.assert_allclose(tile[150, 10], MELANIN.colour(np.array(0.03)), atol=1)
    assert (tile[150, -10] == BLANK).all()


def test_the_same_value_has_the_same_colour_on_everyone() -> None:
    left = np.arange(9) < 4
    people = [np.tile(np.where(left, 0.05, skin), (9, 1)) for skin in (0.02, 0.3)]
    pale, dark = (get_picture(draw_pigment_map("melanin", one, np.ones((9, 9)))) for one in people)
    assert (pale[150, 20] == dark[150, 20]).all()
    assert pale[150, -20].mean() > dark[150, -20].mean() + 50


def test_large_maps_are_averaged_over_skin() -> None:
    values = np.where(np.indices((1200, 1200))[1] % 2, 0.04, 9.0)
    tile = get_picture(draw_pigment_map("melanin", values, (values < 1).astype(float)))
    half = (MELANIN.colour(np.array(0.04)).astype(float) + BLANK) / 2
    np.testing.assert_allclose(tile[150, 150], half, atol=4)


@pytest.mark.parametrize(
    ("share", "note"), [(0.0, ""), (0.01, ""), (0.02, "2 % above 50 %"), (1.0, "100 % above 50 %")]
)
def test_what_exceeds_the_scale_is_said(share: float, note: str) -> None:
    values = np.where(np.arange(100) < 100 * share, 0.6, 0.1).reshape(10, 10)
    assert _tiles._note_excess(values.ravel(), MELANIN) == note
    plain = draw_map("melanin", np.full((10, 10), 0.1), np.ones((10, 10)), MELANIN)
    tile = draw_map("melanin", values, np.ones((10, 10)), MELANIN)
    captions = [np.asarray(one)[:TOP] for one in (plain, tile)]
    assert np.array_equal(*captions) == (note == "")


def test_only_skin_counts_as_exceeding() -> None:
    values = np.array([[0.1, 0.9]], np.float32)
    tiles = [
        np.asarray(draw_plain_map("specular", values, np.array([[1.0, off]]), SPECULAR))[:TOP]
        for off in (0.0, 1.0)
    ]
    bare = np.asarray(draw_picture("specular", np.zeros((1, 2, 3), np.uint8)))[:TOP]
    assert np.array_equal(tiles[0], bare) and not np.array_equal(tiles[1], bare)


def test_longest_caption_leaves_room_for_the_note() -> None:
    caption = _tiles._load_font(20).getlength("component 3, -3 sd")
    assert caption + _tiles._load_font(15).getlength("100 % above 50 %") < TILE


def test_a_mean_with_its_interval_has_room_beside_the_name() -> None:
    note = "0.95 % (0.082 to 0.99 %)"
    name = _tiles._load_font(20).getlength("hemoglobin")
    assert name + _tiles._load_font(15).getlength(note) < TILE
    values, mask = np.full((10, 10), 0.1), np.ones((10, 10))
    plain, noted = (
        np.asarray(draw_pigment_map("melanin", values, mask, note=each))[:TOP]
        for each in ("", note)
    )
    changed = (plain != noted).any((0, 2))
    assert changed[TILE // 2 :].any() and not changed[: TILE // 4].any()
    both = np.asarray(draw_pigment_map("melanin", 9 * values, mask, note=note))[:TOP]
    alone = np.asarray(draw_pigment_map("melanin", 9 * values, mask))[:TOP]
    assert not np.array_equal(both, alone) and not np.array_equal(both, noted)


def test_rows_without_a_scale_are_lower() -> None:
    picture = draw_picture("grey", np.full((8, 8, 3), 128, np.uint8))
    map_ = draw_pigment_map("melanin", np.full((4, 4), 0.03), np.ones((4, 4)))
    assert draw_grid([picture, map_, picture], 2).shape == (18 + 394 + 18 + 330 + 18, 654, 3)
