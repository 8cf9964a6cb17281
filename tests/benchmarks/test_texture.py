"""The benchmark of the texture space: its accuracies reach their targets; no time is asserted."""

from benchmarks import texture


def test_texture_reports_its_figures_and_reaches_its_accuracies() -> None:
    found = texture.measure(vertices=1500, size=64, points=20, small=48, uneven=400)
    assert found["vertices"] >= 1400 and found["triangles"] > found["vertices"]
    assert found["flipped"] == 0 and found["asymmetry"] < 1e-6
    assert found["warp_vs_skimage_max_difference"] < 1e-5
    assert found["closest_centroid_error"] > 1e-3 and found["trimesh_inside_out"]
    times = {"mirror_s", "tutte_s", "raster_s", "warp_s", "warp_vs_skimage_speedup"}
    times |= {"closest_s", "closest_centroid_s", "repair_s", "repair_vs_trimesh_speedup"}
    assert all(found[name] > 0 for name in times)


def test_the_mesh_has_the_size_that_is_asked_for() -> None:
    rows = 234
    vertices, triangles = texture.make_face_mesh(rows, rows)
    assert len(vertices) >= texture.VERTICES and len(triangles) >= 105_000
