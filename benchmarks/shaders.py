"""Errors of the shaders that `skinnet shader` writes against the Python layer, and their speed.

python -m benchmarks.shaders prints both as JSON. Blender runs in the environment `.venv-blender`.
"""

import json
import subprocess
from collections.abc import Sequence
from contextlib import redirect_stderr, redirect_stdout
from io import StringIO
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import torch
from imagecodecs import png_encode
from numpy.typing import NDArray

from benchmarks.webgl_patches import VERTEX, draw, find_chromium, open_webgl
from skinnet.cli import main as run_skinnet
from skinnet.images.srgb import linear_to_srgb, srgb_to_linear
from skinnet.material import AlbedoColour
from skinnet.material._map_files import WHITES
from skinnet.physics import SkinReflectance, SpectralCamera, load_camera

BLENDER = Path(__file__).parents[1] / ".venv-blender" / "bin" / "python"
"""Python of the environment that `make blender` makes."""

_LEVELS, _FPS, _SIDE = 65535, 24, 32

CASES: tuple[dict[str, Any], ...] = (
    {"frame": 0, "inputs": {"Keep": 0.0}},
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
            "Keep": 0.0,
        },
    },
    {"frame": 0, "inputs": {"Melanin Factor": 1.7, "Hemoglobin Factor": 0.5, "Keep": 1.0}},
)
"""Frames at 24 a second, and values of the shader's inputs; the last is what edit-albedo does."""

_ORDER = ("Melanin Factor", "Melanin Add", "Hemoglobin Factor", "Hemoglobin Add")
_ORDER = (*_ORDER, "Flush", "Flush Mask", "Pulse", "Pulse Rate", "Keep")
_UNCHANGED = dict(zip(_ORDER, (1.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0, 70.0, 1.0), strict=True))

_FRAGMENT = """#version 300 es
precision highp float;
precision highp sampler2D;
uniform sampler2D table, melanin, hemoglobin, skin, original;
uniform vec4 pigments, blood;
uniform float time, keep;
in vec2 place;
out vec4 colour;
{function}
void main() {{
  SkinEdit edit = SkinEdit(pigments.x, pigments.y, pigments.z, pigments.w,
                           blood.x, blood.y, blood.z, blood.w, time);
  float f_mel = texture(melanin, place).r, f_blood = texture(hemoglobin, place).r;
  vec3 offset = keep * skin_offset(table, f_mel, f_blood, texture(original, place).rgb);
  float weight = texture(skin, place).r;
  colour = vec4(skin_albedo(table, f_mel, f_blood, offset, weight, edit), 1.0);
}}
"""


class ShaderPatches:
    """A texture of random skin, lips and paint, its maps, shaders that read them, and the truth.

    Args:
        folder: Folder to write to.
        fractions: Maps: melanin and hemoglobin as volume fractions, and skin.
        original: The texture, as stored from 0 to 1.
        truth: Linear sRGB of each case: by the Python layer, and by `skinnet edit-albedo`.
    """

    def __init__(self, folder: Path) -> None:
        """Write the texture, its maps and the shaders."""
        self.folder, texture = folder / "shader", folder / "albedo.png"
        self.original = _write_texture(texture)
        maps = str(folder / "albedo_maps.json")
        _run("invert", "-q", str(texture), "-o", str(folder))
        _run("shader", "-q", maps, "-o", str(self.folder))
        whites = {"melanin": WHITES["melanin"], "hemoglobin": WHITES["hemoglobin"], "skin": 1.0}
        self.fractions = {
            name: _read(folder / f"albedo_{name}.png")[..., 0] * white
            for name, white in whites.items()
        }
        edit = CASES[-1]["inputs"]
        factors = [str(edit[f"{name} Factor"]) for name in ("Melanin", "Hemoglobin")]
        flags = ("--melanin", factors[0], "--hemoglobin", factors[1], "-o", str(folder))
        _run("edit-albedo", "-q", str(texture), *flags)
        self.truth = [self._compute(case) for case in CASES[:-1]]
        self.truth.append(srgb_to_linear(_read(folder / "albedo_edited.png")))

    def _compute(self, case: dict[str, Any]) -> NDArray[np.float64]:
        """Compute the colours of skin without what the texture has else."""
        edit, time = _UNCHANGED | case["inputs"], case["frame"] / _FPS
        wave = 0.5 - 0.5 * np.cos(2 * np.pi * edit["Pulse Rate"] * time / 60)
        blood = 1 + edit["Flush"] * edit["Flush Mask"] + edit["Pulse"] * wave
        f_mel = self.fractions["melanin"] * edit["Melanin Factor"] + edit["Melanin Add"]
        f_blood = self.fractions["hemoglobin"] * edit["Hemoglobin Factor"] + edit["Hemoglobin Add"]
        edited = {"melanin": f_mel.clip(0, 1), "hemoglobin": (f_blood * blood).clip(0, 1)}
        skin = SkinReflectance(dtype=torch.float64)
        camera = SpectralCamera(mean=load_camera("observer"), dtype=torch.float64)
        given = []
        for name, after in edited.items():
            before = self.fractions[name]
            given.append(torch.from_numpy(before + self.fractions["skin"] * (after - before)))
        colours: NDArray[np.float64] = camera(skin(*given)).detach().numpy()
        return colours

    def find_error(self, pictures: Sequence[NDArray[Any]]) -> float:
        """Find the largest difference from the right colours, in linear sRGB."""
        pairs = zip(pictures, self.truth, strict=True)
        return max(float(np.abs(picture - right).max()) for picture, right in pairs)

    def measure_blender(self) -> dict[str, float]:
        """Measure the errors of the node group and of the OSL shader in Cycles."""
        script = Path(__file__).parent / "in_blender" / "patches.py"
        output = self.folder / "out.npz"
        cases = self.folder / "cases.json"
        whole = [case | {"inputs": _UNCHANGED | case["inputs"]} for case in CASES]
        cases.write_text(json.dumps(whole), encoding="utf-8")
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
        uniforms = {"pigments": edit[:4], "blood": edit[4:8], "keep": edit[8:]}
        uniforms["time"] = [case["frame"] / _FPS]
        textures = {"table": (read_table(self.folder), True)}
        textures["original"] = (srgb_to_linear(self.original), False)
        textures |= {name: (each[..., None], False) for name, each in self.fractions.items()}
        return (VERTEX, _FRAGMENT.format(function=function)), (_SIDE, _SIDE), textures, uniforms

    def measure_materialx(self, page: Any) -> float:
        """Measure the error of the MaterialX material as its own generator writes it for WebGL."""
        from benchmarks.materialx_patches import generate

        textures = {"table": (read_table(self.folder), True)}
        whites = WHITES | {"skin": 1.0}
        textures |= {
            name: (each[..., None] / whites[name], False) for name, each in self.fractions.items()
        }
        textures["original"] = (self.original, False)  # the shader makes it linear
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


def _run(*words: str) -> None:
    with redirect_stdout(StringIO()), redirect_stderr(StringIO()):
        assert run_skinnet([*words]) == 0


def _write_texture(path: Path) -> NDArray[np.float32]:
    """Write a texture of 16 bits: random skin, a quarter of it with lips and paint."""
    rng = np.random.default_rng(0)
    f_mel, f_blood = (rng.random((_SIDE, _SIDE)) ** 2 * top for top in (0.43, 0.2))
    colour = AlbedoColour().decode(f_mel.astype(np.float32), f_blood.astype(np.float32))
    lips, paint = slice(0, _SIDE // 8), slice(_SIDE // 8, _SIDE // 4)
    colour[lips] *= np.array([1.0, 0.6, 0.7], np.float32)
    colour[paint] = rng.choice(np.array([[0, 0, 0], [1, 1, 1], [0, 0.4, 0.1]]), (4, _SIDE))
    pixels = np.rint(linear_to_srgb(colour.clip(0, 1)) * _LEVELS).astype(np.uint16)
    path.write_bytes(png_encode(pixels))
    return (pixels / _LEVELS).astype(np.float32)


def _read(path: Path) -> NDArray[np.float32]:
    """Read a file of integers as numbers from 0 to 1."""
    import OpenImageIO

    file = OpenImageIO.ImageInput.open(str(path))
    pixels: NDArray[np.float32] = file.read_image("float")
    file.close()
    return pixels


if __name__ == "__main__":
    figures = {"shader_error": measure_shader_error(), "glsl_fps": measure_glsl_fps()}
    print(json.dumps(figures, indent=2))
