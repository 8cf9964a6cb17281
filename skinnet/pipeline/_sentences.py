"""What the parser of settings says of a mistake, as a sentence."""

import re
from collections.abc import Iterable

from skinnet.inference._command.nearest import suggest

_TYPES = {"float": "a number", "int": "a whole number", "bool": "true or false"}

_IN_GROUP = re.compile(r"Group '([\w.]+)' does not accept option '([\w.]+)'")
_ALONE = re.compile(r"Option '([\w.]+)' is not accepted")
_TYPE = re.compile(r"""Parser key "([\w.]+)": Expected a <class '(\w+)'>. Got value: (.+)""")
_UNION = re.compile(r"""Parser key "([\w.]+)": Does not validate .* Given value: (.+)""")
_CHOICE = re.compile(r"""argument ([\w./-]+): invalid choice: '?(.+?)'? \(choose from (.+)\)""")
_NO_FILE = re.compile(r"""Parser key "config": File does not exist: '(.+)'""")
_UNKNOWN = re.compile(r"unrecognized arguments: (\S+?)(?:=.*| .*)?")
_MISSING = re.compile(r"the following arguments are required: (.+)")


def write_sentence(message: str, program: str, keys: Iterable[str]) -> str:
    """Write the message of the parser in plain words.

    Args:
        message: What the parser says, on one line.
        program: The command.
        keys: The settings of the command.

    Returns:
        The sentence; the message itself if it is of no known kind.

    Example:
        >>> write_sentence("Option 'shap' is not accepted", "skinnet maps", ["shape", "fit.kept"])
        'There is no setting shap. Did you mean shape?'
    """
    if found := _IN_GROUP.fullmatch(message):
        return _refuse(f"{found[1]}.{found[2]}", keys)
    if found := _ALONE.fullmatch(message):
        return _refuse(found[1], keys)
    if found := _UNKNOWN.fullmatch(message):
        flags = ["--" + key.replace("_", "-") for key in keys]
        return f"There is no flag {found[1]}.{suggest(found[1], flags)}"
    if (found := _TYPE.fullmatch(message)) and found[2] in _TYPES:
        return f"{found[1]} is {_TYPES[found[2]]}; got {found[3]}."
    if found := _UNION.fullmatch(message):
        return f"{found[1]} cannot be {found[2]}; look at what it takes."
    if found := _CHOICE.fullmatch(message):
        words = [word.strip(" '") for word in found[3].split(",")]
        return f"{found[1]} is one of {', '.join(words)}; got {found[2]}.{suggest(found[2], words)}"
    if found := _NO_FILE.fullmatch(message):
        return f"There is no file {found[1]}; check the path."
    if found := _MISSING.fullmatch(message):
        return f"{program} needs {found[1]}."
    return message


def _refuse(key: str, keys: Iterable[str]) -> str:
    return f"There is no setting {key}.{suggest(key, keys)}"
