import json
import subprocess
import sys
from pathlib import Path

import pytest

import skinnet

NAMES = json.loads((Path(__file__).parents[1] / "public_names.json").read_text())
NO_TORCH = {"Decomposer", "Decomposition", "InputError"}
HEAVY = {"torch", "numpy", "onnxruntime", "PIL", "skimage", "scipy", "kornia", "jaxtyping"}

BLOCKER = """
import sys

class Blocker:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in {"torch", "kornia", "jaxtyping", "safetensors"}:
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)

sys.meta_path.insert(0, Blocker())
"""


def run(program: str) -> str:
    """What the program prints in a Python of its own; there is no type checking in it."""
    command = [sys.executable, "-W", "error", "-c", program]
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def test_the_public_names_are_the_listed_ones() -> None:
    assert sorted(skinnet.__all__) == NAMES
    assert len(NAMES) <= 15
    assert set(NAMES) < set(dir(skinnet))


@pytest.mark.parametrize("name", NAMES)
def test_every_public_name_is_there(name: str) -> None:
    assert getattr(skinnet, name).__name__ == name


def test_other_names_are_not_there() -> None:
    with pytest.raises(AttributeError, match=r"No skinnet attribute Skin$"):
        _ = skinnet.Skin


def test_the_package_and_its_command_import_nothing_heavy() -> None:
    loaded = run("import sys, skinnet, skinnet.cli; print(*sys.modules)").split()
    assert not HEAVY & set(loaded)


def test_the_runtime_imports_no_torch() -> None:
    loaded = run("import sys; from skinnet import Decomposer; print(*sys.modules)").split()
    assert "skinnet.inference.decomposer" in loaded
    assert not {"torch", "kornia", "jaxtyping", "safetensors"} & set(loaded)


def test_without_torch_its_names_say_what_to_install() -> None:
    torch_names = [name for name in NAMES if name not in NO_TORCH]
    program = f"""{BLOCKER}
import skinnet
from skinnet import Decomposer, Decomposition, InputError
for name in {torch_names}:
    try:
        getattr(skinnet, name)
    except ImportError as error:
        print(error)
"""
    assert run(program).splitlines() == [
        f'skinnet.{name} needs the torch extra: pip install "skinnet[torch]"'
        for name in torch_names
    ]


def test_another_missing_module_is_not_blamed_on_the_extra() -> None:
    program = """
import sys
sys.modules["onnxruntime"] = None
import skinnet
try:
    skinnet.Decomposer
except ImportError as error:
    print(error.name)
"""
    assert run(program).strip() == "onnxruntime"
