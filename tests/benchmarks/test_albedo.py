"""The benchmark of albedo textures: what it prints, at a size that costs little."""

import pytest

from benchmarks import albedo


def test_missing_tools_of_the_shaders_are_null_with_a_reason(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    errors = {"blender": None, "osl": None, "glsl": 1e-4, "materialx": 3e-4}
    monkeypatch.setattr(albedo, "measure_shader_error", lambda: errors)
    monkeypatch.setattr(albedo, "measure_glsl_fps", lambda: None)
    found = albedo.measure_shaders()
    assert found["shader_error"] == 3e-4 and found["glsl_fps"] is None
    assert "blender, osl" in found["shader_reason"] and found["glsl_fps_reason"]
