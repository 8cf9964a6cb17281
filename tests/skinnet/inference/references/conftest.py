from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from benchmarks.chart_pictures import View, photograph
from skinnet.inference import CaptureProfile
from skinnet.inference._references.chart import Chart, load_chart

VIEW = View(
    "D55", 3, tilt=20, axis=40, roll=8, balance=(0.1, -0.15), exposure=0.55, contrast=0.14, bend=0.5
)
"""A photograph of a chart with a tone curve."""


@pytest.fixture(scope="session")
def classic() -> Chart:
    return load_chart("classic")


@pytest.fixture(scope="session")
def shot_view() -> View:
    return VIEW


@pytest.fixture(scope="session")
def shot() -> np.ndarray:
    return photograph(VIEW)


@pytest.fixture(scope="session")
def chart_file(shot: np.ndarray, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("chart") / "chart.png"
    Image.fromarray(shot).save(path)
    return path


@pytest.fixture(scope="session")
def profile(chart_file: Path) -> CaptureProfile:
    return CaptureProfile.from_chart(chart_file)
