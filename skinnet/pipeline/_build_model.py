"""`skinnet build-model`: maps of many people to a hybrid, a linear and a joint model."""

import json
import shutil
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Bool
from jsonargparse import ArgumentParser, Namespace

from skinnet.appearance.hybrid import HybridModel
from skinnet.appearance.joint import JointModel
from skinnet.appearance.joint_measures import measure_joint
from skinnet.appearance.linear import LinearModel
from skinnet.appearance.measures import Measures, measure
from skinnet.appearance.stack import SubjectStack
from skinnet.errors import InputError, _check_count
from skinnet.images._result_names import OUTPUT
from skinnet.inference._messages import log
from skinnet.pipeline._model_inputs import find_maps, read_mask, read_shape, stack_subjects
from skinnet.pipeline._model_results import (
    JOINT,
    MODEL_FILES,
    describe_measures,
    make_renderer,
    write_models,
)
from skinnet.pipeline._output import add_json, add_output, make_output_folder, print_result
from skinnet.pipeline._scans import ScanOptions
from skinnet.pipeline._source import Source, choose_folder

MODEL_FOLDER = Path("skinmodel")

RENAMED = {"model": "appearance"}
"""The group of settings, and its earlier name."""


@dataclass(frozen=True)
class ModelSettings:
    """Settings of models of appearance (section 5 of Alotaibi & Smith 2017).

    Args:
        components: Principal components kept; null: all that the subjects span, up to 100.
        mask: Picture over the texture space, white where there is skin (the paper's was drawn by
            hand); null: all texels that enough subjects have.
        share: Share of the subjects that must have a texel.
        effect: Scale hemoglobin, melanin and the offset by their effect on RGB, instead of giving
            each the same total variance. The paper does not say how it mixes them.
        samples: Number of random faces for specificity.
        seed: Seed of these faces.
    """

    components: int | None = None
    mask: Path | None = None
    share: float = 1.0
    effect: bool = False
    samples: int = 100
    seed: int = 0

    def __post_init__(self) -> None:
        if self.components is not None:
            _check_count("components", self.components, 1)
        _check_count("samples", self.samples, 1)
        _check_count("seed", self.seed)
        if not 0 < self.share <= 1:
            raise InputError(f"share is a share of the subjects in (0, 1]; got {self.share}.")


def add_arguments(parser: ArgumentParser) -> None:
    """Add the options for maps, models and output."""
    parser.add_argument(
        "maps",
        nargs="*",
        type=Path,
        help=f"NAME_maps.npz files or folders of them; by default the folder {OUTPUT}.",
    )
    parser.add_class_arguments(ModelSettings, "appearance")
    parser.add_argument(
        "--joint",
        type=bool,
        nargs="?",
        const=True,
        default=False,
        help="Build a model of shape and appearance too.",
    )
    parser.add_argument(
        "--shape",
        type=Path | None,
        default=None,
        help="The shape model of the fits, for --joint; by default the procedural face.",
    )
    parser.add_argument(
        "--shape_landmarks",
        type=Path | None,
        default=None,
        help="Landmarks of that model, as --shape-landmarks of skinnet maps.",
    )
    add_output(parser, str(MODEL_FOLDER))
    add_json(parser, "The measures")


def run(config: Namespace) -> int:
    """Write hybrid.npz, linear.npz, joint.npz if asked for, and their measures and figures."""
    files = find_maps(config.maps or [Path(OUTPUT)])
    source = Source.read(files)
    names = MODEL_FILES if config.joint else [name for name in MODEL_FILES if name != JOINT]
    folder = choose_folder(config.output, MODEL_FOLDER, names, source)
    output = make_output_folder(folder)
    stack = stack_subjects(files, output / "stack")
    mask = _choose_texels(stack, config.appearance)
    hybrid, linear = _fit_models(stack, mask, config.appearance)
    measures = [_measure_model(model, stack, config.appearance) for model in (hybrid, linear)]
    joint = None
    if config.joint:
        options = ScanOptions(config.shape, config.shape_landmarks)
        joint, joint_measures = _fit_joint(files, stack, hybrid, options, config.appearance)
        measures.append(joint_measures)
    write_models(output, hybrid, linear, joint, measures, make_renderer(files), source)
    shutil.rmtree(stack.folder)
    line = f"{output}: {len(files)} subjects; {describe_measures(measures)}"
    record = json.loads((output / "measures.json").read_text(encoding="utf-8"))
    print_result(line, record, [output / name for name in names], config.json)
    return 0


def _choose_texels(stack: SubjectStack, settings: ModelSettings) -> Bool[np.ndarray, "size size"]:
    try:
        cover = stack.cover(settings.share, read_mask(settings.mask, stack.size))
    except InputError:
        shutil.rmtree(stack.folder)
        raise
    log(f"{len(stack.names)} subjects: {cover}.")
    return cover.mask


def _fit_models(
    stack: SubjectStack, mask: Bool[np.ndarray, "size size"], settings: ModelSettings
) -> tuple[HybridModel, LinearModel]:
    """Fit both models to the same texels of the same people."""
    scales = HybridModel.equal_effect_scales(stack, mask) if settings.effect else None
    hybrid = HybridModel.fit(stack, settings.components, mask, scales)
    return hybrid, LinearModel.fit(stack, settings.components, mask)


def _measure_model(
    model: HybridModel | LinearModel, stack: SubjectStack, settings: ModelSettings
) -> Measures:
    log(f"{type(model).__name__} is measured.")
    return measure(model, stack, None, settings.samples, settings.seed)


def _fit_joint(
    files: list[Path],
    stack: SubjectStack,
    hybrid: HybridModel,
    options: ScanOptions,
    settings: ModelSettings,
) -> tuple[JointModel, Measures]:
    """Fit a joint model of the people's shapes and of the hybrid model, and measure it."""
    shape = options.load_model()
    alphas = np.stack([read_shape(file, len(shape.variances)) for file in files])
    joint = JointModel.fit(alphas, hybrid.coefficients(stack), np.sqrt(shape.variances))
    measures = measure_joint(
        joint, hybrid, stack, shape, alphas, None, settings.samples, settings.seed
    )
    return joint, measures
