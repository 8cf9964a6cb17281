"""Commands that need an extra say how to install it."""

import re
import subprocess
import sys
import tomllib
from importlib.metadata import packages_distributions
from pathlib import Path

import pytest

from skinnet.errors import _EXTRAS, _explain_missing

ABSENT_SCAN = "from skinnet.cli import main\nsys.exit(main(['maps', 'absent.obj']))\n"


def run_without(missing: str, code: str) -> "subprocess.CompletedProcess[str]":
    """Run code in a process in which a package is not installed."""
    code = f"import sys\nsys.modules[{missing!r}] = None\n{code}"
    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)


@pytest.mark.parametrize(
    ("package", "missing", "arguments"),
    [("train", "lightning", ["fit"]), ("export", "onnx", ["absent.ckpt"])],
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


@pytest.mark.parametrize("missing", ["charset_normalizer", "networkx.algorithms"])
def test_a_module_that_no_extra_brings_is_named_itself(missing: str) -> None:
    """To install the extra again would not help."""
    error = ModuleNotFoundError(f"No module named {missing!r}", name=missing)
    sentence = str(_explain_missing(error, "scans", "skinnet maps"))
    assert missing.partition(".")[0] in sentence and "pip install" not in sentence


def test_a_part_of_skinnet_that_is_missing_is_no_missing_extra() -> None:
    with pytest.raises(ModuleNotFoundError):
        _explain_missing(ModuleNotFoundError(name="skinnet.pipeline"), "scans", "skinnet maps")


@pytest.mark.parametrize("extra", sorted(_EXTRAS))
def test_the_modules_of_an_extra_are_those_of_its_packages(extra: str) -> None:
    settings = tomllib.loads(Path("pyproject.toml").read_text(encoding="utf-8"))
    extras = settings["project"]["optional-dependencies"]

    def list_packages(name: str) -> set[str]:
        found = {re.match(r"[\w-]+", each)[0] for each in extras[name]}
        inner = set().union(*(re.findall(r"skinnet\[(.*)\]", each) for each in extras[name]))
        return (found - {"skinnet"}).union(*(list_packages(each) for each in inner))

    brought = {each.lower().replace("_", "-") for each in list_packages(extra)}
    owners = packages_distributions()
    for module in _EXTRAS[extra] - {"cv2"}:  # of a package of the detector of charts
        assert brought & {each.lower().replace("_", "-") for each in owners.get(module, [])}


@pytest.mark.parametrize("missing", ["ray", "pyarrow"])
def test_a_batch_without_the_ray_extra_names_it(missing: str) -> None:
    code = "from skinnet.batch.__main__ import main\nsys.exit(main(['absent', 'out']))\n"
    done = run_without(missing, code)
    assert done.returncode == 2
    assert 'pip install "skinnet[ray]"' in done.stderr and "Traceback" not in done.stderr
