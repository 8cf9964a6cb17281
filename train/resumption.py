"""Whether a training can go on from a checkpoint: its weights and states fit the configuration."""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from lightning import LightningModule
from torch import Tensor

from skinnet.errors import InputError, _name_error
from skinnet.network import read_checkpoint

_STATES = ("pytorch-lightning_version", "epoch", "global_step", "loops", "optimizer_states")
_STATES_OF_FIT = ("lr_schedulers", "callbacks")


def check_resumption(path: str | Path, model: LightningModule, training: bool) -> None:
    """Check that a checkpoint can be loaded into a model, and training go on from there.

    Args:
        path: The checkpoint.
        model: The module that training has made from the configuration.
        training: Whether it is to be trained; else it is evaluated.

    Raises:
        InputError: It belongs to a model of another shape, or lacks the state of a training.
    """
    checkpoint = read_checkpoint(path)
    network: Any = model.model
    own = {"widths": list(network.config.widths)}
    found = {"widths": list(checkpoint["skinnet"].get("widths", []))}
    if found != own:
        raise InputError(
            f"{path} has the widths {found['widths']}, and this configuration has "
            f"{own['widths']}; give --model.widths={_write(found['widths'])}, or a checkpoint of "
            "this configuration."
        )
    needed = _STATES + _STATES_OF_FIT if training else _STATES
    if absent := [name for name in needed if name not in checkpoint]:
        raise InputError(
            f"{path} holds a model without the state of its training ({absent[0]}), as a mean of "
            "checkpoints does; give RUN/last.ckpt, or start a new training from its weights with "
            f"--model.weights {path}."
        )
    faults = [*_compare(checkpoint["state_dict"], model.state_dict())]
    if training and not faults:
        faults = [*_compare_optimizer(checkpoint["optimizer_states"], model)]
    if faults:
        raise InputError(
            f"{path} does not fit this configuration: {faults[0]}; give a checkpoint that the same "
            f"configuration wrote, or start from its weights with --model.weights {path}."
        )


def _compare(found: Mapping[str, Any], own: Mapping[str, Tensor]) -> Iterator[str]:
    """Sentences on the weights that are missing, unknown or of another shape."""
    for name in own.keys() - found.keys():
        yield f"it lacks {name}"
    for name in found.keys() - own.keys():
        yield f"it holds {name}, which is not in the model"
    for name in own.keys() & found.keys():
        if own[name].shape != found[name].shape:
            shapes = f"{list(found[name].shape)}, and {list(own[name].shape)} is needed"
            yield f"its {name} is {shapes}"


def _compare_optimizer(states: Any, model: LightningModule) -> Iterator[str]:
    """Sentences on the states of the optimizer, which has one for each parameter in order."""
    shapes = [value.shape for value in model.parameters() if value.requires_grad]
    try:
        (state,) = states
        (group,) = state["param_groups"]
        kept = state["state"]
        if len(group["params"]) != len(shapes):
            yield f"its optimizer has {len(group['params'])} parameters, and {len(shapes)} are here"
            return
        for number, shape in zip(group["params"], shapes, strict=True):
            for name in ("exp_avg", "exp_avg_sq"):
                if kept and kept[number][name].shape != shape:
                    yield f"the optimizer's state of parameter {number} has another shape"
    except (KeyError, TypeError, ValueError, AttributeError, IndexError) as error:
        yield f"the state of its optimizer is damaged ({_name_error(error)})"


def _write(values: list[int]) -> str:
    return str(values).replace(" ", "")
