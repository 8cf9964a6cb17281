"""Small synthetic heads of both kinds."""

from pathlib import Path

import numpy as np
import pytest

from train.synthetic.heads import Head, ict_head, procedural_head
from train.synthetic.ict_model import IctHead, load_ict_head


@pytest.fixture(scope="session")
def ict_file(shared_data: Path) -> Path:
    path = shared_data / "models" / "ict_facekit.npz"
    if not path.is_file():
        pytest.skip("There is no ../shared/data/models/ict_facekit.npz.")
    return path


@pytest.fixture(scope="session")
def ict_model(ict_file: Path) -> IctHead:
    return load_ict_head(ict_file)


@pytest.fixture(scope="session")
def head() -> Head:
    return procedural_head(np.random.default_rng(6))


@pytest.fixture(scope="session")
def ict(ict_model: IctHead) -> Head:
    return ict_head(ict_model, np.random.default_rng(1))
