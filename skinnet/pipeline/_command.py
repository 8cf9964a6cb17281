"""The verbs of the classic pipeline, with settings from YAML and flags."""

from collections.abc import Sequence
from importlib import import_module
from typing import Any

from jsonargparse import Namespace

from skinnet.pipeline._sentence_parser import SentenceParser


def run_verb(verb: str, arguments: Sequence[str], description: str) -> int:
    """Run a verb of the classic pipeline.

    Args:
        verb: fit-shape, maps, build-model, sample or edit-maps.
        arguments: Options of the verb, as on the command line.
        description: What the verb does, for its help; a sentence without its end.

    Returns:
        The exit code: 0, or 2 if one of several scans could not be used.

    Raises:
        InputError: If an option or a file cannot be used.

    Example:
        >>> run_verb("sample", ["--count=0"], "random faces from a model")
        Traceback (most recent call last):
        ...
        skinnet.errors.InputError: count is 1 or more faces; got 0.
    """
    module: Any = import_module(f"skinnet.pipeline._{verb.replace('-', '_')}")
    heading = f"{description[0].upper()}{description[1:]}."
    parser = SentenceParser(prog=f"skinnet {verb}", description=heading)
    parser.renamed = getattr(module, "RENAMED", {})
    parser.add_argument(
        "--config", action="config", help="YAML with any of these options, as in configs/."
    )
    module.add_arguments(parser)
    config: Namespace = parser.instantiate(parser.parse_args(list(arguments)))
    code: int = module.run(config)
    return code
