"""A scan's texture on a fitted model: right where it is, masked where it is not."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.texture import make_face_mesh
from skinnet.errors import InputError
from skinnet.images import srgb_to_linear
from skinnet.mesh.mesh import Mesh
from skinnet.texture.projection import project_texture
from skinnet.texture.warp import TextureSpace, WarpedTexture

SIZE = 64


def flat(columns: int, rows: int, width: float = 1.0) -> Mesh:
    """The square from 0 to `width` in the plane z = 0, its texture coordinates x / width and y."""
    x, y = np.meshgrid(np.linspace(0, 1, columns), np.linspace(0, 1, rows))
    number = np.arange(x.size).reshape(x.shape)
    a, b, c, d = number[:-1, :-1], number[:-1, 1:], number[1:, 1:], number[1:, :-1]
    triangles = np.concatenate([np.stack([a, b, c], -1), np.stack([a, c, d], -1)]).reshape(-1, 3)
    uv = np.stack([x.ravel(), y.ravel()], 1)
    vertices = np.stack([width * x.ravel(), y.ravel(), np.zeros(x.size)], 1)
    ramp = np.linspace(0, 255, 128).astype(np.uint8)
    texture = np.stack([*np.meshgrid(ramp, ramp[::-1]), np.full((128, 128), 99, np.uint8)], -1)
    return Mesh(vertices, triangles, uv, triangles, texture, "plane")


def move(mesh: Mesh, *by: float) -> Mesh:
    return replace(mesh, vertices=mesh.vertices * [0.8, 0.8, 1] + by)


def project(
    fitted: Mesh, scan: Mesh, max_distance: float = 0.1, max_angle: float = 60.0
) -> WarpedTexture:
    assert fitted.uv is not None and fitted.uv_triangles is not None
    space = TextureSpace(fitted.uv, fitted.uv_triangles, SIZE)
    return project_texture(space, fitted, scan, max_distance, max_angle)


def expected(scan: Mesh, by: tuple[float, float], scale: float = 0.8) -> np.ndarray:
    """The ramps under the texels of a model that covers `scale` of the plane from `by` on."""
    centre = (np.arange(SIZE) + 0.5) / SIZE * scale
    u, v = np.meshgrid(centre + by[0], centre[::-1] + by[1])
    return srgb_to_linear((np.stack([u, v], -1) * 128 - 0.5).clip(0, 127) / 127)


def test_the_texture_under_the_model_is_found() -> None:
    image, mask = project(move(flat(9, 7), 0.1, 0.05, 0.02), flat(16, 13))
    assert mask.all()
    assert np.abs(image[..., :2] - expected(flat(2, 2), (0.1, 0.05))).max() < 0.01
    assert np.allclose(image[..., 2], srgb_to_linear(np.array([99], np.uint8)), atol=1e-6)


def test_nothing_is_invented_beyond_the_scan() -> None:
    scan, fitted = flat(16, 13), move(flat(21, 21), 0.5, 0.1, 0.0)
    image, mask = project(fitted, scan, max_distance=10.0)
    inside = 0.5 + 0.8 * (np.arange(SIZE) + 0.5) / SIZE < 1
    # Per texel, not per triangle: the mask ends where the scan does.
    assert np.array_equal(mask, np.tile(inside, (SIZE, 1)))
    assert (image[~mask] == 0).all()
    assert np.abs(image[..., :2] - expected(scan, (0.5, 0.1)))[mask].max() < 0.01


@pytest.mark.parametrize(
    ("fitted", "max_distance", "covered"),
    [
        (move(flat(5, 5), 0.1, 0.1, 0.3), 0.2, False),
        (move(flat(5, 5), 0.1, 0.1, 0.3), 0.4, True),
        (
            replace(move(flat(5, 5), 0.1, 0.1, 0.0), triangles=flat(5, 5).triangles[:, ::-1]),
            1.0,
            False,
        ),
    ],
)
def test_far_and_flipped_surfaces_do_not_count(
    fitted: Mesh, max_distance: float, covered: bool
) -> None:
    if not covered and max_distance == 1.0:
        fitted = replace(fitted, uv_triangles=fitted.triangles)
    _, mask = project(fitted, flat(9, 9), max_distance)
    assert mask.all() if covered else not mask.any()


def cut_texture(mesh: Mesh) -> Mesh:
    """The same plane whose texture is cut at x = 1/2 into two charts that have changed places."""
    assert mesh.uv is not None and mesh.texture is not None
    right = mesh.vertices[mesh.triangles].mean(1)[:, 0] > 0.5
    uv = np.concatenate([mesh.uv + [0.5, 0], mesh.uv - [0.5, 0]])
    uv_triangles = mesh.triangles + len(mesh.uv) * right[:, None]
    texture = np.roll(mesh.texture, 64, 1)
    return replace(mesh, uv=uv, uv_triangles=uv_triangles, texture=texture)


def test_triangles_across_a_seam_take_each_texel_from_its_own_chart() -> None:
    # 17 columns put a seam of the scan at x = 1/2; the model's 4 columns straddle it.
    image, mask = project(move(flat(4, 4), 0.1, 0.1, 0.0), cut_texture(flat(17, 9)))
    assert mask.all()
    difference = np.abs(image[..., :2] - expected(flat(2, 2), (0.1, 0.1)))
    seam = np.abs(0.1 + 0.8 * (np.arange(SIZE) + 0.5) / SIZE - 0.5) < 1 / 128
    assert difference[:, ~seam].max() < 0.01


def test_triangles_across_a_cut_inside_one_chart_do_too() -> None:
    cut = cut_texture(flat(17, 9))
    assert cut.uv is not None and cut.uv_triangles is not None
    # A sliver of texture far from both joins the charts into one island.
    bridge = np.array([[0, len(cut.uv) - 1, 1]])
    vertices = np.concatenate([cut.vertices, [[9.0, 9, 9], [9, 9, 10], [9, 10, 9]]])
    added = np.arange(3)[None] + len(cut.vertices)
    joined = replace(
        cut,
        vertices=vertices,
        triangles=np.concatenate([cut.triangles, added]),
        uv_triangles=np.concatenate([cut.uv_triangles, bridge]),
    )
    image, mask = project(move(flat(4, 4), 0.1, 0.1, 0.0), joined)
    difference = np.abs(image[..., :2] - expected(flat(2, 2), (0.1, 0.1)))
    seam = np.abs(0.1 + 0.8 * (np.arange(SIZE) + 0.5) / SIZE - 0.5) < 1 / 128
    assert mask.all() and difference[:, ~seam].max() < 0.01


def test_a_curved_scan_textures_the_model_made_from_it() -> None:
    vertices, triangles = make_face_mesh(40, 51)
    uv = 0.5 + vertices[:, :2] / [180, 240]
    texture = flat(2, 2).texture
    scan = Mesh(vertices, triangles, uv, triangles, texture, "scan")
    image, mask = project(replace(scan, texture=None), scan, max_distance=1.0)
    space = TextureSpace(uv, triangles, SIZE)
    # The rim and the edges of the holes are the scan's boundary.
    assert mask.sum() > 0.85 * space.mask.sum() and (space.mask | ~mask).all()
    place = space.interpolate(uv)[mask]
    ramps = srgb_to_linear((place * 128 - 0.5).clip(0, 127) / 127)
    assert np.abs(image[mask][:, :2] - ramps).max() < 0.02


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"uv": None}, "plane has no texture coordinates"),
        ({"uv_triangles": None}, "plane has no texture coordinates"),
        ({"texture": None}, "plane has no texture; give the picture"),
    ],
)
def test_a_scan_without_texture_is_refused(change: dict[str, None], sentence: str) -> None:
    with pytest.raises(InputError, match=sentence):
        project(flat(3, 3), replace(flat(3, 3), **change))


def test_a_texture_space_of_another_model_is_refused() -> None:
    other = flat(4, 4)
    assert other.uv is not None
    with pytest.raises(InputError, match="8 triangles and the texture space 18"):
        project_texture(TextureSpace(other.uv, other.triangles, 8), flat(3, 3), flat(3, 3), 1.0)
