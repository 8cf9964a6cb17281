"""Three textured scans, and what the commands make of them."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from pipeline_scans import FAST, SIZE, write_scan

from skinnet.cli import main
from skinnet.pipeline import relight


@pytest.fixture(scope="package", autouse=True)
def small_faces() -> Iterator[None]:
    """Renders the faces on panels small: ray casting would take most of the time of these tests."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(relight, "TILE_SIZE", 48)
        yield


@pytest.fixture(scope="package")
def scans(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder of three scans: a.obj, b.obj and c.obj."""
    folder = tmp_path_factory.mktemp("scans")
    for seed, name in enumerate("abc", 1):
        write_scan(folder / f"{name}.obj", seed)
    return folder


@pytest.fixture(scope="package")
def maps(scans: Path) -> Path:
    """The folder that `skinnet maps` makes of the three."""
    files = [str(scans / f"{name}.obj") for name in "abc"]
    assert main(["maps", *files, *FAST, f"--warp.size={SIZE}"]) == 0
    return scans / "skinmaps"


@pytest.fixture(scope="package")
def model(maps: Path) -> Path:
    """The folder that `skinnet build-model` makes of the three."""
    folder = maps.parent / "skinmodel"
    assert main(["build-model", str(maps), "-o", str(folder), "--appearance.samples=5"]) == 0
    return folder
