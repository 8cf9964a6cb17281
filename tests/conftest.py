"""Shapes are checked, hypothesis is deterministic, and tests without shared data are skipped."""

import gc
import os
from collections.abc import Callable
from pathlib import Path

import pytest
import shape_checks
from hypothesis import settings

# Tensors are small: a second thread would mostly wait, above all on a busy machine.
os.environ.setdefault("OMP_NUM_THREADS", "1")
# Before anything of the package is imported: the hook rewrites modules as they are loaded.
shape_checks.install()

import torch  # noqa: E402

from skinnet.cli import main  # noqa: E402
from skinnet.physics import CAMERA_COMPONENTS, LIGHTS, Capture  # noqa: E402

settings.register_profile(
    "skinnet", deadline=None, max_examples=25, derandomize=True, database=None
)
settings.load_profile("skinnet")

SHARED = Path(__file__).parents[2] / "shared" / "data"


def pytest_runtest_setup() -> None:
    """Check shapes anew in each test."""
    shape_checks.start_test()


def pytest_collection_finish() -> None:
    """Leave what the collected modules hold to no later garbage collection: it costs seconds."""
    gc.collect()
    gc.freeze()


@pytest.fixture(scope="session")
def shared_data() -> Path:
    """The folder of data that the project does not contain."""
    if not SHARED.is_dir():
        pytest.skip("There is no folder ../shared/data beside the repository.")
    return SHARED


@pytest.fixture
def refused(capsys: pytest.CaptureFixture[str]) -> Callable[..., str]:
    """Runs a command that is refused with exit code 2; the sentences on standard error."""

    def run(*arguments: object) -> str:
        capsys.readouterr()
        assert main([str(argument) for argument in arguments]) == 2
        said = capsys.readouterr().err
        assert "Traceback" not in said
        return said

    return run


@pytest.fixture(scope="session")
def random_capture() -> Callable[..., Capture]:
    """Makes captures of a given shape: mixed lights, random cameras, an imperfect white balance."""
    return _random_capture


def _random_capture(
    *shape: int,
    seed: int = 0,
    dtype: torch.dtype = torch.float64,
    components: int = CAMERA_COMPONENTS,
) -> Capture:
    rng = torch.Generator().manual_seed(seed)
    random = [torch.rand(*shape, n, generator=rng, dtype=dtype) for n in (len(LIGHTS), 1)]
    light = -torch.log(random[0])
    return Capture(
        light / light.sum(-1, keepdim=True),
        4000 + 21000 * random[1][..., 0],
        torch.randn(*shape, components, generator=rng, dtype=dtype),
        0.1 * torch.randn(*shape, 2, generator=rng, dtype=dtype),
    )
