"""Albedo textures: `python -m benchmarks.albedo [--json] [--side 8192] [--peers DIR]`.

- `round_trip_steps`: largest error, in steps of the input's bits, of textures that went through
  `skinnet invert` and back without an edit: synthetic skin, and the scans where they are at hand.
- `seconds_8k`, `memory_8k_gb`: wall time and peak memory of `skinnet invert` on a PNG of 16 bits.
- `speedup_vs_kdtree`: time of scipy's cKDTree, two workers, over that of `AlbedoColour.invert`.
- `edit_ciede2000`: median difference of edited colours from skins that were changed in the physics,
  beside a transfer of the mean colour in Lab. Skins are samples of `SkinPrior`.
- `shader_error`, `glsl_fps`: see `benchmarks.shaders`; null, with a reason, where Blender or
  Chromium is missing.
"""

import argparse
import json
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from scipy.spatial import cKDTree
from skimage.color import deltaE_ciede2000, rgb2lab

from benchmarks.shaders import measure_glsl_fps, measure_shader_error
from skinnet.appearance.edit import PigmentEdit
from skinnet.images.photograph import read_picture
from skinnet.images.srgb import linear_to_srgb
from skinnet.material import AlbedoColour
from skinnet.material._texture_file import import_openimageio
from skinnet.physics import SkinPrior, SkinReflectance, load_spectrum_to_srgb

_SCANS = Path("../shared/data/scans")
_FACTORS = (0.5, 1.0, 2.0)
_SKINS, _COLOURS = 1500, 300_000


def main(argv: Sequence[str] | None = None) -> int:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--side", type=int, default=8192, help="side of the timed texture")
    parser.add_argument("--peers", type=Path, help="folder with BioSkin's code and weights")
    options = parser.parse_args(argv)
    colour = AlbedoColour()
    found: dict[str, Any] = measure_round_trips()
    found |= measure_large(options.side)
    found |= measure_search(colour)
    found |= measure_edits(colour)
    found |= {"bioskin_ciede2000": None, "bioskin_reason": "its code and weights are not at hand"}
    found |= measure_shaders()
    print(json.dumps(found) if options.json else "\n".join(f"{k}: {v}" for k, v in found.items()))
    return 0


def sample_skins(count: int = _SKINS) -> tuple[Any, ...]:
    """Sample f_mel, f_blood and nuisance of people."""
    return SkinPrior().sample(count, torch.Generator().manual_seed(0))[:3]


def render(f_mel: Any, f_blood: Any, nuisance: Any) -> NDArray[np.float32]:
    """Linear RGB [n, 3] of skins under D65."""
    skin = SkinReflectance(dtype=torch.float64).bands(
        f_mel.clamp(0, 1), f_blood.clamp(0, 1), nuisance
    )
    rgb = (skin @ load_spectrum_to_srgb("D65", "observer")).numpy()
    return np.asarray(rgb.clip(0, 1), np.float32)


def measure_round_trips() -> dict[str, Any]:
    """Measure round trips of synthetic skin at 8 and 16 bits, and of the scans at 8."""
    skins = np.resize(render(*sample_skins()), (256, 256, 3))
    srgb = linear_to_srgb(skins)
    cases = {
        f"synthetic {kind}": np.rint(srgb * np.iinfo(kind).max).astype(kind)
        for kind in ("uint8", "uint16")
    }
    cases |= {
        path.parent.name: read_picture(path).pixels for path in sorted(_SCANS.glob("*/*.jpg"))
    }
    steps = {name: _measure_round_trip(pixels) for name, pixels in cases.items()}
    return {"round_trip_steps": max(steps.values()), "round_trips": steps}


def _measure_round_trip(pixels: NDArray[Any]) -> int:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "a.png")
        _write(path, pixels)
        _run("invert", str(path), "-o", folder)
        _run("edit-albedo", str(Path(folder, "a_maps.json")), "-o", folder)
        back = read_picture(Path(folder, "a_edited.png")).pixels
    return int(np.abs(back.astype(int) - pixels.astype(int)).max())


def _write(path: Path, pixels: NDArray[Any]) -> None:
    oiio = import_openimageio()
    height, width, count = pixels.shape
    output = oiio.ImageOutput.create(str(path))
    output.open(str(path), oiio.ImageSpec(width, height, count, str(pixels.dtype)))
    output.write_image(np.ascontiguousarray(pixels))
    output.close()


def _run(*arguments: str) -> None:
    subprocess.run(
        [sys.executable, "-m", "skinnet", "-q", *arguments], check=True, stdout=subprocess.DEVNULL
    )


def measure_large(side: int) -> dict[str, Any]:
    """Time `skinnet invert` on a large texture of 16 bits, with noise in its low bits."""
    rng = np.random.default_rng(0)
    skins = linear_to_srgb(render(*sample_skins(64))).reshape(8, 8, 3)
    rows = np.linspace(0, 6.99, side)
    pixels = np.empty((side, side, 3), np.uint16)
    for k, row in enumerate(rows):
        low, share = int(row), row % 1
        line = skins[low] * (1 - share) + skins[low + 1] * share
        wide = np.stack([np.interp(np.linspace(0, 7, side), range(8), one) for one in line.T], -1)
        pixels[k] = ((wide + rng.normal(0, 0.004, (side, 3))).clip(0, 1) * 65535).astype(np.uint16)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "a.png")
        _write(path, pixels)
        del pixels
        start = time.perf_counter()
        _run("invert", str(path), "-o", folder)
        seconds = time.perf_counter() - start
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return {"side": side, "seconds_8k": seconds, "memory_8k_gb": usage.ru_maxrss / 2**20}


def measure_search(colour: AlbedoColour) -> dict[str, Any]:
    """Compare with a KD-tree over the 256 x 256 colours of the same skin."""
    rng = np.random.default_rng(0)
    skins = render(*sample_skins())
    colours = skins[rng.integers(0, len(skins), _COLOURS)] + rng.normal(0, 0.004, (_COLOURS, 3))
    nodes = np.moveaxis(colour.colour.table[0].numpy(), 0, -1).reshape(-1, 3)
    tree, linear = cKDTree(nodes), colours.astype(np.float32)
    slow = min(_time(lambda: tree.query(colours, workers=2)) for _ in range(3))
    fast = min(_time(lambda: colour.invert(linear)) for _ in range(3))
    return {"speedup_vs_kdtree": slow / fast}


def _time(action: Any) -> float:
    start = time.perf_counter()
    action()
    return time.perf_counter() - start


def measure_edits(colour: AlbedoColour) -> dict[str, Any]:
    """Compare edited colours with skins that were changed in the physics."""
    f_mel, f_blood, nuisance = sample_skins()
    before, ours, transferred = render(f_mel, f_blood, nuisance), [], []
    for mel, blood in product(_FACTORS, _FACTORS):
        if mel == blood == 1:
            continue
        truth = _to_lab(render(mel * f_mel, blood * f_blood, nuisance))
        edited = colour.edit(before, PigmentEdit(mel), PigmentEdit(blood))
        ours.append(deltaE_ciede2000(truth, _to_lab(edited)))
        shifted = _to_lab(before) + (truth - _to_lab(before)).mean(0)
        transferred.append(deltaE_ciede2000(truth, shifted))
    values = np.concatenate(ours)
    return {
        "edit_ciede2000": float(np.median(values)),
        "edit_ciede2000_p90": float(np.percentile(values, 90)),
        "colour_transfer_ciede2000": float(np.median(np.concatenate(transferred))),
    }


def _to_lab(linear: NDArray[Any]) -> NDArray[np.float64]:
    return np.asarray(rgb2lab(linear_to_srgb(linear)))


def measure_shaders() -> dict[str, Any]:
    """Measure the shaders; null, with a reason, where a tool is missing."""
    errors, fps = measure_shader_error(), measure_glsl_fps()
    known = [error for error in errors.values() if error is not None]
    found: dict[str, Any] = {"shader_error": max(known, default=None), "shader_errors": errors}
    missing = [name for name, error in errors.items() if error is None]
    if missing:
        found["shader_reason"] = f"Blender or Chromium is missing for {', '.join(missing)}"
    if fps is None:
        found["glsl_fps_reason"] = "Chromium is missing"
    return found | {"glsl_fps": fps}


if __name__ == "__main__":
    raise SystemExit(main())
