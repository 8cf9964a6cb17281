"""People are read back from a stack, under a common mask."""

import json
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from skinnet.appearance.colour import SkinColour
from skinnet.appearance.skin_texture import SkinTexture
from skinnet.appearance.stack import SubjectStack, open_stack
from skinnet.appearance.stack_writer import write_stack
from skinnet.errors import InputError

Persons = dict[str, Callable[[], SkinTexture]]


def remove_texels(texture: SkinTexture, rows: slice) -> SkinTexture:
    mask = texture.mask.copy()
    mask[rows] = False
    f_mel = np.where(mask, texture.f_mel, np.float32(np.nan))
    return replace(texture, mask=mask, f_mel=f_mel)


@pytest.fixture
def patchy(tmp_path: Path, persons: Persons, colour: SkinColour) -> SubjectStack:
    """Persons 0 and 1 lack rows 5 and 6, person 2 lacks row 6."""
    cut = {"person 0": slice(5, 7), "person 1": slice(5, 7), "person 2": slice(6, 7)}
    subjects = {
        name: partial(remove_texels, make(), cut.get(name, slice(0, 0)))
        for name, make in persons.items()
    }
    return write_stack(tmp_path / "patchy", subjects, colour, "patchy")


def test_a_subject_comes_back_as_it_was(stack: SubjectStack, persons: Persons) -> None:
    given, found = persons["person 3"](), stack.texture(3)
    assert found.name == "person 3" and np.array_equal(found.mask, given.mask)
    for name in ("f_mel", "f_blood", "offset"):
        inside = getattr(given, name)[given.mask]
        assert np.array_equal(getattr(found, name)[given.mask], inside)


@pytest.mark.parametrize("text", [None, "", "[]", "{}", '{"names": 3}'])
def test_a_folder_without_a_stack_is_refused(tmp_path: Path, text: str | None) -> None:
    if text is not None:
        (tmp_path / "stack.json").write_text(text)
    with pytest.raises(InputError, match="holds no stack of subjects"):
        open_stack(tmp_path)


def test_a_damaged_record_is_refused(tmp_path: Path, stack: SubjectStack) -> None:
    state = json.loads((stack.folder / "stack.json").read_text())
    state["colour"]["matrix"] = "none"
    (tmp_path / "stack.json").write_text(json.dumps(state))
    with pytest.raises(InputError, match="holds no stack of subjects"):
        open_stack(tmp_path)


def test_the_common_mask_leaves_out_what_one_lacks(patchy: SubjectStack) -> None:
    cover = patchy.cover()
    face = patchy.texture(6).mask
    assert not cover.mask[5:7].any() and (cover.mask | face == face).all()
    assert cover.left_out == face[5:7].sum() and cover.filled == 0
    assert f"{cover.left_out} are left out because too few subjects have them" in str(cover)


def test_a_share_fills_with_the_mean_of_the_others(patchy: SubjectStack) -> None:
    cover = patchy.cover(share=5 / 7)
    face = patchy.texture(6).mask
    assert cover.mask[5].any() and not cover.mask[6].any()
    assert cover.filled == 2 * face[5].sum() and cover.left_out == face[6].sum()
    (block,) = patchy.read_blocks(cover.mask)
    row = np.flatnonzero(cover.mask) // 20 == 5
    assert np.isfinite(block).all()
    assert np.allclose(block[0][:, row], block[2:][:, :, row].mean(0), atol=1e-7)
    assert np.array_equal(block[6], patchy.texture(6).features()[:, cover.mask.ravel()])


def test_blocks_hold_the_texels_inside(patchy: SubjectStack) -> None:
    mask = patchy.cover(share=5 / 7).mask
    (whole,) = patchy.read_blocks(mask)
    for width in (1, 13, 400):
        blocks = list(patchy.read_blocks(mask, width))
        assert max(block.shape[2] for block in blocks) <= width
        assert np.array_equal(np.concatenate(blocks, 2), whole)
    assert patchy.read_blocks(mask).shape == whole.shape


def test_a_drawn_mask_narrows_the_cover(stack: SubjectStack) -> None:
    drawn = np.zeros((20, 20), bool)
    drawn[8:12, 8:12] = True
    assert np.array_equal(stack.cover(within=drawn).mask, drawn)
    with pytest.raises(InputError, match="No texel is known in 100% of the 7 subjects"):
        stack.cover(within=np.zeros((20, 20), bool))
    with pytest.raises(InputError, match=r"mask is 8 x 8 texels and the subjects of .* 20 x 20"):
        stack.cover(within=np.ones((8, 8), bool))
    for share in (0.0, 1.5, np.nan):
        with pytest.raises(InputError, match="share of subjects"):
            stack.cover(share)


def test_a_mask_where_nobody_has_skin_is_refused(stack: SubjectStack) -> None:
    with pytest.raises(InputError, match="texels of the mask are known in no subject"):
        stack.read_blocks(np.ones((20, 20), bool))
