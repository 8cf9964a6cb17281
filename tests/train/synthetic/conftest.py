"""Small synthetic heads of both kinds, and small scenes."""

from pathlib import Path

import numpy as np
import pytest
from torch.utils.data import default_collate

from train.synthetic.bodies.ict_model import IctModel, read_ict_model
from train.synthetic.bodies.labelled_mesh import LabelledMesh
from train.synthetic.faces import SyntheticFaces, SyntheticScenes
from train.synthetic.scene import SceneParameters
from train.synthetic.subjects.heads import make_ict_head, make_procedural_head


@pytest.fixture(scope="session")
def ict_file(shared_data: Path) -> Path:
    path = shared_data / "models" / "ict_facekit.npz"
    if not path.is_file():
        pytest.skip("There is no ../shared/data/models/ict_facekit.npz.")
    return path


@pytest.fixture(scope="session")
def ict_model(ict_file: Path) -> IctModel:
    return read_ict_model(ict_file)


@pytest.fixture(scope="session")
def head() -> LabelledMesh:
    return make_procedural_head(np.random.default_rng(6))


@pytest.fixture(scope="session")
def ict(ict_model: IctModel) -> LabelledMesh:
    return make_ict_head(ict_model, np.random.default_rng(1))


@pytest.fixture(scope="session")
def data(casts: Path) -> SyntheticFaces:
    data = SyntheticFaces(size=32, heads=2, val_heads=1, test_heads=1, geometry=str(casts))
    for stage in ("fit", "test"):
        data.setup(stage)
    return data


@pytest.fixture(scope="session")
def scene(data: SyntheticFaces) -> SceneParameters:
    """A batch of six scenes."""
    scenes = SyntheticScenes(data.buffers["train"], "train", 6, seed=3)
    batch: SceneParameters = default_collate([scenes[index] for index in range(6)])
    return batch
