"""Lower bounds are read from every extra."""

from tools.lowest import ROOT, read_lowest_versions


def test_every_bound_of_the_project_is_a_constraint() -> None:
    found = read_lowest_versions(ROOT / "pyproject.toml")
    assert {"numpy", "torch", "lightning", "onnx", "pytest"} <= set(found)
    assert "skinnet" not in found


def test_a_bound_is_the_version_after_the_sign(tmp_path) -> None:
    project = tmp_path / "pyproject.toml"
    project.write_text(
        '[project]\ndependencies = ["a>=1.2"]\n'
        '[project.optional-dependencies]\nmore = ["b[c]>=3.4.post6", "skinnet[more]"]\n'
    )
    assert read_lowest_versions(project) == {"a": "1.2", "b": "3.4.post6"}
