"""Stacks of fewer people."""

from collections.abc import Callable
from pathlib import Path

import pytest

from skinnet.appearance.colour import SkinColour
from skinnet.appearance.skin_texture import SkinTexture
from skinnet.appearance.stack import SubjectStack
from skinnet.appearance.stack_writer import write_stack


@pytest.fixture
def without(
    tmp_path: Path, persons: dict[str, Callable[[], SkinTexture]], colour: SkinColour
) -> Callable[[int], SubjectStack]:
    """Makes the stack of everybody but one."""

    def write_others(index: int) -> SubjectStack:
        others = {name: make for i, (name, make) in enumerate(persons.items()) if i != index}
        return write_stack(tmp_path / str(index), others, colour, "people")

    return write_others
