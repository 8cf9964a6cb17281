"""The bill of materials has what a plain install brings, with versions and licences."""

import json
from pathlib import Path

import pytest

from skinnet import __version__
from tools import bill_of_materials


def test_the_plain_install_is_listed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("cyclonedx_py")
    monkeypatch.setattr("sys.argv", ["bill_of_materials", str(tmp_path)])
    assert bill_of_materials.main() == 0
    bill = json.loads((tmp_path / f"skinnet-{__version__}.cdx.json").read_text(encoding="utf-8"))
    assert bill["bomFormat"] == "CycloneDX" and bill["metadata"]["component"]["name"] == "skinnet"
    found = {each["name"].lower(): each for each in bill["components"]}
    assert {"numpy", "onnxruntime", "pillow", "scikit-image"} <= found.keys()
    assert not {"torch", "trimesh", "pytest", "cyclonedx-bom"} & found.keys()
    assert all(each["version"] and each["licenses"] for each in found.values())
    references = {each["bom-ref"] for each in bill["components"]}
    assert all(references.issuperset(each["dependsOn"]) for each in bill["dependencies"])
