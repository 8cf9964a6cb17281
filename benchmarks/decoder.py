"""Time, memory and error of the decoder's fast mode, beside the two usual ways.

`python -m benchmarks.decoder [--json]` runs forward and backward for 8 images of 256 x 256 in
float32, with gradients to both maps, the light's weights and temperature, the camera and its white
balance. The ways take turns in one process, and the least time of each is reported. Memory is the
growth of the resident peak in a process of its own (Linux only).

`max_error` is the largest difference in linear RGB between the fast mode and the closed form, over
all fractions from 0 to 1. `gradient_error` is the largest relative error of a gradient, over the
presets in `gradient_error_by_preset`, which are all but `printed`. For each pixel it compares the
derivatives of R, G and B by a fraction, as a vector, with the closed form's in double precision;
for the capture it compares the gradients of all images at once.
"""

import subprocess
import sys
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

import torch
import torch.nn.functional as F
from torch import Tensor

from benchmarks.report import Results, main
from benchmarks.resources import read_resident_kb
from skinnet.physics import LIGHTS, PRESETS, Capture, SkinDecoder

Picture = Callable[[Tensor, Tensor, Capture], Tensor]

IMAGES, SIZE, ROUNDS = 8, 256, 3
REPEATS = {"fast": 20, "grid_matmul": 4, "grid": 3, "bands": 1}
GRID = 256
"""Nodes along each side of the usual table, evenly spaced."""


def sample_scene(images: int, size: int, seed: int = 0) -> tuple[Tensor, Tensor, Capture]:
    """Sample smooth maps in the range of skin, mixed lights and cameras."""
    torch.manual_seed(seed)
    coarse = torch.rand(2, images, 9, 9)
    smooth = F.interpolate(coarse, (size, size), mode="bicubic", align_corners=True).clamp(0, 1)
    light = -torch.rand(images, len(LIGHTS)).log()
    capture = Capture(
        light / light.sum(-1, keepdim=True),
        4000 + 11000 * torch.rand(images),
        torch.randn(images, 6),
        0.05 * torch.randn(images, 2),
    )
    return 0.01 + 0.42 * smooth[0], 0.02 + 0.05 * smooth[1], capture


def decode(decoder: SkinDecoder, f_mel: Tensor, f_blood: Tensor, capture: Capture) -> Tensor:
    """Run the layer under test, in either of its modes."""
    return decoder.compose(f_mel, f_blood, None, None, None, capture)


class SpectralGrid:
    """The usual way: look up 33 channels for every pixel, then apply light, camera and a matrix.

    `at_once` merges the last three into one matrix product, which is faster than common code.
    """

    def __init__(self, decoder: SkinDecoder, at_once: bool):
        unit = torch.linspace(0, 1, GRID)
        self.camera, self.at_once = decoder.camera, at_once
        self.table = decoder.reflectance(unit[:, None], unit).movedim(-1, 0)[None]

    def __call__(self, f_mel: Tensor, f_blood: Tensor, capture: Capture) -> Tensor:
        """Render linear sRGB."""
        grid = torch.stack([f_blood, f_mel], -1) * 2 - 1
        table = self.table.expand(len(f_mel), -1, -1, -1)
        spectra = F.grid_sample(table, grid, align_corners=True)
        matrix = self.camera.matrix(capture)
        if self.at_once:
            return (matrix.mT @ spectra.flatten(2)).unflatten(-1, f_mel.shape[1:])
        light = self.camera.mix_lights(capture.light, capture.temperature)
        weights = light[..., None] * self.camera.sensitivity(capture.camera)
        raw = [(spectra * weights[:, :, c, None, None]).sum(1) for c in range(3)]
        to_srgb = torch.linalg.inv(weights.mT @ weights) @ weights.mT @ matrix
        return torch.einsum("bchw,bck->bkhw", torch.stack(raw, 1), to_srgb)


def step(
    picture: Picture, scene: tuple[Tensor, Tensor, Capture], weight: Tensor
) -> tuple[Tensor, ...]:
    """Run forward and backward; return the gradients of the maps and of the capture."""
    f_mel, f_blood, capture = scene
    inputs = [value.detach().requires_grad_() for value in (f_mel, f_blood, *capture[:4])]
    image = picture(inputs[0], inputs[1], Capture(*inputs[2:]))
    return torch.autograd.grad(image, inputs, weight)


def time_ways(ways: dict[str, Picture], images: int, size: int, rounds: int) -> dict[str, float]:
    """Measure the least time of each way in seconds; the ways take turns."""
    scene, weight = sample_scene(images, size), torch.randn(images, 3, size, size)
    times: dict[str, list[float]] = {name: [] for name in ways}
    for name in [*ways] * rounds:
        # Short steps are repeated more often, because one interruption spoils them.
        for _ in range(REPEATS[name]):
            start = time.perf_counter()
            step(ways[name], scene, weight)
            times[name].append(time.perf_counter() - start)
    return {name: min(values) for name, values in times.items()}


def measure_errors(size: int) -> Results:
    """Measure the largest error in linear RGB, and the largest relative errors of gradients."""
    scene = sample_square(size)
    fast, bands = (partial(decode, SkinDecoder(fast=fast)) for fast in (True, False))
    with torch.no_grad():
        error = (fast(*scene) - bands(*scene)).abs().max().item()
    by_preset = {
        preset: measure_gradient_error(preset, min(size, 64))
        for preset in PRESETS
        if preset != "printed"
    }
    return {
        "max_error": error,
        "gradient_error": max(by_preset.values()),
        "gradient_error_by_preset": by_preset,
    }


def sample_square(size: int) -> tuple[Tensor, Tensor, Capture]:
    """Sample fractions from 0 to 1, both included, half of them crowded where skin is."""
    _, _, capture = sample_scene(IMAGES, 9, seed=1)
    square = torch.rand(2, IMAGES, size, size)
    square[:, :, : size // 2] **= 4
    square[:, 0, 0, :4] = torch.tensor([[0.0, 0.0, 1.0, 1.0], [0.0, 1.0, 0.0, 1.0]])
    return square[0], square[1], capture


def measure_gradient_error(preset: str, size: int) -> float:
    """Measure the largest relative error of the fast mode's gradients, at any pixel."""
    f_mel, f_blood, capture = sample_square(size)
    double = f_mel.double(), f_blood.double(), capture.map(torch.Tensor.double)
    fast = differentiate(SkinDecoder(preset), (f_mel, f_blood, capture))
    exact = differentiate(SkinDecoder(preset, fast=False, dtype=torch.float64), double)
    # Maps [channel, ...] have one vector for each pixel; the capture's gradients are one vector.
    axes = [(0,), (0,), *[None] * (len(fast) - 2)]
    norm = torch.linalg.vector_norm
    return max(
        (norm(ours - true, dim=axis) / norm(true, dim=axis)).max().item()
        for ours, true, axis in zip(fast, exact, axes, strict=True)
    )


def differentiate(decoder: SkinDecoder, scene: tuple[Tensor, Tensor, Capture]) -> list[Tensor]:
    """Compute gradients of the sums of R, of G and of B; the first axis is the channel."""
    weights = torch.eye(3, dtype=scene[0].dtype)[..., None, None].expand(
        -1, -1, *scene[0].shape[1:]
    )
    channels = [
        step(partial(decode, decoder), scene, w.expand(IMAGES, -1, -1, -1)) for w in weights
    ]
    return [torch.stack(gradients) for gradients in zip(*channels, strict=True)]


def measure_peak_growth(fast: bool, images: int, size: int) -> int:
    """Measure the growth in kB of this process' resident peak by one step, after a warm-up."""
    picture = partial(decode, SkinDecoder(fast=fast))
    step(picture, sample_scene(images, 8), torch.ones(images, 3, 8, 8))
    scene, weight = sample_scene(images, size), torch.ones(images, 3, size, size)
    # The peak so far is that of the imports; writing 5 resets it.
    Path("/proc/self/clear_refs").write_text("5", encoding="utf-8")
    before = read_resident_kb("VmRSS")
    step(picture, scene, weight)
    return read_resident_kb("VmHWM") - before


def measure_memory(fast: bool, images: int = IMAGES, size: int = SIZE) -> int:
    """Measure the peak in a process of its own."""
    code = (
        "from benchmarks.decoder import measure_peak_growth as measure\n"
        f"print(measure({fast}, {images}, {size}))"
    )
    root = Path(__file__).parents[1]
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=root, capture_output=True, text=True, check=True
    )
    return int(done.stdout)


def measure(images: int = IMAGES, size: int = SIZE, rounds: int = ROUNDS) -> Results:
    """Measure every figure, by name."""
    fast, bands = SkinDecoder(), SkinDecoder(fast=False)
    ways: dict[str, Picture] = {
        "fast": partial(decode, fast),
        "bands": partial(decode, bands),
        "grid": SpectralGrid(bands, at_once=False),
        "grid_matmul": SpectralGrid(bands, at_once=True),
    }
    seconds = time_ways(ways, images, size, rounds)
    speedups = {f"speedup_vs_{name}": s / seconds["fast"] for name, s in seconds.items()}
    speedups.pop("speedup_vs_fast")
    peaks = {name: measure_memory(name == "fast", images, size) for name in ("fast", "bands")}
    return {
        **speedups,
        "memory_ratio": peaks["fast"] / peaks["bands"],
        **measure_errors(min(size, 128)),
        "seconds": seconds,
        "memory_mb": {name: kilobytes / 1024 for name, kilobytes in peaks.items()},
    }


if __name__ == "__main__":
    main(measure, "The decoder's fast mode beside the closed form and the usual 33-channel grid.")
