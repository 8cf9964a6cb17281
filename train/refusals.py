"""Turns what Lightning refuses into a sentence that names the flag, its value and the remedy."""

import contextlib
import logging
import math
import re
import sys
import traceback
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping
from inspect import signature
from typing import Any

from jsonargparse import Namespace
from lightning import Trainer
from lightning.fabric.utilities.exceptions import MisconfigurationException

from skinnet.errors import InputError

HELP = "python -m train fit --help lists the flags"

_LIBRARIES = (
    "lightning",
    "lightning_utilities",
    "jsonargparse",
    "torch.cuda",
    "torch.distributed",
    "torch.optim",
)
"""Packages that check what the user has given."""

_ENTRIES = ("train.cli", "train.refusals", "skinnet.pipeline._sentence_parser")
"""Modules of ours that hand the flags of the user on."""


@contextlib.contextmanager
def explain_refusals(explain: Callable[[Exception], str]) -> Iterator[None]:
    """Turn every refusal of a library in the block into an `InputError`.

    Args:
        explain: Writes the sentence for a refusal.

    Raises:
        InputError: If a library refuses what it is given, or an `InputError` is behind its own
            error. All other errors pass as they are.
    """
    try:
        yield
    except Exception as error:
        for cause in list_causes(error):
            if isinstance(cause, InputError):
                raise cause from None
        if is_refusal(error):
            raise InputError(explain(error)) from error
        raise


def is_refusal(error: Exception) -> bool:
    """Tell whether a library refused what the user gave, and no code of ours has failed.

    Lightning has no class for it: it raises ValueError, TypeError, RuntimeError and others. So the
    place decides. The error is raised in one of the libraries that check flags, and no code but
    theirs has run between the entry and that place.
    """
    if isinstance(error, MisconfigurationException):
        return True
    causes = list_causes(error)
    return _is_in(_list_modules(error)[-1], _LIBRARIES) and all(
        _is_foreign(module) for cause in causes for module in _list_modules(cause)
    )


def count_steps(trainer: Trainer) -> int:
    """Count the steps that a training will have taken at its end.

    Raises:
        MisconfigurationException: If Lightning refuses the flags, most of which it checks here.
        InputError: If training has no end, or ends before it is allowed to.
    """
    try:
        steps = trainer.estimated_stepping_batches
    except Exception as error:
        if is_refusal(error):
            # The model asks for this, whose code would otherwise be blamed.
            raise MisconfigurationException(str(error)) from error
        raise
    if math.isinf(steps):
        raise InputError(
            "This training has no last step, with which its learning rate ends at 0; give "
            "--trainer.max_epochs or --trainer.max_steps."
        )
    if (least := trainer.min_steps) is not None and least > steps:
        raise InputError(
            f"--trainer.min_steps is {least} and training ends after {steps}; give fewer, or more "
            "--trainer.max_epochs."
        )
    return int(steps)


def list_causes(error: BaseException) -> list[BaseException]:
    """List an error and the errors behind it, the first cause last."""
    causes = [error]
    while (cause := causes[-1].__cause__ or causes[-1].__context__) and cause not in causes:
        causes.append(cause)
    return causes


def _list_modules(error: BaseException) -> list[str]:
    """The module of each call, from the outermost to the one that raised."""
    frames = traceback.walk_tb(error.__traceback__)
    return ["", *(str(frame.f_globals.get("__name__")) for frame, _ in frames)]


def _is_in(module: str, packages: tuple[str, ...]) -> bool:
    return any(f"{module}.".startswith(f"{package}.") for package in packages)


def _is_foreign(module: str) -> bool:
    """Whether a module is of Python, torch or such a library: neither ours nor the user's."""
    top = module.partition(".")[0]
    return (
        top in ("", "torch")
        or top in sys.stdlib_module_names
        or _is_in(module, _LIBRARIES + _ENTRIES)
    )


def list_given(arguments: Namespace) -> dict[str, Any]:
    """List the flags for Lightning that do not have their defaults, and their values."""
    defaults = {name: each.default for name, each in signature(Trainer).parameters.items()}
    trainer = {
        f"trainer.{name}": value
        for name, value in vars(arguments.trainer).items()
        if value != defaults.get(name)
    }
    others = {name: arguments.get(name) for name in ("optimizer", "lr_scheduler")}
    return trainer | {name: value for name, value in others.items() if value is not None}


def find_guilty(given: Iterable[str], settings: Mapping[str, Any]) -> list[str]:
    """Find the flags of the trainer without which it can be made.

    Args:
        given: Names of the flags that do not have their defaults.
        settings: Arguments with which no trainer can be made.

    Returns:
        The flags, each of which is to blame.
    """
    names = [name for name in given if name.startswith("trainer.")]
    return [name for name in names if _can_make({**settings}, name.removeprefix("trainer."))]


def _can_make(settings: dict[str, Any], left_out: str) -> bool:
    del settings[left_out]
    disabled = logging.root.manager.disable
    logging.disable()
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            Trainer(**settings)
    except Exception:  # whatever it is, the flag that is left out is not the only one to blame
        return False
    finally:
        logging.disable(disabled)
    return True


def write_refusal(error: Exception, given: Mapping[str, Any], names: list[str]) -> str:
    """Write the sentence for a refusal.

    Args:
        error: What the library raised.
        given: The flags of the user that are not at their defaults, and their values.
        names: The flags that are to blame. Without any, those that the message mentions.
    """
    text = " ".join(_find_reason(error).split())
    names = names or _find_mentioned(text, given) or _find_mentioned(str(error), given)
    flags = " with ".join(f"--{name} {_write_value(given[name])}" for name in names)
    if not flags:
        return f"Lightning cannot train with this configuration: {_end(text)} ({HELP})"
    return f"Lightning refuses {flags}: {_end(text)} Give another value or leave it out ({HELP})."


def _find_reason(error: Exception) -> str:
    """What is wrong. The parser writes it among all types that it has tried."""
    if not _is_in(_list_modules(error)[-1], ("jsonargparse",)):
        return str(error)
    lines = [line.strip() for line in str(error).splitlines()]
    tried = ("- Expected a", "- Not a valid subclass", "- Problem with given class_path")
    reasons = [line[2:] for line in lines if line.startswith("- ") and not line.startswith(tried)]
    return reasons[0] if reasons else str(list_causes(error)[-1])


def _end(text: str) -> str:
    return text if text.endswith((".", "!", "?")) else f"{text}."


def _find_mentioned(text: str, given: Mapping[str, Any]) -> list[str]:
    """The flags whose name stands in a text; else those with a value or an argument in it."""
    by_name = [name for name in given if _stands_in(name.rpartition(".")[2], text)]
    return by_name or [
        name for name in given if any(_stands_in(word, text) for word in _list_words(given[name]))
    ]


def _list_words(value: Any) -> list[str]:
    """A value as text; for classes their names, and the names and values of their arguments."""
    values = value if isinstance(value, list) else [value]
    words = [_write_value(each) for each in values]
    for each in values:
        if isinstance(each, Namespace) and (arguments := each.get("init_args")) is not None:
            words += [*vars(arguments), *map(str, vars(arguments).values())]
    return words


def _stands_in(word: str, text: str) -> bool:
    return len(word) > 1 and bool(re.search(rf"(?<![A-Za-z0-9]){re.escape(word)}(?!\w)", text))


def _write_value(value: Any) -> str:
    if isinstance(value, (list, tuple)):
        return f"[{','.join(map(_write_value, value))}]"
    if isinstance(value, Namespace):
        return str(value.get("class_path", value.as_dict())).rpartition(".")[2]
    if value is None or isinstance(value, bool):
        return {None: "null", True: "true", False: "false"}[value]
    return str(value)
