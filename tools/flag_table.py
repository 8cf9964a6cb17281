"""Write the flags of the pipeline verbs for help and shells: `python -m tools.flag_table`.

The verbs take their flags from settings, whose classes import torch. Help and completion read this
table instead. A test compares it with the settings.
"""

import argparse
import json
import re
import sys
from importlib import import_module
from typing import Any

from skinnet.pipeline._command import make_settings_parser
from skinnet.pipeline._flag_table import SWITCH, TABLE
from skinnet.pipeline._verbs import PIPELINE_VERBS

_METAVARS = {
    "Path": "FILE",
    "float": "X",
    "int": "N",
    "str": "NAME",
    "bool": SWITCH,
}


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


def _is_shown(action: argparse.Action) -> bool:
    return not {"-h", "--help"} & {*action.option_strings}


def describe_flag(action: argparse.Action) -> dict[str, Any]:
    """Describe a flag by the arguments of argparse's `add_argument`."""
    flags = [
        each.replace("_", "-") if each.startswith("--") else each for each in action.option_strings
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
    return _METAVARS.get(text.partition(" | ")[0], "VALUE")


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


def write_table(table: dict[str, Any]) -> str:
    """Write the table as text."""
    return json.dumps(table, indent=1, ensure_ascii=False) + "\n"


def main() -> int:
    """Write the table into the package."""
    TABLE.write_text(write_table(make_table()), encoding="utf-8")
    print(TABLE)
    return 0


if __name__ == "__main__":
    sys.exit(main())
