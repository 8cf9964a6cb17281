"""Wrapping: what is seen of a texture stays, and coordinates come into [0, 1]."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from skinnet.errors import InputError
from skinnet.mesh._mesh_parts import MeshGeometry
from skinnet.mesh._sampling import sample_bilinear
from skinnet.mesh._texture_wrap import Mapped, Wrap, wrap_texture

RAMP = np.zeros((8, 64, 3), np.uint8) + (3 * np.arange(64, dtype=np.uint8))[None, :, None]
CORNERS = np.array([[0.1, 0.2], [0.6, 0.2], [0.1, 0.7]])


def part(uv: np.ndarray) -> Mapped:
    triangles = np.arange(len(uv)).reshape(-1, 3)
    return Mapped(MeshGeometry(np.zeros((len(uv), 3)), triangles), np.asarray(uv, np.float64))


def sample(each: Mapped, texture: np.ndarray) -> np.ndarray:
    uv = each.uv[each.geometry.triangles].mean(1)
    return sample_bilinear(texture, uv * [1, -1] + [0, 1])[:, 0]


def test_coordinates_inside_stay_as_they_are() -> None:
    each = part(CORNERS)
    parts, texture = wrap_texture([each], RAMP, (Wrap.REPEAT, Wrap.REPEAT), "a")
    assert parts[0] is each and texture is RAMP
    nothing = part(np.full((3, 2), np.nan))
    assert wrap_texture([nothing], RAMP, (Wrap.REPEAT, Wrap.REPEAT), "a")[0][0] is nothing


@given(st.floats(-9, 9), st.sampled_from(Wrap))
def test_a_ramp_is_seen_as_the_mode_says(shift: float, wrap: Wrap) -> None:
    narrow = CORNERS * [0.02, 0.5] + [shift, 0]
    (each,), texture = wrap_texture([part(narrow)], RAMP, (wrap, Wrap.CLAMP), "a")
    assert each.uv.min() >= 0 and each.uv.max() <= 1
    u = narrow[:, 0].mean()
    wrapped = {
        Wrap.REPEAT: u % 1,
        Wrap.CLAMP: np.clip(u, 0, 1),
        Wrap.MIRROR: 1 - abs(u % 2 - 1),
    }[wrap]
    value = 3 * np.clip(64 * wrapped - 0.5, 0, 63)
    # Across the border of a repeated ramp the texels at its two ends are mixed.
    near = wrap is Wrap.REPEAT and min(wrapped, 1 - wrapped) < 0.02
    assert near or abs(sample(each, texture)[0] - value) <= 2


def test_the_texture_grows_only_as_far_as_needed() -> None:
    across = CORNERS + [0.5, 0]
    parts, texture = wrap_texture([part(across)], RAMP, (Wrap.REPEAT, Wrap.REPEAT), "a")
    assert texture.shape == (8, 64 + 7, 3)
    assert np.array_equal(texture[:, 64:], RAMP[:, :7])
    moved = part(CORNERS + [7, -3])
    parts, texture = wrap_texture([moved], RAMP, (Wrap.REPEAT, Wrap.REPEAT), "a")
    assert texture.shape == RAMP.shape
    assert np.allclose(parts[0].uv[parts[0].geometry.triangles[0]], CORNERS)


def test_vertices_in_two_tiles_are_repeated_after_the_others() -> None:
    uv = np.array([[0.0, 0], [1, 0], [1, 1], [2, 0]])
    triangles = np.array([[0, 1, 2], [1, 3, 2]])
    each = Mapped(MeshGeometry(np.arange(12.0).reshape(4, 3), triangles), uv)
    (moved,), _ = wrap_texture([each], RAMP, (Wrap.REPEAT, Wrap.REPEAT), "a")
    assert np.array_equal(moved.geometry.vertices[:4], each.geometry.vertices)
    positions = moved.geometry.vertices[moved.geometry.triangles]
    assert np.array_equal(positions, each.geometry.vertices[triangles])
    found = moved.uv[moved.geometry.triangles]
    assert np.allclose(found, [[[0, 0], [1, 0], [1, 1]], [[0, 0], [1, 0], [0, 1]]])


def test_a_texture_is_not_repeated_without_end() -> None:
    with pytest.raises(InputError, match=r"a\.glb has faces that repeat their texture"):
        wrap_texture([part(CORNERS * 1e6)], RAMP, (Wrap.REPEAT, Wrap.REPEAT), "a.glb")
