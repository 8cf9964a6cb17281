"""Every configuration of the classic pipeline runs, made small."""

from pathlib import Path

import pytest
from pipeline_scans import FAST, SIZE

from skinnet.cli import main
from skinnet.pipeline._verbs import PIPELINE_VERBS

pytestmark = pytest.mark.slow

CONFIGS = Path(__file__).parents[3] / "configs"


def test_every_verb_has_a_configuration() -> None:
    assert all((CONFIGS / f"{verb}.yaml").is_file() for verb in PIPELINE_VERBS)


@pytest.mark.parametrize("verb", PIPELINE_VERBS)
def test_a_configuration_runs(
    verb: str, scans: Path, maps: Path, model: Path, tmp_path: Path
) -> None:
    small = {
        "fit-shape": [str(scans / "a.obj"), *FAST],
        "maps": [str(scans / "a.obj"), *FAST, f"--warp.size={SIZE}"],
        "build-model": [str(maps), "--appearance.samples=3"],
        "sample": [str(model / "hybrid.npz"), "--count=2"],
        "edit-maps": [str(maps / "a_maps.npz"), "--relight.size=64"],
        "export-face": [str(maps / "a_maps.npz")],
    }
    if verb == "maps":
        small[verb] += ["--colour.calibration=exposure"]
    command = [verb, "--config", str(CONFIGS / f"{verb}.yaml"), *small[verb], "-o", str(tmp_path)]
    assert main(command) == 0
    assert any(tmp_path.iterdir())
