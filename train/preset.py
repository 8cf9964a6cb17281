"""Keeps training data and the model on one preset of the skin's constants."""

from typing import TYPE_CHECKING

from lightning import Trainer

from skinnet.errors import InputError

if TYPE_CHECKING:
    from train.task import SkinTask


def check_preset(trainer: Trainer | None, preset: str, data: str) -> None:
    """Refuse data whose fractions mean something else than those of the model that trains.

    Args:
        trainer: Trainer of the data module; None: nothing is trained.
        preset: Preset of `SkinOptics` that the data were rendered or inverted with.
        data: What the data are, as the subject of a sentence.

    Raises:
        InputError: If the model has another preset.
    """
    task: SkinTask | None = None if trainer is None else trainer.lightning_module  # type: ignore[assignment]
    if task is None:
        return
    if (own := task.model.config.optics) != preset:
        raise InputError(
            f"{data} have the skin of the preset {preset}, and the model that of {own}, in which "
            f"the same fractions have other colours. Add --model.optics {preset}, or give the data "
            f"{own}: --data.init_args.optics {own}, or .synthetic.optics for portraits."
        )
