from pathlib import Path

import numpy as np
import pytest

from skinnet import Decomposer, Decomposition


@pytest.fixture(scope="session")
def decomposer(model_file: Path) -> Decomposer:
    return Decomposer(model_file, threads=1)


@pytest.fixture(scope="session")
def decomposition(decomposer: Decomposer, astronaut: np.ndarray) -> Decomposition:
    return decomposer(astronaut)
