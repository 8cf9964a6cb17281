"""`skinnet sample`: random faces from a model of appearance."""

from pathlib import Path

import numpy as np
from jaxtyping import UInt8
from jsonargparse import ArgumentParser, Namespace

from skinnet.appearance.hybrid import HybridModel
from skinnet.appearance.maps_file import save_maps
from skinnet.appearance.skin_texture import SkinTexture
from skinnet.errors import InputError, _check_count
from skinnet.images._png_file import write_png
from skinnet.inference._tiles import draw_grid, draw_picture
from skinnet.pipeline._build_model import MODEL_FOLDER
from skinnet.pipeline._maps_writer import draw_pigments, show_albedo
from skinnet.pipeline._output import (
    MAPS_END,
    add_json,
    add_output,
    make_output_folder,
    print_result,
)
from skinnet.pipeline._source import Source, choose_folder

_VERB = "sample"


def add_arguments(parser: ArgumentParser) -> None:
    """Add the options for model, number, seed, spread and output."""
    parser.add_argument(
        "model", nargs="?", type=Path, default=MODEL_FOLDER / "hybrid.npz", help="A hybrid model."
    )
    parser.add_argument("-n", "--count", type=int, default=4, help="Number of faces.")
    parser.add_argument("--seed", type=int, default=0, help="Seed of the random faces.")
    parser.add_argument(
        "--spread",
        type=float,
        default=1.0,
        help="Factor on the standard deviations of the model; 0 gives the mean face.",
    )
    add_output(parser, "samples beside the model")
    add_json(parser, "What was made")


def run(config: Namespace) -> int:
    """Write sample_NN_maps.npz and sample_NN_albedo.png of each face, and samples.png of all."""
    if config.count < 1:
        raise InputError(f"count is 1 or more faces; got {config.count}.")
    _check_count("seed", config.seed)
    if not 0 <= config.spread <= 10:
        raise InputError(f"spread is a number of deviations in [0, 10]; got {config.spread}.")
    model = HybridModel.load(config.model)
    source = Source.read([config.model])
    stems = [f"sample_{number:02}" for number in range(config.count)]
    names = [f"{stem}{end}" for stem in stems for end in (MAPS_END, "_albedo.png")]
    default = config.model.parent / "samples"
    folder = choose_folder(config.output, default, [*names, "samples.png"], source)
    output = make_output_folder(folder)
    origin, text = source.describe(_VERB, "maps", output), source.make_mark(_VERB, "skin").to_text()
    betas = config.spread * model.sample(config.count, config.seed)
    textures = [model.texture(beta, f"sample {i:02}") for i, beta in enumerate(betas)]
    albedos = [show_albedo(texture.albedo(model.colour), texture) for texture in textures]
    for stem, texture, albedo in zip(stems, textures, albedos, strict=True):
        save_maps(output / f"{stem}{MAPS_END}", texture, model.colour, origin)
        write_png(output / f"{stem}_albedo.png", albedo, text)
    write_png(output / "samples.png", _draw_samples(textures, albedos), text)
    clipped = model.measure_clamping(betas)
    line = (
        f"{output}: {config.count} faces, {clipped:.2%} of their texels clipped to a fraction in "
        "[0, 1]; sample_*_maps.npz, sample_*_albedo.png, samples.png"
    )
    record = {
        **source.describe(_VERB, "skin", output),
        **{key: config[key] for key in ("count", "seed", "spread")},
        "clipped": float(clipped),
    }
    print_result(line, record, [output / name for name in (*names, "samples.png")], config.json)
    return 0


def _draw_samples(
    textures: list[SkinTexture], albedos: list[UInt8[np.ndarray, "size size 3"]]
) -> UInt8[np.ndarray, "h w 3"]:
    """Draw melanin, hemoglobin and albedo of every face, one column each."""
    columns = [
        [*draw_pigments(texture), draw_picture(f"albedo {number:02}", albedo)]
        for number, (texture, albedo) in enumerate(zip(textures, albedos, strict=True))
    ]
    return draw_grid([tile for row in zip(*columns, strict=True) for tile in row], len(columns))
