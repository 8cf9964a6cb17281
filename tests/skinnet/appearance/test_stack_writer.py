"""The writer of the subject stack resumes and guards its folder."""

import shutil
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from benchmarks.appearance import make_person
from skinnet.appearance import stack_writer
from skinnet.appearance.colour import SkinColour
from skinnet.appearance.skin_texture import SkinTexture
from skinnet.appearance.stack import SubjectStack, open_stack
from skinnet.appearance.stack_writer import write_stack
from skinnet.errors import InputError

Persons = dict[str, Callable[[], SkinTexture]]


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
        with pytest.raises(InputError, match="choose another folder or delete this one"):
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
