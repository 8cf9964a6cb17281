"""What is cast from a head, against rays cast one by one."""

import numpy as np
import pytest

from skinnet.mesh.mesh import Mesh
from skinnet.render.scene import Scene
from skinnet.render.views import OrthographicView
from skinnet.render.visibility import trace_geometry
from train.synthetic.bodies.labelled_mesh import (
    LabelledMesh,
    join,
    label_mesh,
    mirror,
    triangulate_grid,
)
from train.synthetic.casts.directions import LIGHT_DIRECTIONS, LOWEST_Z
from train.synthetic.casts.head_cast import HeadCast, cast_head, cast_view
from train.synthetic.labels import BACKGROUND, SKIN

SIZE = 40


@pytest.fixture(scope="module")
def view() -> OrthographicView:
    return OrthographicView((SIZE, SIZE), np.array([0.0, 0, 20]), np.eye(3), 0.6 * SIZE / 2)


@pytest.fixture(scope="module")
def front(head: LabelledMesh, view: OrthographicView) -> HeadCast:
    return _cast(head, view)


def test_directions_are_spread_over_what_lies_ahead() -> None:
    np.testing.assert_allclose(np.linalg.norm(LIGHT_DIRECTIONS, axis=1), 1)
    assert LIGHT_DIRECTIONS.shape == (64, 3) and LIGHT_DIRECTIONS[:, 2].min() > LOWEST_Z
    np.testing.assert_allclose(LIGHT_DIRECTIONS.mean(0), [0, 0, (1 + LOWEST_Z) / 2], atol=0.02)


def test_normals_have_length_one_and_face_the_camera(front: HeadCast) -> None:
    hit = front.label != BACKGROUND
    length = np.linalg.norm(front.normal[hit].astype(float), axis=1)
    np.testing.assert_allclose(length, 127, atol=1.5)
    assert (front.normal[hit][:, 2] > -60).all()


def test_the_background_is_blank_and_open(front: HeadCast) -> None:
    away = front.label == BACKGROUND
    assert away[0].all() and not front.normal[away].any() and not front.chart[away].any()
    assert (front.visibility_mask[away] == ~np.uint64(0)).all()


def test_visibility_is_what_single_rays_find(
    head: LabelledMesh, view: OrthographicView, front: HeadCast
) -> None:
    scene = Scene(Mesh(head.vertices, head.triangles))
    found = trace_geometry(scene, view)
    rows, columns = np.nonzero(found.hit)
    for pixel in range(0, len(rows), 61):
        seen = int(front.visibility_mask[rows[pixel], columns[pixel]])
        for k in range(0, 64, 5):
            facing = found.normal[pixel] @ LIGHT_DIRECTIONS[k] > 0.3
            if not facing or found.face_normal[pixel] @ LIGHT_DIRECTIONS[k] < 0.1:
                continue
            start = scene.to_local(found.shadow_origin[pixel : pixel + 1])
            assert (seen >> k & 1) == (not scene.occluded(start, LIGHT_DIRECTIONS[k : k + 1])[0])


def test_a_wall_hides_its_side_of_the_sky(view: OrthographicView) -> None:
    y, x = np.meshgrid(np.linspace(1, -1, 9), np.linspace(-1, 1, 9), indexing="ij")
    floor = np.stack([x, y, 0 * x], -1).reshape(-1, 3)
    wall = np.stack([0 * x + 0.55, 9 * y, 9 * (x + 1)], -1).reshape(-1, 3)
    triangles = triangulate_grid(9, 9)
    both = join([label_mesh(one, triangles, SKIN, one[:, :2]) for one in (floor, wall)])
    seen = _cast(both, view)
    beside = int(seen.visibility_mask[SIZE // 2, SIZE // 2 + 3])
    for k, (right, _, ahead) in enumerate(LIGHT_DIRECTIONS):
        if ahead > 0.05:
            assert (beside >> k & 1) == (right < 0.02) or abs(right) < 0.1
    assert 110 < seen.sky_visibility[SIZE // 2, SIZE // 2 + 5] < 145


def test_a_mirror_image_is_seen_mirrored(
    head: LabelledMesh, view: OrthographicView, front: HeadCast
) -> None:
    image = _cast(mirror(head), view)
    same = (image.label[:, ::-1] == front.label) & (front.label == SKIN)
    assert same.sum() > 0.95 * (front.label == SKIN).sum()
    off = np.abs(image.chart[:, ::-1].astype(float) * [-1, 1] - front.chart)[same]
    assert np.quantile(off, 0.99) < 0.01


def test_casts_repeat_and_frame_the_head(head: LabelledMesh) -> None:
    one, other = (cast_head(head, np.random.default_rng(3), SIZE) for _ in range(2))
    for a, b in zip(one, other, strict=True):
        np.testing.assert_array_equal(a, b)
    types = [str(a.dtype) for a in one]
    assert types == ["uint8", "int8", "float16", "uint8", "uint64"]
    assert 0.15 < (one.label == SKIN).mean() < 0.6


def _cast(head: LabelledMesh, view: OrthographicView) -> HeadCast:
    return cast_view(head, Scene(Mesh(head.vertices, head.triangles)), view)
