"""Errors of the shaders that `skinnet shader` writes against the Python layer, and their speed.

python -m benchmarks.shaders prints both as JSON. Blender runs in the environment `.venv-blender`.
"""

import json
import subprocess
from collections.abc import Sequence
from contextlib import redirect_stdout
from io import StringIO
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray

from benchmarks.webgl_patches import VERTEX, draw, find_chromium, open_webgl
from skinnet.cli import main as run_skinnet
from skinnet.images._png_file import write_png
from skinnet.physics import SkinReflectance, SpectralCamera, load_camera

BLENDER = Path(__file__).parents[1] / ".venv-blender" / "bin" / "python"
"""Python of the environment that `make blender` makes."""

_LEVELS, _FPS, _SIDE = 65535, 24, 32

CASES: tuple[dict[str, Any], ...] = (
    {"frame": 0, "inputs": {}},
    {
        "frame": 37,
        "inputs": {
            "Melanin Factor": 1.7,
            "Melanin Add": 0.01,
            "Hemoglobin Factor": 0.5,
            "Hemoglobin Add": 0.02,
            "Flush": 0.8,
            "Flush Mask": 0.5,
            "Pulse": 0.4,
            "Pulse Rate": 66.0,
        },
    },
)
"""Frames at 24 a second, and values of the shader's inputs."""

_ORDER = ("Melanin Factor", "Melanin Add", "Hemoglobin Factor", "Hemoglobin Add")
_ORDER = (*_ORDER, "Flush", "Flush Mask", "Pulse", "Pulse Rate")
_UNCHANGED = dict(zip(_ORDER, (1.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 70.0), strict=True))

_FRAGMENT = """#version 300 es
precision highp float;
precision highp sampler2D;
uniform sampler2D table, melanin, hemoglobin;
uniform vec4 pigments, blood;
uniform float time;
in vec2 place;
out vec4 colour;
{function}
void main() {{
  SkinEdit edit = SkinEdit(pigments.x, pigments.y, pigments.z, pigments.w,
                           blood.x, blood.y, blood.z, blood.w, time);
  float f_mel = texture(melanin, place).r, f_blood = texture(hemoglobin, place).r;
  colour = vec4(skin_albedo(table, f_mel, f_blood, vec3(0.0), edit), 1.0);
}}
"""


class ShaderPatches:
    """Maps of random pigments, the shaders that read them, and the colours that are right.

    Args:
        folder: Folder to write to.
        fractions: f_mel and f_blood.
        truth: Linear sRGB of each case, by the Python layer.
    """

    def __init__(self, folder: Path) -> None:
        """Write the maps and the shaders."""
        rng = np.random.default_rng(0)
        largest = {"melanin": 0.43, "hemoglobin": 0.2}
        maps = {name: rng.random((_SIDE, _SIDE)) ** 2 * top for name, top in largest.items()}
        self.folder = folder / "shader"
        self.fractions = {name: _write_map(folder, name, values) for name, values in maps.items()}
        paths = [str(folder / f"{name}.png") for name in maps]
        with redirect_stdout(StringIO()):
            assert run_skinnet(["shader", "-q", *paths, "-o", str(self.folder)]) == 0
        self.truth = [self._compute(case) for case in CASES]

    def _compute(self, case: dict[str, Any]) -> NDArray[np.float64]:
        edit, time = _UNCHANGED | case["inputs"], case["frame"] / _FPS
        wave = 0.5 - 0.5 * np.cos(2 * np.pi * edit["Pulse Rate"] * time / 60)
        blood = 1 + edit["Flush"] * edit["Flush Mask"] + edit["Pulse"] * wave
        f_mel = self.fractions["melanin"] * edit["Melanin Factor"] + edit["Melanin Add"]
        f_blood = self.fractions["hemoglobin"] * edit["Hemoglobin Factor"] + edit["Hemoglobin Add"]
        skin = SkinReflectance(dtype=torch.float64)
        camera = SpectralCamera(mean=load_camera("observer"), dtype=torch.float64)
        given = (torch.from_numpy(each.clip(0, 1)) for each in (f_mel, f_blood * blood))
        colours: NDArray[np.float64] = camera(skin(*given)).detach().numpy()
        return colours

    def find_error(self, pictures: Sequence[NDArray[Any]]) -> float:
        """Find the largest difference from the right colours, in linear sRGB."""
        pairs = zip(pictures, self.truth, strict=True)
        return max(float(np.abs(picture - right).max()) for picture, right in pairs)

    def measure_blender(self) -> dict[str, float]:
        """Measure the errors of the node group and of the OSL shader in Cycles."""
        script, output = Path(__file__).with_name("blender_patches.py"), self.folder / "out.npz"
        cases = self.folder / "cases.json"
        cases.write_text(json.dumps(CASES), encoding="utf-8")
        words = [str(each) for each in (BLENDER, script, self.folder, cases, output)]
        done = subprocess.run(words, capture_output=True, text=True, timeout=600, check=False)
        assert done.returncode == 0, done.stderr
        with np.load(output) as found:
            return {name: self.find_error(found[name]) for name in ("blender", "osl")}

    def measure_glsl(self, page: Any) -> float:
        """Measure the error of the GLSL function in WebGL."""
        return self.find_error([draw(page, *self._make_glsl(case))[0] for case in CASES])

    def measure_fps(self, page: Any, side: int = 1024, frames: int = 10) -> float:
        """Measure the frames per second of the GLSL function."""
        shaders, _, textures, uniforms = self._make_glsl(CASES[1])
        seconds = draw(page, shaders, (side, side), textures, uniforms, frames)[1]
        return frames / seconds

    def _make_glsl(self, case: dict[str, Any]) -> tuple[Any, ...]:
        function = (self.folder / "skin.glsl").read_text(encoding="utf-8")
        edit = list((_UNCHANGED | case["inputs"]).values())
        uniforms = {"pigments": edit[:4], "blood": edit[4:], "time": [case["frame"] / _FPS]}
        textures = {"table": (read_table(self.folder), True)}
        textures |= {name: (each[..., None], False) for name, each in self.fractions.items()}
        return (VERTEX, _FRAGMENT.format(function=function)), (_SIDE, _SIDE), textures, uniforms

    def measure_materialx(self, page: Any) -> float:
        """Measure the error of the MaterialX material as its own generator writes it for WebGL."""
        from benchmarks.materialx_patches import generate

        textures = {"table": (read_table(self.folder), True)}
        textures |= {
            name: (each[..., None] / each.max(), False) for name, each in self.fractions.items()
        }
        pictures = []
        for case in CASES:
            time = {"Time": case["frame"] / _FPS}
            made = generate(self.folder / "skin.mtlx", case["inputs"] | time)
            given = {made.textures[key]: each for key, each in textures.items()}
            pictures.append(draw(page, made.shaders, (_SIDE, _SIDE), given, made.uniforms)[0])
        return self.find_error(pictures)


def read_table(folder: Path) -> NDArray[np.float32]:
    """Read the table's EXR file: linear sRGB [rows, columns, 3]."""
    import OpenImageIO

    file = OpenImageIO.ImageInput.open(str(folder / "skin_table.exr"))
    colours: NDArray[np.float32] = file.read_image("float")
    file.close()
    return colours


def measure_shader_error() -> dict[str, float | None]:
    """Measure the largest error of each target in linear sRGB; None where its tool is missing."""
    found: dict[str, float | None] = dict.fromkeys(("blender", "osl", "glsl", "materialx"))
    with TemporaryDirectory() as folder:
        patches = ShaderPatches(Path(folder))
        if BLENDER.exists():
            found |= patches.measure_blender()
        if find_chromium() is not None:
            with open_webgl() as page:
                found["glsl"] = patches.measure_glsl(page)
                found["materialx"] = patches.measure_materialx(page)
    return found


def measure_glsl_fps() -> float | None:
    """Measure the frames per second of GLSL at 1024 x 1024; None without Chromium."""
    if find_chromium() is None:
        return None
    with TemporaryDirectory() as folder, open_webgl() as page:
        return ShaderPatches(Path(folder)).measure_fps(page)


def _write_map(folder: Path, name: str, values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Write a map of 16 bits, and return the fractions that it holds."""
    scale = float(values.max()) / _LEVELS
    pixels = np.rint(values / scale).astype(np.uint16)
    key = {"melanin": "f_mel", "hemoglobin": "f_blood"}[name]
    text = {"map": key, "scale": repr(scale), "offset": "0.0", "unit": "volume fraction"}
    write_png(folder / f"{name}.png", pixels, text)
    return pixels * scale


if __name__ == "__main__":
    figures = {"shader_error": measure_shader_error(), "glsl_fps": measure_glsl_fps()}
    print(json.dumps(figures, indent=2))
