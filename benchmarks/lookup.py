"""Time and error of inverse rendering a whole map, beside a tree of the table's colours.

`python -m benchmarks.lookup [--json]` inverts a 1024 x 1024 float32 map with a table of 256 x 256
nodes. The map is the face of a synthetic head: skin, brows, lashes, nostrils, mouth and any beard,
with a uniform colour cast and with noise, so that no two texels are the same. `NearestColour` is
compared with scipy's cKDTree, which uses two workers, on the same colours. The two take turns in
one process, and the least time of each is reported. `skin` is the same for skin alone, which is on
the table's surface except for noise. That is the best case for a tree.

`posterior` is the time of means and standard deviations of the same map with a table that is kept,
the time that the table takes, and its interpolation error: 99th percentile over skins sampled from
`SkinPrior`, in standard deviations, against the sum over all skins.
"""

import numpy as np
import torch
import torch.nn.functional as F
from jaxtyping import Float, Int
from scipy.spatial import cKDTree
from torch import Tensor

from benchmarks.report import Results, main
from benchmarks.resources import time_least
from skinnet.physics import (
    F_BLOOD_RANGE,
    F_MEL_RANGE,
    NearestColour,
    SkinInverse,
    SkinLookup,
    SkinPrior,
    SkinReflectance,
    load_spectrum_to_srgb,
)
from skinnet.physics._posterior_nodes import PosteriorNodes, tabulate_nodes
from skinnet.physics._posterior_table import PosteriorTable
from train.synthetic.casts.head_cast import make_blank_cast
from train.synthetic.painting.face_painting import FaceCharts, paint_face
from train.synthetic.sampling.scene_sampling import sample_scene
from train.synthetic.scene import map_tensors

SIZE, NODES, ROUNDS, REPEATS = 1024, 256, 2, 3
WORKERS = 2
SEED = 3
FACE = (slice(0.15, 0.85), slice(0.2, 0.8))
"""Rows and columns of the head's texture that show the face, as shares of the whole."""

CAST = (0.004, -0.002, 0.003)
NOISE = 0.003
"""Linear RGB added to the map, and the standard deviation of the noise in white."""

DEVIATIONS, SKINS = (0.005, 0.02), 2000
"""Noise and white balance of the posterior, and number of skins that its error is measured on."""

SAMPLE = 2000
"""Texels that are compared by exhaustive search; the others are compared with the tree."""


@torch.no_grad()
def render_face(lookup: SkinLookup, matrix: Tensor, size: int) -> tuple[Tensor, Tensor]:
    """Render linear RGB [size, size, 3] of a face, and of its skin without brows and beard."""
    rng = np.random.default_rng(SEED)
    scene = sample_scene(rng, make_blank_cast(8).to_buffers())
    charts = paint_face(map_tensors(lambda value: value[None], scene.face))
    rows, columns = (round(size / (part.stop - part.start)) for part in FACE)
    whole = (rows, columns)
    textures = FaceCharts(*(F.interpolate(part, whole, mode="bilinear") for part in charts))
    inside = [
        slice(round(p.start * n), round(p.start * n) + size)
        for p, n in zip(FACE, (rows, columns), strict=True)
    ]
    maps = [value[0].double()[:, *inside].movedim(0, -1) for value in textures[:4]]
    f_mel, f_blood, paint, cover = maps
    skin = torch.cat(
        [
            lookup.reflectance.bands(mel[..., 0], blood[..., 0]) @ matrix
            for mel, blood in zip(f_mel.split(32), f_blood.split(32), strict=True)
        ]
    )
    both = skin * (1 - cover) + paint * cover + torch.tensor(CAST)
    noise = NOISE * torch.from_numpy(rng.normal(0, 1, both.shape))
    # A camera's noise grows with the root of the light.
    noisy = [one + noise * (0.2 + one.clamp_min(0).sqrt()) for one in (both, skin)]
    return noisy[0].float(), noisy[1].float()


def compare_with_tree(
    table: Float[np.ndarray, "mel blood 3"], colours: Float[np.ndarray, "n 3"], rounds: int
) -> Results:
    """Time the building and querying of both, and check that they agree with brute force."""
    nodes = table.reshape(-1, 3)
    ours, tree = NearestColour(table), cKDTree(nodes)
    times: dict[str, list[float]] = {name: [] for name in ("build", "tree_build", "query", "tree")}
    for _ in range(rounds):
        times["build"].append(time_least(lambda: NearestColour(table), 1))
        times["tree_build"].append(time_least(lambda: cKDTree(nodes), 1))
        times["query"].append(time_least(lambda: ours(colours), REPEATS))
        times["tree"].append(time_least(lambda: tree.query(colours, workers=WORKERS), 1))
    seconds = {name: min(values) for name, values in times.items()}
    found = ours(colours)
    return {
        "speedup_vs_kdtree": seconds["tree"] / seconds["query"],
        "speedup_with_building": (seconds["tree"] + seconds["tree_build"])
        / (seconds["query"] + seconds["build"]),
        "same_as_brute_force": check_nearest(nodes, colours, found, tree),
        "query_seconds": seconds["query"],
        "build_seconds": seconds["build"],
        "kdtree_seconds": seconds["tree"],
        "kdtree_build_seconds": seconds["tree_build"],
    }


def check_nearest(
    nodes: Float[np.ndarray, "nodes 3"],
    colours: Float[np.ndarray, "n 3"],
    found: Int[np.ndarray, "n"],
    tree: cKDTree,
) -> bool:
    """Check that every answer is as near as the tree's, and a sample as near as any node."""
    distance = np.linalg.norm(colours - nodes[found], axis=1)
    nearest, index = tree.query(colours, workers=WORKERS)
    sample = np.random.default_rng(0).choice(len(colours), min(SAMPLE, len(colours)), replace=False)
    brute = np.concatenate(
        [
            ((some[:, None] - nodes) ** 2).sum(-1).argmin(1)
            for some in np.array_split(colours[sample].astype(np.float64), len(sample) // 20 + 1)
        ]
    )
    by_tree = (index == found) | (distance <= nearest * (1 + 1e-12))
    by_all = (brute == found[sample]) | (
        distance[sample] <= np.linalg.norm(colours[sample] - nodes[brute], axis=1) * (1 + 1e-12)
    )
    return bool(by_tree.all() and by_all.all())


def measure_round_trip(
    lookup: SkinLookup, matrix: Tensor, inverse: SkinInverse, count: int
) -> Results:
    """Measure errors of fractions recovered from float32 colours, uniform in the table's range."""
    unit = torch.rand(2, count, generator=torch.Generator().manual_seed(0), dtype=torch.float64)
    true = torch.stack([F_MEL_RANGE[1] * unit[0], F_BLOOD_RANGE[1] * unit[1]])
    parts = [lookup.reflectance.bands(*some) @ matrix for some in true.split(2**15, 1)]
    found = inverse(torch.cat(parts).float())
    error = (torch.stack([found.f_mel, found.f_blood]) - true).abs().amax(0).numpy()
    return {
        "round_trip_median": float(np.median(error)),
        "round_trip_p99": float(np.percentile(error, 99)),
        "round_trip_max": float(error.max()),
    }


def measure_posterior(lookup: SkinLookup, matrix: Tensor, rgb: Tensor) -> Results:
    """Measure seconds for a map, with its table and without, and the error of the table."""
    prior, rng = SkinPrior(), torch.Generator().manual_seed(0)
    nodes = tabulate_nodes(lookup.reflectance, matrix, prior, *DEVIATIONS)
    f_mel, f_blood, nuisance, leftover = prior.sample(SKINS, rng)
    colours = (lookup.reflectance.bands(f_mel, f_blood, nuisance) + leftover) @ matrix
    colours += DEVIATIONS[0] * torch.randn(colours.shape, generator=rng, dtype=colours.dtype)
    tabulated = PosteriorTable(nodes)(colours).double()
    errors = []
    for k, (mean, deviation) in zip((0, 3), sum_over_nodes(nodes, colours), strict=True):
        errors.append(((tabulated[k] - mean) / deviation).abs())
    inverse = lookup.inverse(matrix, (2, 2))
    with_table = time_least(lambda: lookup.inverse(matrix, (2, 2)).posterior(rgb, *DEVIATIONS), 3)
    inverse.posterior(rgb[:1], *DEVIATIONS)
    return {
        "seconds": time_least(lambda: inverse.posterior(rgb, *DEVIATIONS), REPEATS),
        "seconds_with_table": with_table,
        "table_seconds": time_least(
            lambda: PosteriorTable(tabulate_nodes(lookup.reflectance, matrix, prior, *DEVIATIONS)),
            REPEATS,
        ),
        "mel_error_p99": float(errors[0].quantile(0.99)),
        "blood_error_p99": float(errors[1].quantile(0.99)),
    }


def sum_over_nodes(nodes: PosteriorNodes, colours: Tensor) -> list[tuple[Tensor, Tensor]]:
    """Mean and standard deviation of f_mel and of f_blood without a table."""
    normal = torch.distributions.MultivariateNormal(nodes.colour, nodes.covariance)
    density = torch.cat([normal.log_prob(part[:, None]) for part in colours.split(100)])
    weights = torch.softmax(nodes.log_prior + density, 1)
    means, squares = weights @ nodes.moments[:, 4::2], weights @ nodes.moments[:, 5::2]
    deviations = (squares - means**2).sqrt()
    return [(means[:, k], deviations[:, k]) for k in (0, 1)]


def measure(size: int = SIZE, nodes: int = NODES, rounds: int = ROUNDS) -> Results:
    """Measure every figure, by name."""
    lookup, matrix = (
        SkinLookup(SkinReflectance(dtype=torch.float64)),
        load_spectrum_to_srgb("D65", "mean"),
    )
    both, skin = render_face(lookup, matrix, size)
    inverse = lookup.inverse(matrix, (nodes, nodes))
    table = inverse.colours.numpy()
    figures, on_skin = (
        compare_with_tree(table, rgb.reshape(-1, 3).numpy(), rounds) for rgb in (both, skin)
    )
    on = inverse(both).on_manifold
    return {
        **figures,
        "seconds": time_least(lambda: inverse(both, refine=False), REPEATS),
        "refined_seconds": time_least(lambda: inverse(both), REPEATS),
        "table_seconds": time_least(lambda: lookup.inverse(matrix, (nodes, nodes)), 1),
        **measure_round_trip(lookup, matrix, inverse, min(size**2, 2**18)),
        "on_manifold": float(on.float().mean()),
        "skin": on_skin,
        "posterior": measure_posterior(lookup, matrix, skin),
    }


if __name__ == "__main__":
    main(measure, "The inverse of a table of skin beside a tree of its colours.")
