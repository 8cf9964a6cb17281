"""`skinnet sample`: random faces from a model of appearance."""

from pathlib import Path

import numpy as np
from jsonargparse import ArgumentParser, Namespace
from PIL import Image

from skinnet.appearance.hybrid import HybridModel
from skinnet.appearance.maps_file import save_maps
from skinnet.errors import InputError
from skinnet.images.photograph import write_png
from skinnet.images.srgb import linear_to_srgb, to_uint8
from skinnet.inference.panel import draw_grid, draw_picture, draw_pigment_map, round_up
from skinnet.pipeline._build_model import FOLDER
from skinnet.pipeline.command import add_output, output_folder


def add_arguments(parser: ArgumentParser) -> None:
    """Model, number, seed and spread."""
    parser.add_argument(
        "model", nargs="?", type=Path, default=FOLDER / "hybrid.npz", help="A hybrid model."
    )
    parser.add_argument("-n", "--count", type=int, default=4, help="Faces to draw.")
    parser.add_argument("--seed", type=int, default=0, help="The same seed, the same faces.")
    parser.add_argument(
        "--spread", type=float, default=1.0, help="Standard deviation of what is drawn; 0 the mean."
    )
    add_output(parser, "samples beside the model")


def run(config: Namespace) -> int:
    """Write sample_NN_maps.npz and sample_NN_albedo.png of each face, and samples.png of all."""
    if config.count < 1:
        raise InputError(f"count is 1 or more faces; got {config.count}.")
    if not 0 <= config.spread <= 10:
        raise InputError(f"spread is a number of deviations in [0, 10]; got {config.spread}.")
    model = HybridModel.load(config.model)
    output = output_folder(config.output or config.model.parent / "samples")
    betas = config.spread * model.sample(config.count, config.seed)
    textures = [model.texture(beta, f"sample {i:02}") for i, beta in enumerate(betas)]
    tops = [
        round_up(max(float(np.percentile(getattr(one, name)[one.mask], 99)) for one in textures))
        for name in ("f_mel", "f_blood")
    ]
    rows: list[list[Image.Image]] = [[], [], []]
    for number, texture in enumerate(textures):
        shown = np.where(
            texture.mask[..., None], to_uint8(linear_to_srgb(texture.albedo(model.colour))), 232
        ).astype(np.uint8)
        stem = output / f"sample_{number:02}"
        save_maps(stem.with_name(f"{stem.name}_maps.npz"), texture, model.colour)
        write_png(stem.with_name(f"{stem.name}_albedo.png"), shown)
        mask = texture.mask.astype(np.float64)
        rows[0].append(draw_pigment_map("melanin", texture.f_mel, mask, tops[0]))
        rows[1].append(draw_pigment_map("hemoglobin", texture.f_blood, mask, tops[1]))
        rows[2].append(draw_picture(f"albedo {number:02}", shown))
    write_png(
        output / "samples.png", draw_grid([tile for row in rows for tile in row], config.count)
    )
    print(
        f"{output}: {config.count} faces, {model.measure_clamping(betas):.2%} of their texels "
        "clipped to a fraction in [0, 1]; sample_*_maps.npz, sample_*_albedo.png, samples.png",
        flush=True,
    )
    return 0
