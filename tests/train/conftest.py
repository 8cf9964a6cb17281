"""Small runs of the training command."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from pipeline_scans import SIZE, pigments
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

SMALL = (
    "--model.widths=[4,8]",
    "--data.init_args.size=16",
    "--data.init_args.batch_size=4",
    "--data.init_args.train_samples=16",
    "--data.init_args.val_samples=4",
    "--data.init_args.test_samples=4",
    "--data.init_args.heads=2",
    "--data.init_args.val_heads=1",
    "--data.init_args.test_heads=1",
    "--trainer.precision=32-true",
    "--trainer.accelerator=cpu",
    "--trainer.enable_progress_bar=false",
    "--trainer.enable_model_summary=false",
    "--trainer.log_every_n_steps=1",
    "--model.warmup_steps=2",
)


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
    kept = f"--data.init_args.geometry={casts}"
    return lambda folder, *arguments: [
        *("fit", "--config=configs/quick.yaml", f"--run={folder}", *SMALL, kept, *arguments)
    ]


@pytest.fixture
def fit(fit_arguments: Callable[..., list[str]]) -> Fit:
    """Runs `python -m train fit` on `configs/quick.yaml`, made small, in a folder."""
    return lambda folder, *arguments: main(fit_arguments(folder, *arguments))
