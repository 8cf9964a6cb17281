"""The embedding: no triangle flipped, symmetric, upright, and refused in words."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from benchmarks.texture import make_face_mesh
from skinnet.errors import InputError
from skinnet.texture._flips import count_flipped_triangles
from skinnet.texture._mirror import find_mirror_vertices
from skinnet.texture.tutte import MARGIN, compute_tutte_embedding

VERTICES, TRIANGLES = make_face_mesh(24, 31)


def asymmetry(uv: np.ndarray, mirror: np.ndarray) -> float:
    return float(np.abs(uv[mirror] - [1, 0] - uv * [-1, 1]).max())


@pytest.mark.parametrize("columns", [24, 25])
def test_no_triangle_is_flipped_and_sides_mirror_each_other(columns: int) -> None:
    vertices, triangles = make_face_mesh(columns, 31)
    mirror = find_mirror_vertices(vertices)
    assert mirror is not None
    uv = compute_tutte_embedding(vertices, triangles, mirror)
    assert count_flipped_triangles(uv, triangles) == 0 and asymmetry(uv, mirror) < 1e-12
    middle = mirror == np.arange(len(uv))
    assert middle.any() == (columns == 25) and np.allclose(uv[middle, 0], 0.5, atol=1e-12)


@pytest.mark.parametrize("with_mirror", [True, False])
def test_up_is_up_and_the_right_side_lies_left(with_mirror: bool) -> None:
    uv = compute_tutte_embedding(
        VERTICES, TRIANGLES, find_mirror_vertices(VERTICES) if with_mirror else None
    )
    assert np.corrcoef(uv[:, 0], VERTICES[:, 0])[0, 1] > 0.9
    assert np.corrcoef(uv[:, 1], VERTICES[:, 1])[0, 1] > 0.9
    assert (uv[VERTICES[:, 0] < -10, 0] < 0.5).all()


def test_the_outer_boundary_lies_on_a_circle_by_arc_length() -> None:
    uv = compute_tutte_embedding(VERTICES, TRIANGLES)
    x, y, _ = VERTICES.T
    side = (np.abs(x) == 80) | (np.abs(y) == 110)
    radius = np.linalg.norm(uv - 0.5, axis=1)
    assert np.abs(radius[side] - (0.5 - MARGIN)).max() < 1e-12
    assert (radius[~side] < 0.5 - MARGIN - 1e-6).all()
    right = np.flatnonzero(x == 80)
    length = np.linalg.norm(np.diff(VERTICES[right], axis=0), axis=1)
    chord = np.linalg.norm(np.diff(uv[right], axis=0), axis=1)
    angle = 2 * np.arcsin(chord / 2 / (0.5 - MARGIN))
    assert np.allclose(angle / length, (angle / length)[0], rtol=1e-9)


def test_texture_is_shared_out_more_evenly_than_by_uniform_weights() -> None:
    uv = compute_tutte_embedding(VERTICES, TRIANGLES, find_mirror_vertices(VERTICES))
    a, b, c = np.moveaxis(VERTICES[TRIANGLES], 1, 0)
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    p, q, r = np.moveaxis(uv[TRIANGLES], 1, 0)
    flat = np.abs(np.cross(np.pad(q - p, ((0, 0), (0, 1))), np.pad(r - p, ((0, 0), (0, 1))))[:, 2])
    share = flat / flat.sum() / (area / area.sum())
    assert np.quantile(share, 0.05) > 0.4 and np.quantile(share, 0.95) < 2.5


@given(st.integers(0, 10**6))
def test_any_mesh_with_a_disc_s_topology_keeps_its_orientation(seed: int) -> None:
    rng = np.random.default_rng(seed)
    vertices, triangles = make_face_mesh(9, 11)
    crumpled = vertices + rng.normal(0, 3, vertices.shape)
    swapped = triangles[rng.permutation(len(triangles))]
    uv = compute_tutte_embedding(crumpled, np.roll(swapped, seed % 3, 1))
    assert count_flipped_triangles(uv, triangles) == 0 and 0 < uv.min() and uv.max() < 1


def test_a_nearly_symmetric_mesh_gets_an_exactly_symmetric_embedding() -> None:
    rough = VERTICES + np.random.default_rng(0).normal(0, 0.02, VERTICES.shape)
    mirror = find_mirror_vertices(rough)
    assert mirror is not None
    uv = compute_tutte_embedding(rough, TRIANGLES, mirror)
    assert asymmetry(uv, mirror) < 1e-12 and count_flipped_triangles(uv, TRIANGLES) == 0


@given(st.integers(0, 10**6))
def test_quads_may_be_split_in_any_way(seed: int) -> None:
    vertices, triangles = make_face_mesh(14, 17)
    mirror = find_mirror_vertices(vertices)
    assert mirror is not None
    first, second = np.split(triangles, 2)
    (a, b, c), d = first.T, second[:, 2]
    other = np.random.default_rng(seed).random(len(first)) < 0.5
    first = np.where(other[:, None], np.stack([a, b, d], 1), first)
    second = np.where(other[:, None], np.stack([b, c, d], 1), second)
    triangles = np.concatenate([first, second])
    uv = compute_tutte_embedding(vertices, triangles, mirror)
    assert count_flipped_triangles(uv, triangles) == 0 and asymmetry(uv, mirror) < 1e-12


def test_half_a_quad_on_one_side_of_the_boundary_is_accepted() -> None:
    mirror = find_mirror_vertices(VERTICES)
    assert mirror is not None
    quads = len(TRIANGLES) // 2
    left, right = 5, 17  # of the 23 quads along the top
    notch = [left, left + quads, right + quads]
    triangles = np.delete(TRIANGLES, notch, 0)
    uv = compute_tutte_embedding(VERTICES, triangles, mirror)
    assert count_flipped_triangles(uv, triangles) == 0 and asymmetry(uv, mirror) < 1e-12


def tube() -> tuple[np.ndarray, np.ndarray]:
    """A ring closed in both directions with one triangle missing: a disc with a handle."""
    i, j = np.meshgrid(np.arange(8), np.arange(6), indexing="ij")
    a, b = i * np.pi / 4, j * np.pi / 3
    ring = 3 + np.cos(b)
    vertices = np.stack([ring * np.cos(a), ring * np.sin(a), np.sin(b)], -1).reshape(-1, 3)
    here, next_ = 6 * i + j, 6 * ((i + 1) % 8) + j
    up, both = 6 * i + (j + 1) % 6, 6 * ((i + 1) % 8) + (j + 1) % 6
    triangles = np.concatenate(
        [np.stack([here, next_, both], -1), np.stack([here, both, up], -1)]
    ).reshape(-1, 3)
    return vertices, triangles[1:]


BAD = {
    "separate pieces": (np.tile(VERTICES, (2, 1)), np.r_[TRIANGLES, TRIANGLES + len(VERTICES)]),
    "belong to no triangle": (np.r_[VERTICES, VERTICES[:1] + 1], TRIANGLES),
    "not finite": (np.where(VERTICES == 80, np.nan, VERTICES), TRIANGLES),
    "corners from 0": (VERTICES, TRIANGLES + 1),
    "needs triangles": (VERTICES, TRIANGLES[:0]),
    "handle": tube(),
    "more than two triangles": (VERTICES, np.r_[TRIANGLES, TRIANGLES[:1]]),
    "closed": (np.eye(4)[:, :3], np.array([[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]])),
    "touch": (
        np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0.0]]),
        np.array([[0, 1, 2], [0, 3, 4]]),
    ),
}


@pytest.mark.parametrize("sentence", BAD)
def test_what_is_no_disc_is_refused(sentence: str) -> None:
    with pytest.raises(InputError, match=sentence):
        compute_tutte_embedding(*BAD[sentence])


def test_a_mirror_that_does_not_fit_is_refused() -> None:
    mirror = find_mirror_vertices(VERTICES)
    assert mirror is not None
    with pytest.raises(InputError, match="find_mirror_vertices"):
        compute_tutte_embedding(VERTICES, TRIANGLES, np.roll(mirror, 1))
    # A cut in one side only.
    cut = np.delete(TRIANGLES, 200, 0)
    with pytest.raises(InputError, match="boundary is not its own mirror image"):
        compute_tutte_embedding(VERTICES, cut, mirror)
    with pytest.raises(InputError, match="differs too much from its mirror image"):
        compute_tutte_embedding(VERTICES, TRIANGLES, np.arange(len(VERTICES)))


def test_the_face_of_ict_facekit_is_embedded(shared_data: Path) -> None:
    with np.load(shared_data / "models" / "ict_facekit.npz") as file:
        vertices, triangles = file["verts"][:9409].astype(np.float64), file["tris"].astype(np.int64)
        names = file["landmarks68"]
    triangles = triangles[(triangles < 9409).all(1)]
    mirror = find_mirror_vertices(vertices)
    assert mirror is not None and len(triangles) % 2 == 1  # half a quad too many on one side
    uv = compute_tutte_embedding(vertices, triangles, mirror)
    assert count_flipped_triangles(uv, triangles) == 0 and asymmetry(uv, mirror) < 1e-6
    brow, chin, right, left = uv[names[[27, 8, 36, 45]]]
    assert brow[1] > right[1] > chin[1] and right[0] < 0.5 < left[0]
