"""Small inputs: photographs of an astronaut, and textured scans of the procedural face."""

from pathlib import Path

import numpy as np
import torch
from PIL import Image
from skimage import data

from skinnet.appearance.colour import SkinColour
from skinnet.images import linear_to_srgb, to_uint8
from skinnet.mesh.mesh import Mesh
from skinnet.mesh.mesh_file import write_mesh
from skinnet.shape import load_shape_model
from skinnet.shape.landmarks import write_landmarks


def write_photographs(folder: Path, count: int = 3) -> None:
    """Write photographs of the astronaut, each brighter than the one before."""
    folder.mkdir(parents=True)
    image = Image.fromarray(data.astronaut()).crop((80, 0, 336, 256))
    for index in range(count):
        pixels = np.asarray(image, np.float32) * (0.7 + 0.1 * index)
        Image.fromarray(pixels.astype(np.uint8)).save(folder / f"{'abcdefgh'[index]}.png")


def write_scans(folder: Path, count: int = 3) -> None:
    """Write textured faces of the procedural model with their landmarks, in mm."""
    folder.mkdir(parents=True)
    model = load_shape_model()
    for index in range(count):
        rng = np.random.default_rng(index)
        alpha = rng.normal(size=len(model.variances)) * np.sqrt(model.variances)
        vertices = model.reconstruct(alpha) + [30, -10, 5]
        texture = _draw_skin(index)
        mesh = Mesh(vertices, model.triangles, model.uv, model.uv_triangles, texture)
        write_mesh(folder / f"{'abcdefgh'[index]}.obj", mesh)
        marks = {name: vertices[vertex] for name, vertex in model.landmarks.items()}
        write_landmarks(folder / f"{'abcdefgh'[index]}_landmarks.csv", marks)


def _draw_skin(seed: int, size: int = 64) -> np.ndarray:
    """A picture of skin whose pigments vary smoothly, uint8 sRGB [size, size, 3]."""
    rng = torch.Generator().manual_seed(seed)
    noise = torch.rand(1, 2, 5, 5, generator=rng)
    smooth = torch.nn.functional.interpolate(noise, (size, size), mode="bicubic")[0].clamp(0, 1)
    f_mel = (0.02 + 0.04 * seed) * (0.7 + 0.6 * smooth[:1])
    f_blood = 0.025 + 0.04 * smooth[1:]
    rgb = SkinColour().skin(f_mel.flatten(1), f_blood.flatten(1))[0].unflatten(-1, (size, size))
    return to_uint8(linear_to_srgb(rgb.movedim(0, -1).numpy()))
