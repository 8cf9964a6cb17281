from pathlib import Path

import pytest

from benchmarks.shaders import BLENDER, ShaderPatches
from benchmarks.webgl_patches import find_chromium, open_webgl

TOLERANCE = 2e-3


@pytest.fixture(scope="module")
def patches(tmp_path_factory: pytest.TempPathFactory) -> ShaderPatches:
    return ShaderPatches(tmp_path_factory.mktemp("patches"))


@pytest.mark.slow
def test_blender_and_osl_show_the_colours_of_the_layer(patches: ShaderPatches) -> None:
    if not BLENDER.exists():
        pytest.skip("Blender is not installed: make blender")
    errors = patches.measure_blender()
    assert errors.keys() == {"blender", "osl"}
    assert max(errors.values()) < TOLERANCE


@pytest.mark.slow
def test_webgl_shows_the_colours_of_the_layer(patches: ShaderPatches) -> None:
    pytest.importorskip("playwright", reason="playwright is not installed")
    if find_chromium() is None:
        pytest.skip("Chromium is not installed: apt-get install chromium")
    with open_webgl() as page:
        assert patches.measure_glsl(page) < TOLERANCE
        assert patches.measure_materialx(page) < TOLERANCE
        assert patches.measure_fps(page, 32, 1) > 0


def test_materialx_finds_no_fault_in_the_document(patches: ShaderPatches, tmp_path: Path) -> None:
    pytest.importorskip("MaterialX", reason="materialx is not installed")
    from benchmarks.materialx_patches import generate, load

    load(patches.folder / "skin.mtlx")
    text = (patches.folder / "skin.mtlx").read_text(encoding="utf-8")
    (tmp_path / "bad.mtlx").write_text(text.replace('nodename="skin"', 'nodename="x"'), "utf-8")
    with pytest.raises(ValueError, match="x"):
        load(tmp_path / "bad.mtlx")
    made = generate(patches.folder / "skin.mtlx", {})
    assert made.textures.keys() == {"table", "melanin", "hemoglobin", "skin", "original"}
