"""Commands that need an extra say how to install it."""

import subprocess
import sys

import pytest

ABSENT_SCAN = "from skinnet.cli import main\nsys.exit(main(['maps', 'absent.obj']))\n"


def run_without(missing: str, code: str) -> "subprocess.CompletedProcess[str]":
    """Run code in a process in which a package is not installed."""
    code = f"import sys\nsys.modules[{missing!r}] = None\n{code}"
    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)


@pytest.mark.parametrize(
    ("package", "missing", "arguments"),
    [("train", "lightning", []), ("export", "onnx", ["absent.ckpt"])],
)
def test_a_missing_extra_is_named(package: str, missing: str, arguments: list[str]) -> None:
    code = (
        "import runpy\n"
        f"sys.argv = [{package!r}, *{arguments!r}]\n"
        f"runpy.run_module({package!r}, run_name='__main__')\n"
    )
    done = run_without(missing, code)
    assert done.returncode == 2
    assert f'pip install -e ".[{package}]"' in done.stderr and "Traceback" not in done.stderr


@pytest.mark.parametrize("missing", ["jsonargparse", "trimesh", "torch"])
@pytest.mark.slow
def test_a_verb_without_the_scans_extra_names_it(missing: str) -> None:
    done = run_without(missing, ABSENT_SCAN)
    assert done.returncode == 2
    assert 'pip install "skinnet[scans]"' in done.stderr and "Traceback" not in done.stderr


@pytest.mark.parametrize("missing", ["colour_checker_detection", "cv2", "colour"])
@pytest.mark.slow
def test_a_chart_without_its_extra_names_it(missing: str) -> None:
    code = (
        "from skimage.data import astronaut\n"
        "from skinnet.inference import CaptureProfile\n"
        "from skinnet.errors import InputError\n"
        "try:\n"
        "    CaptureProfile.from_chart(astronaut())\n"
        "except InputError as error:\n"
        "    print(error)\n"
    )
    done = run_without(missing, code)
    assert 'pip install "skinnet[chart]"' in done.stdout and done.stderr == ""


@pytest.mark.slow
def test_a_verb_needs_no_embree() -> None:
    """It has no wheel for some platforms, and rays are cast without it there."""
    done = run_without("embreex", ABSENT_SCAN)
    assert done.returncode == 2
    assert "absent.obj" in done.stderr and "pip install" not in done.stderr


@pytest.mark.parametrize("missing", ["ray", "pyarrow"])
def test_a_batch_without_the_ray_extra_names_it(missing: str) -> None:
    code = "from skinnet.batch.__main__ import main\nsys.exit(main(['absent', 'out']))\n"
    done = run_without(missing, code)
    assert done.returncode == 2
    assert 'pip install "skinnet[ray]"' in done.stderr and "Traceback" not in done.stderr
