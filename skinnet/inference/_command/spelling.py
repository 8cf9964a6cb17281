"""The spelling of flags: hyphens on the command line, underscores in YAML and in Python."""

from collections.abc import Callable, Sequence


def spell_flags(arguments: Sequence[str]) -> list[str]:
    """Spell long flags with hyphens; their values stay as they are.

    Args:
        arguments: What a user gives, such as --fit.map_weight=0.

    Returns:
        The same with hyphens, such as --fit.map-weight=0.

    Example:
        >>> spell_flags(["--shape_landmarks", "a_b.json", "--fit.map_weight=0"])
        ['--shape-landmarks', 'a_b.json', '--fit.map-weight=0']
    """
    return _change(arguments, lambda name: name.replace("_", "-"))


def spell_keys(arguments: Sequence[str]) -> list[str]:
    """Spell long flags as the keys of YAML, for the parser that reads both.

    Args:
        arguments: What a user gives, such as --fit.map-weight=0.

    Returns:
        The same with underscores, such as --fit.map_weight=0.

    Example:
        >>> spell_keys(["--shape-landmarks", "a-b.json", "--fit.map-weight=0"])
        ['--shape_landmarks', 'a-b.json', '--fit.map_weight=0']
    """
    return _change(arguments, lambda name: name.replace("-", "_"))


def spell_flag(key: str) -> str:
    """Spell a key of YAML as a flag.

    Args:
        key: A key with its groups, such as fit.map_weight.

    Returns:
        The flag, such as --fit.map-weight.
    """
    return "--" + key.replace("_", "-")


def _change(arguments: Sequence[str], spell: Callable[[str], str]) -> list[str]:
    end = arguments.index("--") if "--" in arguments else len(arguments)
    return [*(_spell(word, spell) for word in arguments[:end]), *arguments[end:]]


def _spell(word: str, spell: Callable[[str], str]) -> str:
    if not word.startswith("--"):
        return word
    name, sign, value = word[2:].partition("=")
    return f"--{spell(name)}{sign}{value}"
