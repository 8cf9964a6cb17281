"""`skinnet build-model`: maps of many people to a hybrid, a linear and a joint model."""

import json
import shutil
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Bool, Float
from jsonargparse import ArgumentParser, Namespace

from skinnet.appearance.hybrid import HybridModel
from skinnet.appearance.joint import JointModel
from skinnet.appearance.joint_measures import measure_joint
from skinnet.appearance.linear import LinearModel
from skinnet.appearance.maps_file import load_maps
from skinnet.appearance.measures import Measures, measure
from skinnet.appearance.skin_texture import SkinTexture
from skinnet.appearance.stack import SubjectStack
from skinnet.appearance.stack_writer import write_stack
from skinnet.errors import InputError
from skinnet.files import write_text
from skinnet.images.photograph import read_photo, write_png
from skinnet.inference.panel import TILE
from skinnet.mesh.mesh_file import read_mesh
from skinnet.pipeline._fit_archive import load_fit
from skinnet.pipeline._model_figures import Renderer, hybrid_sheet, linear_sheet, write_measures
from skinnet.pipeline._progress import digest, log
from skinnet.pipeline._scans import OUTPUT, ScanOptions
from skinnet.pipeline.command import add_output, output_folder
from skinnet.pipeline.relight import RelightSettings

FOLDER = Path("skinmodel")
MAPS = "_maps.npz"


@dataclass(frozen=True)
class ModelSettings:
    """How models of appearance are built (section 5).

    Args:
        components: principal components kept; null: all that the subjects span, up to 100.
        mask: picture over the texture space, white where there is skin, as the paper's hand-drawn
            one; null: all texels that enough subjects have.
        share: share of the subjects that must have a texel.
        effect: weigh hemoglobin, melanin and the offset by what they change in RGB, in place of
            giving each the same total variance. The paper does not say how it mixes them.
        samples: random faces by which specificity is measured.
        seed: of these faces.
    """

    components: int | None = None
    mask: Path | None = None
    share: float = 1.0
    effect: bool = False
    samples: int = 100
    seed: int = 0


def add_arguments(parser: ArgumentParser) -> None:
    """Maps, output and settings."""
    parser.add_argument(
        "maps",
        nargs="*",
        type=Path,
        help=f"NAME_maps.npz files or folders of them; by default the folder {OUTPUT}.",
    )
    parser.add_class_arguments(ModelSettings, "model")
    parser.add_argument(
        "--joint", type=bool, default=False, help="Build a model of shape and appearance too."
    )
    parser.add_argument(
        "--shape",
        type=Path | None,
        default=None,
        help="For it, the shape model of the scans' fits; by default the procedural face.",
    )
    parser.add_argument(
        "--shape_landmarks", type=Path | None, default=None, help="See model_landmarks of maps."
    )
    add_output(parser, str(FOLDER))


def run(config: Namespace) -> int:
    """Write hybrid.npz, linear.npz and, if asked for, joint.npz; measures and pictures of them."""
    output = output_folder(config.output or FOLDER)
    files = found_maps(config.maps or [Path(OUTPUT)])
    stack = stacked(files, output / "stack")
    try:
        cover = stack.cover(config.model.share, drawn_mask(config.model.mask, stack.size))
    except InputError:
        shutil.rmtree(output / "stack")
        raise
    log(f"{len(files)} subjects: {cover}.")
    models = fitted_models(stack, cover.mask, config.model)
    measures = [measured(model, stack, config.model) for model in models]
    joint = None
    if config.joint:
        shape = ScanOptions(config.shape, config.shape_landmarks).load_model()
        alphas = np.stack([shape_of(file, len(shape.variances)) for file in files])
        betas = models[0].coefficients(stack)
        joint = JointModel.fit(alphas, betas, np.sqrt(shape.variances))
        measures.append(
            measure_joint(
                joint,
                models[0],
                stack,
                shape,
                alphas,
                None,
                config.model.samples,
                config.model.seed,
            )
        )
    write_models(output, models, joint, measures, renderer_of(files))
    shutil.rmtree(output / "stack")
    print(f"{output}: {len(files)} subjects; {table(measures)}", flush=True)
    return 0


def found_maps(places: list[Path]) -> list[Path]:
    """The maps named, and those in the folders named, each once, in the order of their names."""
    files: list[Path] = []
    for place in places:
        if not place.exists():
            raise InputError(f"There is no {place}; name *{MAPS} files or a folder of them.")
        inside = sorted(place.glob(f"*{MAPS}")) if place.is_dir() else [place]
        inside = [file for file in inside if not place.is_dir() or not _edited(file)]
        if not inside:
            raise InputError(f"The folder {place} holds no *{MAPS}; make them with skinnet maps.")
        files += [file for file in inside if file not in files]
    if len(files) < 3:
        raise InputError(
            f"{len(files)} subjects were found, and a model that can be measured needs three; "
            f"name more *{MAPS}."
        )
    return files


def _edited(file: Path) -> bool:
    """Whether maps were made by edit-maps; an edited face is not another person."""
    edited = file.name.endswith(f"_edited{MAPS}")
    if edited:
        log(f"{file} is an edited face and is left out.")
    return edited


def stacked(files: list[Path], folder: Path) -> SubjectStack:
    """The subjects on disk as one array; goes on where an interrupted run stopped."""
    colours = {file: load_maps(file)[1].to_record() for file in files}
    first = colours[files[0]]
    for file, colour in colours.items():
        if colour != first:
            raise InputError(
                f"{file} was inverted under another light, camera or calibration than {files[0]}; "
                "invert all together with one skinnet maps."
            )
    subjects = {str(file): partial(_texture, file) for file in files}
    return write_stack(folder, subjects, load_maps(files[0])[1], digest(*files))


def _texture(file: Path) -> SkinTexture:
    log(f"{file} is read.")
    return load_maps(file)[0]


def drawn_mask(path: Path | None, size: int) -> Bool[np.ndarray, "size size"] | None:
    """A drawn mask, True where the picture is lighter than middle grey."""
    if path is None:
        return None
    drawn = np.asarray(read_photo(path).mean(-1) > 127)
    if drawn.shape != (size, size):
        raise InputError(
            f"{path} is {drawn.shape[1]} x {drawn.shape[0]} pixels and the maps are {size} x "
            f"{size}; draw the mask at their size."
        )
    return drawn


def fitted_models(
    stack: SubjectStack, mask: Bool[np.ndarray, "size size"], settings: ModelSettings
) -> tuple[HybridModel, LinearModel]:
    """Both models on the same texels of the same people."""
    scales = HybridModel.equal_effect_scales(stack, mask) if settings.effect else None
    hybrid = HybridModel.fit(stack, settings.components, mask, scales)
    return hybrid, LinearModel.fit(stack, settings.components, mask)


def measured(
    model: HybridModel | LinearModel, stack: SubjectStack, settings: ModelSettings
) -> Measures:
    """The measures of a model, announced, since they take a while."""
    log(f"{type(model).__name__} is measured.")
    return measure(model, stack, None, settings.samples, settings.seed)


def shape_of(maps: Path, modes: int) -> Float[np.ndarray, "modes"]:
    """The shape coefficients of the fit beside some maps."""
    alpha = load_fit(maps.with_name(maps.name.removesuffix(MAPS) + "_shape.npz")).alpha
    if len(alpha) > modes:
        raise InputError(
            f"The shape beside {maps} has {len(alpha)} coefficients and the shape model {modes}; "
            "give the shape model that it was fitted with."
        )
    return np.pad(alpha, (0, modes - len(alpha)))


def renderer_of(files: list[Path]) -> Renderer | None:
    """Shows an albedo on the mean of the fitted faces; None where some have no mesh or no fit."""
    stems = [file.with_name(file.name.removesuffix(MAPS)) for file in files]
    meshes = [stem.with_name(f"{stem.name}_face.obj") for stem in stems]
    fits = [stem.with_name(f"{stem.name}_shape.npz") for stem in stems]
    if not all(file.is_file() for file in (*meshes, *fits)):
        return None
    found = [load_fit(file) for file in fits]
    face = read_mesh(meshes[0])
    shapes = [one.pose.apply_inverse(one.vertices) for one in found]
    if any(shape.shape != face.vertices.shape for shape in shapes):
        return None
    return partial(RelightSettings(size=TILE).picture, replace(face, vertices=np.mean(shapes, 0)))


def write_models(
    output: Path,
    models: tuple[HybridModel, LinearModel],
    joint: JointModel | None,
    measures: list[Measures],
    renderer: Renderer | None,
) -> None:
    """Models, measures, Figure 8's plot and Figure 7's pictures."""
    hybrid, linear = models
    shown = min(3, *(len(one.statistics.variances) for one in models))
    sheets = {
        "hybrid": hybrid_sheet(hybrid, components=shown, renderer=renderer),
        "linear": linear_sheet(linear, components=shown, renderer=renderer),
    }
    hybrid.save(output / "hybrid.npz")
    linear.save(output / "linear.npz")
    if joint is not None:
        joint.save(output / "joint.npz")
    write_measures(output / "measures.png", measures)
    for name, picture in sheets.items():
        write_png(output / f"components_{name}.png", picture)
    found: dict[str, Any] = {found.name: found.summary() for found in measures}
    subjects, texels = hybrid.statistics.subjects, int(hybrid.mask.sum())
    record = {"subjects": subjects, "texels": texels, "measures": found}
    write_text(output / "measures.json", json.dumps(record, indent=2, allow_nan=False) + "\n")


def table(measures: list[Measures]) -> str:
    """Each model in a few numbers: at three components, and at all."""
    lines = []
    for found in measures:
        counts = found.generalisation.counts
        at = {int(counts[i]): i for i in sorted({min(2, len(counts) - 1), len(counts) - 1})}
        lines += [
            f"{found.name} with {count}: {found.compactness[count - 1]:.1%} of the variance, "
            f"generalisation {found.generalisation.mean[i]:.4f}, "
            f"specificity {found.specificity.mean[i]:.4f} (RMS, linear RGB)"
            for count, i in at.items()
        ]
    return "; ".join(lines)
