"""Write the flags of pipeline verbs and of training for help: `python -m tools.flag_table`.

They take their flags from settings, whose classes import torch. Help and completion read these
tables instead. Tests compare them with the settings.
"""

import argparse
import json
import re
import sys
from importlib import import_module
from pathlib import Path
from typing import Any

from jsonargparse import ArgumentParser

from skinnet.pipeline._command import make_settings_parser
from skinnet.pipeline._flag_table import SWITCH, TABLE
from skinnet.pipeline._verbs import PIPELINE_VERBS
from train.usage import TABLE as TRAIN_TABLE

_METAVARS = {
    "Path": "FILE",
    "float": "X",
    "int": "N",
    "str": "NAME",
    "bool": SWITCH,
}

_TRAINER = {
    "max_epochs": "largest number of epochs",
    "max_steps": "largest number of steps",
    "devices": "number of processes or GPUs",
    "fast_dev_run": "number of steps of a trial that writes nothing",
    "accelerator": "cpu, gpu, mps or auto",
    "precision": "32-true, 16-mixed or bf16-mixed",
    "strategy": "ddp for several processes",
}
"""Flags of Lightning's trainer that are used most."""


def make_table() -> dict[str, Any]:
    """Make the table of all verbs."""
    return {verb: describe_verb(verb) for verb in PIPELINE_VERBS}


def describe_verb(verb: str) -> dict[str, Any]:
    """Describe the flags of a verb, in their groups."""
    module: Any = import_module(f"skinnet.pipeline._{verb.replace('-', '_')}")
    parser = make_settings_parser(verb, module)
    groups = []
    for group in parser._action_groups:
        flags = [describe_flag(each) for each in group._group_actions if _is_shown(each)]
        title = "" if group.title in ("positional arguments", "options") else group.title or ""
        if flags:
            groups.append({"title": title[:1].lower() + title[1:], "flags": flags})
    return {"renamed": dict(getattr(module, "RENAMED", {})), "groups": groups}


def make_train_table() -> list[dict[str, Any]]:
    """Make the table of the settings of training."""
    from train import cli
    from train.task import SkinTask

    run = ArgumentParser()
    run.add_argument("--config", action="config", help="YAML with any of these options")
    run.add_argument("--run", type=str, default="runs/run", help="folder of the run")
    run.add_argument("--seed_everything", type=int, default=0, help="seed of all random numbers")
    run.add_argument("--ckpt_path", type=Path, help="checkpoint to go on from, or to evaluate")
    for name in ("max_epochs", "max_steps", "devices", "fast_dev_run"):
        run.add_argument(f"--trainer.{name}", type=int, help=_TRAINER[name])
    for name in ("accelerator", "precision", "strategy"):
        run.add_argument(f"--trainer.{name}", type=str, help=_TRAINER[name])
    groups = _list_groups(run, "")
    model = ArgumentParser()
    model.add_class_arguments(SkinTask, "model")
    groups += _list_groups(model, "the network and its losses")
    for kind in (cli.SyntheticFaces, cli.Portraits, cli.PortraitPairs, cli.FittedFaces):
        data = ArgumentParser()
        data.add_class_arguments(kind, "data.init_args")
        groups += _list_groups(data, f"data: class_path {kind.__name__}")
    return groups


def _list_groups(parser: ArgumentParser, title: str) -> list[dict[str, Any]]:
    flags = [describe_flag(each) for each in parser._actions if _is_shown(each)]
    shown = [flag for flag in flags if flag["help"] and "--print-config" not in flag["names"]]
    return [{"title": title, "flags": shown}]


def _is_shown(action: argparse.Action) -> bool:
    return not any(
        name in ("-h", "--help") or name.endswith(".help") for name in action.option_strings
    )


def describe_flag(action: argparse.Action) -> dict[str, Any]:
    """Describe a flag by the arguments of argparse's `add_argument`."""
    flags = [
        each.replace("_", "-") if each.startswith("--") else each
        for each in action.option_strings
        if not each.endswith("+")
    ]
    found: dict[str, Any] = {"names": flags or [action.dest]}
    if isinstance(action, argparse._StoreTrueAction):
        found["action"] = "store_true"
    elif type(action).__name__ == "_ActionPrintConfig":
        found |= {"nargs": "?", "metavar": "skip_default"}
    elif flags:
        found["metavar"] = name_value(action)
    if action.nargs is not None and "nargs" not in found and action.nargs != 0:
        found["nargs"] = action.nargs
    found["help"] = write_help(action)
    return found


def name_value(action: argparse.Action) -> str:
    """Name the value of a flag in its help."""
    if action.dest == "output":
        return "DIR"
    if type(action).__name__ == "ActionConfigFile":
        return "FILE.yaml"
    text = _name_type(action)
    if text.startswith("tuple") or "tuple[" in text:
        return "[A,B,...]"
    name = text.partition(" | ")[0]
    restricted = {"Int": "N", "Float": "X"}  # such as PositiveInt
    return _METAVARS.get(name) or next(
        (short for kind, short in restricted.items() if name.endswith(kind)), "VALUE"
    )


def _name_type(action: argparse.Action) -> str:
    hint = getattr(action, "_typehint", action.type)
    return hint.__name__ if isinstance(hint, type) and "[" not in str(hint) else _shorten(str(hint))


def _shorten(text: str) -> str:
    return re.sub(r"\b(?:pathlib\.|_local\.|typing\.)", "", text)


def write_help(action: argparse.Action) -> str | None:
    """Write what a flag does, as the help of photographs' verbs says it, with its default."""
    if type(action).__name__ == "_ActionPrintConfig":
        return "print the settings as YAML, and end; skip_default leaves out the defaults"
    if type(action).__name__ == "_ActionConfigLoad":
        return None  # A YAML file of one group works too, and is not worth a line.
    text = " ".join((action.help or "").split()).removesuffix(".").replace("`", "")
    if re.match(r"[A-Z]( |[a-z])", text):
        text = text[0].lower() + text[1:]
    default = action.default
    if default in (None, argparse.SUPPRESS) or not action.option_strings:
        return text.replace("%", "%%")
    if isinstance(action, argparse._StoreTrueAction) or "by default" in text:
        return text.replace("%", "%%")
    return f"{text}; {_write_value(default)} by default".replace("%", "%%")


def _write_value(value: object) -> str:
    return json.dumps(value).replace(" ", "").strip('"')


def write_table(table: Any) -> str:
    """Write a table as text."""
    return json.dumps(table, indent=1, ensure_ascii=False) + "\n"


def main() -> int:
    """Write both tables."""
    for path, table in ((TABLE, make_table()), (TRAIN_TABLE, make_train_table())):
        path.write_text(write_table(table), encoding="utf-8")
        print(path)
    return 0


if __name__ == "__main__":
    sys.exit(main())
