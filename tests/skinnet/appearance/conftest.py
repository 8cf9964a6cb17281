"""Stacks of fewer people."""

from collections.abc import Callable
from pathlib import Path

import pytest

from skinnet.appearance.colour import SkinColour
from skinnet.appearance.spool import spool
from skinnet.appearance.stack import SubjectStack
from skinnet.appearance.subjects import SkinTexture


@pytest.fixture
def without(
    tmp_path: Path, persons: dict[str, Callable[[], SkinTexture]], colour: SkinColour
) -> Callable[[int], SubjectStack]:
    """Makes the stack of everybody but one."""

    def spooled(index: int) -> SubjectStack:
        others = {name: make for i, (name, make) in enumerate(persons.items()) if i != index}
        return spool(tmp_path / str(index), others, colour, "people")

    return spooled
