"""Files of settings: YAML of the pipeline's verbs, changed, and written from YAML's grammar."""

from functools import cache
from importlib import import_module
from itertools import pairwise
from pathlib import Path
from random import Random
from typing import Any

import yaml

from benchmarks.fuzzing.case import Case
from benchmarks.fuzzing.changes import EXTREME_VALUES, change_text, change_value
from skinnet.files._settings import read_settings
from skinnet.pipeline._command import make_settings_parser
from skinnet.pipeline._verbs import PIPELINE_VERBS

_CONFIGS = Path(__file__).parents[2] / "configs"
_WORDS = (
    b"&a *a !!python/object:os.system !!int !!float !!binary !!set !!omap <<: - : ? | > --- ... "
    b"%YAML [ ] { } ~ null yes no .nan .inf -.inf 0o17 0x1F 1_000 1:30 2020-01-01 "
    b"\"\\x00\" 'it''s' # \t @ ` @x"
).split(b" ")


def make(rng: Random) -> Case:
    """Make a file of settings, which is parsed for a verb."""
    verb = rng.choice(list(PIPELINE_VERBS))
    if rng.random() < 0.15:
        return Case(lambda folder: read_settings(folder / "a.yaml"), {"a.yaml": _write_new(rng)})
    document = make_settings()[verb]
    for _ in range(rng.choice((0, 1, 1, 2, 3))):
        document = change_value(document, rng)
    text = yaml.safe_dump(document).encode()
    if rng.random() < 0.35:
        text = change_text(text, rng, tuple(_WORDS))
    if rng.random() < 0.05:
        text = text.decode("utf-8", "replace").encode(
            rng.choice(("utf-16", "latin-1", "utf-8-sig")), "replace"
        )
    return Case(lambda folder: _parse(verb, folder / "a.yaml"), {"a.yaml": text}, verb)


def _parse(verb: str, path: Path) -> None:
    parser = make_settings_parser(
        verb, import_module(f"skinnet.pipeline._{verb.replace('-', '_')}")
    )
    parser.instantiate(parser.parse_args([f"--config={path}", "input"]))


@cache
def make_settings() -> dict[str, dict[str, Any]]:
    """All settings of each verb, with their defaults and those of `configs`."""
    found = {}
    for verb in PIPELINE_VERBS:
        module = import_module(f"skinnet.pipeline._{verb.replace('-', '_')}")
        parser = make_settings_parser(verb, module)
        parsed = parser.parse_args([f"--config={_CONFIGS / verb}.yaml", "input"])
        settings = yaml.safe_load(parser.dump(parsed, skip_none=False))
        found[verb] = {key: value for key, value in settings.items() if value != ["input"]}
    return found


def _write_new(rng: Random) -> bytes:
    """A document from the grammar, with anchors and aliases, or a bomb of them."""
    if rng.random() < 0.3:
        return _write_bomb(rng)
    return "\n".join(_write_node(rng, 0, [])).encode()


def _write_node(rng: Random, depth: int, anchors: list[str]) -> list[str]:
    indent, lines = "  " * depth, []
    for _ in range(rng.randint(1, 4)):
        key = rng.choice(("a", "fit", "<<", "?", "1", "null", "é", "'b c'", "[1, 2]", "{x: 1}"))
        anchor = ""
        if rng.random() < 0.3:
            anchor = f" &{rng.choice('abc')}"
            anchors.append(anchor[2:])
        if depth < 6 and rng.random() < 0.4:
            lines += [f"{indent}{key}:{anchor}", *_write_node(rng, depth + 1, anchors)]
        elif anchors and rng.random() < 0.4:
            lines.append(f"{indent}{key}: *{rng.choice((*anchors, 'z'))}")
        else:
            value = rng.choice(
                (*map(repr, EXTREME_VALUES[:30]), *(each.decode() for each in _WORDS))
            )
            lines.append(f"{indent}{key}:{anchor} {value}")
    return lines


def _write_bomb(rng: Random) -> bytes:
    """Lists of lists of aliases, or brackets many levels deep, or many keys."""
    match rng.randrange(4):
        case 0:
            open_, close = rng.choice((("[", "]"), ("{a: ", "}"), ("- ", ""), ("? ", "")))
            return ((open_ * 5000) + "x" + close * rng.choice((0, 5000))).encode()
        case 1:
            return "".join(f"k{at}: {at}\n" for at in range(60_000)).encode()
        case 2:
            return (
                "a: " + rng.choice(("9", "0x", "1e", "'", '"', "!" * 3, "&")) * 300_000
            ).encode()
        case _:
            merge = rng.random() < 0.5
            names, many = "abcdefghij", rng.choice((2, 9, 30))
            lines = ["a: &a {x: 1}" if merge else "a: &a [x]"]
            for one, other in pairwise(names):
                aliases = ", ".join([f"*{one}"] * many)
                lines.append(
                    f"{other}: &{other} " + (f"{{<<: [{aliases}]}}" if merge else f"[{aliases}]")
                )
            return "\n".join(lines).encode()
