"""People are spooled one at a time, resumed, guarded, and read back under a common mask."""

import json
import shutil
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest
import torch

from benchmarks.appearance import make_person
from skinnet.appearance import stack_writer
from skinnet.appearance.colour import SkinColour
from skinnet.appearance.skin_texture import SkinTexture
from skinnet.appearance.stack import SubjectStack, open_stack
from skinnet.appearance.stack_writer import write_stack
from skinnet.errors import InputError

Persons = dict[str, Callable[[], SkinTexture]]


def without_texels(texture: SkinTexture, rows: slice) -> SkinTexture:
    mask = texture.mask.copy()
    mask[rows] = False
    f_mel = np.where(mask, texture.f_mel, np.float32(np.nan))
    return replace(texture, mask=mask, f_mel=f_mel)


@pytest.fixture
def patchy(tmp_path: Path, persons: Persons, colour: SkinColour) -> SubjectStack:
    """Persons 0 and 1 lack rows 5 and 6, person 2 lacks row 6."""
    cut = {"person 0": slice(5, 7), "person 1": slice(5, 7), "person 2": slice(6, 7)}
    subjects = {
        name: partial(without_texels, make(), cut.get(name, slice(0, 0)))
        for name, make in persons.items()
    }
    return write_stack(tmp_path / "patchy", subjects, colour, "patchy")


def test_a_subject_comes_back_as_it_was(stack: SubjectStack, persons: Persons) -> None:
    given, found = persons["person 3"](), stack.texture(3)
    assert found.name == "person 3" and np.array_equal(found.mask, given.mask)
    for name in ("f_mel", "f_blood", "offset"):
        inside = getattr(given, name)[given.mask]
        assert np.array_equal(getattr(found, name)[given.mask], inside)


def test_albedo_is_skin_and_offset(stack: SubjectStack, colour: SkinColour) -> None:
    face = stack.texture(0)
    f_mel, f_blood = (torch.from_numpy(m.ravel()) for m in (face.f_mel, face.f_blood))
    skin = colour.skin(f_mel, f_blood).numpy().T.reshape(*face.mask.shape, 3)
    albedo = face.albedo(colour)
    assert np.allclose(albedo[face.mask], (skin + face.offset)[face.mask])
    assert (albedo[~face.mask] == 0).all()


def test_interrupted_work_goes_on_where_it_was(
    tmp_path: Path, persons: Persons, colour: SkinColour, stack: SubjectStack
) -> None:
    made: list[str] = []

    def noted(name: str, fails: bool) -> SkinTexture:
        if fails:
            raise InputError(f"{name} has no skin.")
        made.append(name)
        return persons[name]()

    failing = {name: partial(noted, name, name == "person 4") for name in persons}
    with pytest.raises(InputError, match="person 4 has no skin"):
        write_stack(tmp_path, failing, colour, "people")
    with pytest.raises(InputError, match="holds 4 of 7 subjects; run the command"):
        open_stack(tmp_path)
    resumed = write_stack(
        tmp_path, {name: partial(noted, name, False) for name in persons}, colour, "people"
    )
    assert made == list(persons)
    for name in ("features.npy", "masks.npy"):
        assert (tmp_path / name).read_bytes() == (stack.folder / name).read_bytes()
    write_stack(tmp_path, failing, colour, "people")
    assert made == list(persons) and resumed.names == tuple(persons)


def test_another_stack_is_not_written_over(
    stack: SubjectStack, persons: Persons, colour: SkinColour
) -> None:
    before = (stack.folder / "features.npy").read_bytes()
    fewer = dict(list(persons.items())[:3])
    others = SkinColour(nodes=(24, 16))
    for subjects, seen, inputs in (
        (persons, colour, "others"),
        (fewer, colour, "people"),
        (persons, others, "people"),
    ):
        with pytest.raises(InputError, match="choose another folder or delete it"):
            write_stack(stack.folder, subjects, seen, inputs)
    assert (stack.folder / "features.npy").read_bytes() == before


def test_lost_arrays_are_made_again(
    tmp_path: Path, stack: SubjectStack, persons: Persons, colour: SkinColour
) -> None:
    shutil.copytree(stack.folder, tmp_path / "copy")
    (tmp_path / "copy" / "masks.npy").write_bytes(b"\x93NUMPY")
    with pytest.raises(InputError, match="are damaged; delete the folder, make it again"):
        open_stack(tmp_path / "copy")
    found = write_stack(tmp_path / "copy", persons, colour, "people")
    assert np.array_equal(found.texture(6).f_mel, stack.texture(6).f_mel)


def test_resolutions_must_agree(tmp_path: Path, persons: Persons, colour: SkinColour) -> None:
    mixed = dict(persons) | {"big": partial(make_person, 32, 9)}
    with pytest.raises(InputError, match="big has 32 texels a side and the subjects before it 20"):
        write_stack(tmp_path, mixed, colour, "mixed")


def test_one_subject_is_no_sample(tmp_path: Path, persons: Persons, colour: SkinColour) -> None:
    with pytest.raises(InputError, match="at least two subjects; got 1"):
        write_stack(tmp_path / "x", {"person 0": persons["person 0"]}, colour, "")
    assert not (tmp_path / "x").exists()


def test_a_full_disk_is_noticed_before(
    tmp_path: Path, persons: Persons, colour: SkinColour, monkeypatch: pytest.MonkeyPatch
) -> None:
    usage = shutil.disk_usage(tmp_path)._replace(free=1000)
    monkeypatch.setattr(stack_writer.shutil, "disk_usage", lambda _: usage)
    with pytest.raises(InputError, match=r"7 subjects of 20 x 20 texels take 0\.0 GB"):
        write_stack(tmp_path, persons, colour, "")


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
    assert f"{cover.left_out} that too few subjects have are left out" in str(cover)


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


def test_columns_come_in_blocks_of_the_texels_inside(patchy: SubjectStack) -> None:
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


@pytest.mark.parametrize(("name", "value", "sentence"), [
    ("f_mel", 12.3, "person 0: f_mel is a volume fraction .* got 12.3. Was it given in percent"),
    ("f_blood", -0.1, "person 0: f_blood is a volume fraction .* got -0.1"),
    ("f_blood", np.nan, "person 0: f_blood has a known texel that is not finite"),
    ("offset", np.inf, "person 0: offset has a known texel that is not finite"),
])  # fmt: skip
def test_textures_that_are_not_skin_are_refused(name: str, value: float, sentence: str) -> None:
    face = make_person(20, 0)
    spoilt = getattr(face, name).copy()
    spoilt[10, 10] = value
    with pytest.raises(InputError, match=sentence):
        replace(face, **{name: spoilt})
