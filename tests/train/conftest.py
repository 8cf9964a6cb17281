"""Small runs of the training command."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from pipeline_scans import SIZE, pigments

from skinnet.appearance.colour import SkinColour
from skinnet.appearance.mapsfile import save_maps
from skinnet.appearance.subjects import SkinTexture
from skinnet.shape.default import default_model
from skinnet.shape.meshfile import write_mesh
from train.cli import main

Fit = Callable[..., int]

SMALL = (
    "--model.widths=[4,8]",
    "--data.init_args.size=16",
    "--data.init_args.batch_size=4",
    "--data.init_args.train_samples=16",
    "--data.init_args.val_samples=4",
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
    model = default_model()
    f_mel, f_blood = (one[0].numpy() for one in pigments(1, SIZE))
    known = np.ones((SIZE, SIZE), bool)
    texture = SkinTexture(f_mel, f_blood, np.zeros((SIZE, SIZE, 3), np.float32), known)
    save_maps(folder / "a_maps.npz", texture, SkinColour())
    write_mesh(folder / "a_face.obj", model.mesh(np.zeros(1)))
    return folder


@pytest.fixture
def fit_arguments() -> Callable[..., list[str]]:
    """The arguments of a small run of `configs/quick.yaml` in a folder."""
    return lambda folder, *arguments: [
        *("fit", "--config=configs/quick.yaml", f"--run={folder}", *SMALL, *arguments)
    ]


@pytest.fixture
def fit(fit_arguments: Callable[..., list[str]]) -> Fit:
    """Runs `python -m train fit` on `configs/quick.yaml`, made small, in a folder."""
    return lambda folder, *arguments: main(fit_arguments(folder, *arguments))
