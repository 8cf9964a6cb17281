"""Models of appearance on disk, with their measures and figures."""

import json
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from skinnet.appearance.hybrid import HybridModel
from skinnet.appearance.joint import JointModel
from skinnet.appearance.linear import LinearModel
from skinnet.appearance.measures import Measures
from skinnet.files import write_text
from skinnet.images._png_file import write_png
from skinnet.mesh.mesh_file import read_mesh
from skinnet.pipeline import relight
from skinnet.pipeline._fit_archive import load_fit
from skinnet.pipeline._model_figures import AlbedoRenderer, draw_hybrid, draw_linear, plot_measures
from skinnet.pipeline._output import MAPS_END, add_end
from skinnet.pipeline._source import Source
from skinnet.render.scene import Scene

_VERB = "build-model"

JOINT = "joint.npz"
MODEL_FILES = (
    *("hybrid.npz", "linear.npz", JOINT, "measures.json"),
    *("measures.png", "components_hybrid.png", "components_linear.png"),
)
"""Names of all files that build-model writes."""


def make_renderer(files: list[Path]) -> AlbedoRenderer | None:
    """Make a renderer of the mean fitted face; None if a mesh or a fit is missing."""
    stems = [file.with_name(file.name.removesuffix(MAPS_END)) for file in files]
    meshes = [add_end(stem, "_face.obj") for stem in stems]
    fits = [add_end(stem, "_shape.npz") for stem in stems]
    if not all(file.is_file() for file in (*meshes, *fits)):
        return None
    archives = [load_fit(file) for file in fits]
    face = read_mesh(meshes[0])
    shapes = [fit.pose.apply_inverse(fit.vertices) for fit in archives]
    if any(shape.shape != face.vertices.shape for shape in shapes):
        return None
    scene = Scene(replace(face, vertices=np.mean(shapes, 0)))
    return partial(relight.RelightSettings(size=relight.TILE_SIZE).render, scene)


def write_models(
    output: Path,
    hybrid: HybridModel,
    linear: LinearModel,
    joint: JointModel | None,
    measures: list[Measures],
    renderer: AlbedoRenderer | None,
    source: Source,
) -> None:
    """Write models, their measures, and figures like Figures 7 and 8 of the paper."""
    components = min(3, *(len(model.statistics.variances) for model in (hybrid, linear)))
    pictures = {
        "hybrid": draw_hybrid(hybrid, components=components, renderer=renderer),
        "linear": draw_linear(linear, components=components, renderer=renderer),
    }
    origin = source.describe(_VERB, "model", output)
    text = source.make_mark(_VERB, "figure").to_text()
    hybrid.save(output / "hybrid.npz", origin)
    linear.save(output / "linear.npz", origin)
    if joint is not None:
        joint.save(output / JOINT, origin)
    plot_measures(output / "measures.png", measures, text)
    for name, picture in pictures.items():
        write_png(output / f"components_{name}.png", picture, text)
    record: dict[str, Any] = {
        **origin,
        "subjects": hybrid.statistics.subjects,
        "texels": int(hybrid.mask.sum()),
        "measures": {one.name: one.summary() for one in measures},
    }
    write_text(output / "measures.json", json.dumps(record, indent=2, allow_nan=False) + "\n")


def describe_measures(measures: list[Measures]) -> str:
    """Describe each model in a few numbers: at three components and at all."""
    lines = []
    for one in measures:
        counts = one.generalisation.counts
        for i in sorted({min(2, len(counts) - 1), len(counts) - 1}):
            count = int(counts[i])
            lines.append(
                f"{one.name} with {count}: {one.compactness[count - 1]:.1%} of the variance, "
                f"generalisation {one.generalisation.mean[i]:.4f}, "
                f"specificity {one.specificity.mean[i]:.4f} (RMS, linear RGB)"
            )
    return "; ".join(lines)
