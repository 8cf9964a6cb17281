"""Small runs of the training command."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from pipeline_scans import SIZE, pigments
from small_runs import list_arguments
from torch.utils.data import default_collate

from skinnet.appearance.colour import SkinColour
from skinnet.appearance.maps_file import save_maps
from skinnet.appearance.skin_texture import SkinTexture
from skinnet.mesh.mesh_file import write_mesh
from skinnet.shape import load_shape_model
from train.batch import Batch
from train.cli import main
from train.synthetic.faces import SyntheticFaces, SyntheticScenes

Fit = Callable[..., int]


@pytest.fixture(scope="session")
def faces(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder of one face with its maps, as `skinnet maps` leaves it."""
    folder = tmp_path_factory.mktemp("faces")
    model = load_shape_model()
    f_mel, f_blood = (one[0].numpy() for one in pigments(1, SIZE))
    known = np.ones((SIZE, SIZE), bool)
    texture = SkinTexture(f_mel, f_blood, np.zeros((SIZE, SIZE, 3), np.float32), known)
    save_maps(folder / "a_maps.npz", texture, SkinColour())
    write_mesh(folder / "a_face.obj", model.build_mesh(np.zeros(1)))
    return folder


@pytest.fixture(scope="session")
def casts(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where the heads of all small runs are kept, so that each is cast once."""
    return tmp_path_factory.mktemp("geometry")


@pytest.fixture(scope="session")
def batch(casts: Path) -> Callable[[int], Batch]:
    """Makes a batch of that many pictures, 32 pixels wide, of one head."""
    data = SyntheticFaces(size=32, heads=1, val_heads=1, geometry=str(casts))
    data.setup("fit")
    scenes = SyntheticScenes(data.buffers["train"], "train", 100, seed=0)
    return lambda count: data.render(default_collate([scenes[i] for i in range(count)]), "train")


@pytest.fixture
def fit_arguments(casts: Path) -> Callable[..., list[str]]:
    """The arguments of a small run of `configs/quick.yaml` in a folder."""
    return lambda folder, *arguments: list_arguments(folder, casts, *arguments)


@pytest.fixture
def fit(fit_arguments: Callable[..., list[str]]) -> Fit:
    """Runs `python -m train fit` on `configs/quick.yaml`, made small, in a folder."""
    return lambda folder, *arguments: main(fit_arguments(folder, *arguments))
