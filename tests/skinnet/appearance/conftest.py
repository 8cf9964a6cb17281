"""Seven small people in a stack on disk."""

from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from benchmarks.appearance import person
from skinnet.appearance.colour import SkinColour
from skinnet.appearance.spool import spool
from skinnet.appearance.stack import SubjectStack
from skinnet.appearance.subjects import SkinTexture

COUNT, SIZE = 7, 20


@pytest.fixture(scope="session")
def colour() -> SkinColour:
    """A small table, under a calibration that is not the identity."""
    calibration = np.array([[0.9, 0.05, 0.0], [0.0, 1.1, -0.05], [0.02, 0.0, 0.95]])
    return SkinColour(calibration=calibration, nodes=(24, 16), light="LED-B3", camera="D200")


@pytest.fixture(scope="session")
def persons() -> dict[str, Callable[[], SkinTexture]]:
    return {f"person {seed}": partial(person, SIZE, seed) for seed in range(COUNT)}


@pytest.fixture(scope="session")
def stack(
    tmp_path_factory: pytest.TempPathFactory,
    persons: dict[str, Callable[[], SkinTexture]],
    colour: SkinColour,
) -> SubjectStack:
    folder: Path = tmp_path_factory.mktemp("stack")
    return spool(folder, persons, colour, "people")


@pytest.fixture
def without(
    tmp_path: Path, persons: dict[str, Callable[[], SkinTexture]], colour: SkinColour
) -> Callable[[int], SubjectStack]:
    """Makes the stack of everybody but one."""

    def spooled(index: int) -> SubjectStack:
        others = {name: make for i, (name, make) in enumerate(persons.items()) if i != index}
        return spool(tmp_path / str(index), others, colour, "people")

    return spooled
