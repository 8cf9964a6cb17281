"""Textured scans of faces of the procedural model, whose pigments are known."""

from pathlib import Path

import numpy as np
import torch
from scipy.spatial.transform import Rotation

from skinnet.appearance.colour import SkinColour
from skinnet.images import linear_to_srgb, to_uint8
from skinnet.mesh.mesh import Mesh
from skinnet.mesh.mesh_file import write_mesh
from skinnet.shape import load_shape_model
from skinnet.shape.landmarks import write_landmarks

SIZE = 48
FAST = ("--fit.stages", "[[500, 10, 30.0], [2000, 0, 0.1]]")
"""Options that make a fit quick."""


def pigments(seed: int, size: int = 64) -> tuple[torch.Tensor, torch.Tensor]:
    """Make smooth maps of melanin and hemoglobin over a texture [1, n, n]."""
    rng = torch.Generator().manual_seed(seed)
    noise = torch.rand(2, 1, 5, 5, generator=rng)
    smooth = torch.nn.functional.interpolate(noise, (size, size), mode="bicubic")[:, 0].clamp(0, 1)
    base = 0.02 + 0.04 * seed
    return base * (0.7 + 0.6 * smooth[:1]), 0.025 + 0.04 * smooth[1:]


def write_scan(path: Path, seed: int, scale: float = 1.0) -> None:
    """Write a textured face with its landmarks, rotated a little; `scale` is units a mm."""
    model = load_shape_model()
    rng = np.random.default_rng(seed)
    alpha = rng.normal(size=len(model.variances)) * np.sqrt(model.variances)
    rotation = Rotation.from_rotvec([0.02, 0.1 * seed, 0.0]).as_matrix()
    vertices = scale * (model.reconstruct(alpha) @ rotation.T + [30, -10, 5])
    f_mel, f_blood = pigments(seed)
    rgb = SkinColour().skin(f_mel.flatten(1), f_blood.flatten(1))[0].unflatten(-1, (64, 64))
    texture = to_uint8(linear_to_srgb(rgb.movedim(0, -1).numpy()))
    mesh = Mesh(vertices, model.triangles, model.uv, model.uv_triangles, texture)
    write_mesh(path, mesh)
    marks = {name: vertices[vertex] for name, vertex in model.landmarks.items()}
    write_landmarks(path.with_name(f"{path.stem}_landmarks.csv"), marks)
