"""Pictures of a blushing face in Blender, for docs/artists.md.

python -m examples.blushing writes the maps of three synthetic skins and a procedural head, runs
`skinnet shader`, and renders the head by Cycles in the environment that `make blender` makes. The
sheet is blushing.png in the folder, runs/blushing by default.
"""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image
from scipy.ndimage import gaussian_filter, gaussian_filter1d

from skinnet.cli import main as run_skinnet
from skinnet.images._png_file import write_png
from skinnet.mesh import write_mesh
from skinnet.mesh._topology import list_boundary_loops
from skinnet.mesh.mesh import Mesh
from skinnet.shape import load_shape_model

_ROOT = Path(__file__).parents[1]
_TONES = {"light": (0.03, 0.05), "medium": (0.085, 0.05), "dark": (0.26, 0.05)}
"""Volume fractions of melanin and of blood."""

_SIDE, _LEVELS = 1024, 65535
_VIEWS = ("rest", "blushing", "near")
_RIM = 4.0
"""Vertices over which the rim of the head is smoothed."""

_CHEEKS = ((0.36, 0.41), (0.64, 0.41))


def main(folder: Path) -> int:
    """Write maps and head, and render them."""
    folder.mkdir(parents=True, exist_ok=True)
    model = load_shape_model()
    vertices = _smooth_rim(model.mean, model.triangles)
    mesh = Mesh(vertices, model.triangles, model.uv, model.uv_triangles, None, "face")
    write_mesh(folder / "face.obj", mesh)
    places = {name: model.uv[model.landmarks[name]] for name in model.landmarks}
    mask = _draw_flush(places)
    Image.fromarray(np.rint(mask * 255).astype(np.uint8)).save(folder / "mask.png")
    for tone, fractions in _TONES.items():
        _write_skin(folder, tone, fractions, mask)
        maps = [str(folder / f"{tone}_{name}.png") for name in ("melanin", "hemoglobin")]
        words = ["shader", "-q", *maps, "--target", "blender", "--overwrite"]
        if run_skinnet([*words, "-o", str(folder / tone)]):
            return 2
    script = Path(__file__).parent / "in_blender" / "blushing_scene.py"
    blender = _ROOT / ".venv-blender" / "bin" / "python"
    subprocess.run([blender, script, folder, json.dumps([*_TONES])], check=True)
    _compose(folder)
    return 0


def _smooth_rim(vertices: NDArray[np.float64], triangles: NDArray[np.int64]) -> NDArray[np.float64]:
    """Smooth the outer rim, which goes up and down the quads of the model."""
    rim = max(list_boundary_loops(triangles), key=len)
    smooth = vertices.copy()
    smooth[rim] = gaussian_filter1d(vertices[rim], _RIM, axis=0, mode="wrap")
    return smooth


def _compose(folder: Path) -> None:
    """Put the renders of all skins together, a skin a row."""
    rows = [
        np.concatenate([_read(folder / f"{tone}_{name}.png") for name in _VIEWS], 1)
        for tone in _TONES
    ]
    Image.fromarray(np.concatenate(rows)).save(folder / "blushing.png", optimize=True)


def _read(path: Path) -> NDArray[np.uint8]:
    with Image.open(path) as picture:
        return np.asarray(picture.convert("RGB"))


def _draw_flush(places: dict[str, NDArray[np.float64]]) -> NDArray[np.float64]:
    """Draw where blushing shows: both cheeks, and a little the nose and the forehead."""
    v, u = np.mgrid[_SIDE - 0.5 : 0 : -1, 0.5:_SIDE] / _SIDE
    spots = [(*each, 0.085, 1.0) for each in _CHEEKS] + [(0.5, 0.45, 0.045, 0.5)]
    layers = [
        strength * np.exp(-0.5 * ((u - x) ** 2 + (v - y) ** 2) / width**2)
        for x, y, width, strength in spots
    ]
    return np.max(layers, axis=0)


def _write_skin(
    folder: Path, tone: str, fractions: tuple[float, float], mask: NDArray[np.float64]
) -> None:
    """Write maps with the irregular pattern of skin, and more blood where faces are redder."""
    rng = np.random.default_rng(1)
    noise = [_make_noise(rng, width) for width in (2.0, 12.0, 60.0)]
    melanin = fractions[0] * np.exp(0.10 * noise[0] + 0.06 * noise[1] + 0.08 * noise[2])
    noise = [_make_noise(rng, width) for width in (2.0, 12.0, 60.0)]
    blood = fractions[1] * np.exp(0.12 * noise[0] + 0.12 * noise[1] + 0.08 * noise[2])
    maps = {"melanin": melanin, "hemoglobin": blood * (1 + 0.35 * mask)}
    for name, values in maps.items():
        scale = float(values.max()) / _LEVELS
        text = {"map": name, "scale": repr(scale), "offset": "0.0", "unit": "volume fraction"}
        pixels = np.rint(values / scale).astype(np.uint16)
        write_png(folder / f"{tone}_{name}.png", pixels, text)


def _make_noise(rng: np.random.Generator, width: float) -> NDArray[np.float64]:
    """Smooth noise with standard deviation 1."""
    noise = gaussian_filter(rng.standard_normal((_SIDE, _SIDE)), width, mode="wrap")
    return np.asarray(noise / noise.std())


if __name__ == "__main__":
    raise SystemExit(main(Path(sys.argv[1] if sys.argv[1:] else "runs/blushing")))
