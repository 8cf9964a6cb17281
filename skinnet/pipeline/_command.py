"""The verbs of the classic pipeline, with settings from YAML and flags."""

import json
from collections.abc import Sequence
from importlib import import_module
from typing import Any

from jsonargparse import Namespace

from skinnet.inference._command.spelling import spell_keys
from skinnet.inference._messages import explain
from skinnet.pipeline._sentence_parser import SentenceParser
from skinnet.pipeline._verbs import PIPELINE_VERBS


def run_verb(verb: str, arguments: Sequence[str]) -> int:
    """Run a verb of the classic pipeline.

    Args:
        verb: fit-shape, maps, build-model, sample or edit-maps.
        arguments: Options of the verb, as on the command line, without -q and -v.

    Returns:
        The exit code: 0, or 2 if one of several scans could not be used.

    Raises:
        InputError: If an option or a file cannot be used.

    Example:
        >>> run_verb("sample", ["--count=0"])
        Traceback (most recent call last):
        ...
        skinnet.errors.InputError: count is 1 or more faces; got 0.
    """
    module: Any = import_module(f"skinnet.pipeline._{verb.replace('-', '_')}")
    parser = make_settings_parser(verb, module)
    parsed: Namespace = parser.parse_args(spell_keys(arguments))
    explain(f"settings: {json.dumps(parsed.as_dict(), default=str)}")
    config: Namespace = parser.instantiate(parsed)
    code: int = module.run(config)
    return code


def make_settings_parser(verb: str, module: Any) -> SentenceParser:
    """Make the parser that reads the settings of a verb; its flags are spelled as keys of YAML."""
    parser = SentenceParser(prog=f"skinnet {verb}", description=PIPELINE_VERBS[verb].summary)
    parser.renamed = getattr(module, "RENAMED", {})
    parser.add_argument(
        "--config", action="config", help="YAML with any of these options, as in configs/"
    )
    module.add_arguments(parser)
    return parser
