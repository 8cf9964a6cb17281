"""The `skinnet` command; each verb imports what is slow to import only when it runs."""

import os
import sys
import time
import traceback
from collections.abc import Mapping, Sequence
from importlib import import_module
from typing import Any

from skinnet.errors import InputError, _explain_missing
from skinnet.inference._command import completion
from skinnet.inference._command.assumptions import (
    PHOTO_PACKAGES,
    SCAN_PACKAGES,
    describe_assumptions,
    describe_versions,
)
from skinnet.inference._command.nearest import suggest
from skinnet.inference._command.overview import describe_verbs
from skinnet.inference._command.photo_verbs import PHOTO_VERBS
from skinnet.inference._command.verb_parser import VerbParser, read_verbosity, take_verbosity
from skinnet.inference._messages import (
    Verbosity,
    explain,
    get_verbosity,
    keep_verbosity,
    note_removed,
    open_missing_streams,
    print_line,
    quit_at_interrupt,
    report,
    set_verbosity,
)
from skinnet.material._verbs import MATERIAL_VERBS
from skinnet.pipeline._flag_table import check_flags, make_parser
from skinnet.pipeline._verbs import PIPELINE_VERBS

_OK, _BROKEN_PIPE, _BAD_INPUT, _FAULT, _INTERRUPTED = 0, 1, 2, 70, 130
"""Exit codes; the second is for an output pipe whose reader has closed it."""

_COMPLETION = "completion"


def _summarise(verbs: Mapping[str, Any]) -> dict[str, str]:
    """What each verb does."""
    return {name: verb.summary for name, verb in verbs.items()}


_VERBS = {
    **_summarise(PHOTO_VERBS),
    **_summarise(MATERIAL_VERBS),
    **_summarise(PIPELINE_VERBS),
    _COMPLETION: completion.SUMMARY,
}
"""All verbs, and what each does."""

_OF_PICTURES = {**PHOTO_VERBS, **MATERIAL_VERBS}
"""Verbs whose flags argparse reads."""

_LEADING = ("-h", "--help", "--version", "-q", "--quiet", "-v", "--verbose")
"""Flags that may stand before the verb."""


def main(argv: Sequence[str] | None = None) -> int:
    """Run one verb of the command.

    Args:
        argv: The arguments; those of the process by default.

    Returns:
        The exit code: 0, 1 for a closed output pipe, 2 for bad input, 70 for a fault of skinnet
        itself, or 130 after Ctrl-C.

    Example:
        >>> main(["predict", "absent.jpg"])  # prints to standard error
        2
    """
    open_missing_streams()
    arguments = list(sys.argv[1:] if argv is None else argv)
    with keep_verbosity():
        try:
            return _run(arguments)
        except BrokenPipeError:
            # The reader has closed the pipe. Python would report that when it flushes at exit.
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
            return _BROKEN_PIPE
        except (InputError, OSError) as error:
            report(error)
            return _BAD_INPUT
        except KeyboardInterrupt:
            return _INTERRUPTED
        except Exception as error:
            return _report_fault(error)
        finally:
            note_removed()


def _run(arguments: list[str]) -> int:
    count = _count_leading_flags(arguments)
    flags = arguments[:count]
    verb, *rest = arguments[count:] or [""]
    if "--version" in flags:
        print_line(describe_versions(PHOTO_PACKAGES if {"-v", "--verbose"} & {*flags} else ()))
        return _OK
    if verb == "help":
        verb, rest = (rest[0], ["--help"]) if rest else ("", [])
    if not verb:
        print_line(describe_verbs(_summarise(PIPELINE_VERBS), _summarise(MATERIAL_VERBS)))
        return _OK
    started = time.perf_counter()
    code = _run_verb(verb, [*flags, *rest])
    explain(f"{verb} took {time.perf_counter() - started:.2f} s.")
    return code


def _report_fault(error: Exception) -> int:
    """Report an error that nobody has foreseen."""
    if get_verbosity() is Verbosity.VERBOSE:
        traceback.print_exception(error)
    report(
        RuntimeError(
            f"An unexpected error, {type(error).__name__}: {error or 'without a message'}. This is "
            "a fault of skinnet; please report it, with what -v prints."
        )
    )
    return _FAULT


def _count_leading_flags(arguments: list[str]) -> int:
    """How many flags stand before the verb; only those that all verbs have are valid there."""
    for count, word in enumerate(arguments):
        if not word.startswith("-"):
            return count
        if word not in _LEADING:
            raise InputError(
                f"skinnet has no flag {word} before the verb.{suggest(word, _LEADING)} "
                "Give the verb first, such as skinnet predict (skinnet --help lists the verbs)."
            )
    return len(arguments)


def _run_verb(verb: str, arguments: list[str]) -> int:
    if verb not in _VERBS:
        meant = f" Did you mean skinnet predict {verb}?" if os.path.exists(verb) else ""
        raise InputError(
            f"There is no verb {verb}.{meant or suggest(verb, _VERBS)} "
            "(skinnet --help lists the verbs)"
        )
    parser = _make_parser(verb)
    if _wants_help(arguments):
        parser.print_help()
        return _OK
    if verb in PIPELINE_VERBS:
        return _run_pipeline(parser, verb, arguments)
    options = parser.parse(arguments)
    set_verbosity(read_verbosity(options))
    if verb == _COMPLETION:
        print_line(completion.write_script(options.shell, _make_parsers()))
        return _OK
    if get_verbosity() is Verbosity.VERBOSE:
        explain(describe_versions(PHOTO_PACKAGES))
        explain(describe_assumptions(parser, options))
    return _run_photo_verb(verb, options)


def _make_parser(verb: str) -> VerbParser:
    if verb in PIPELINE_VERBS:
        return make_parser(verb)
    if verb == _COMPLETION:
        description = f"{completion.SUMMARY[0].upper()}{completion.SUMMARY[1:]}."
        add, examples = completion.add_completion, completion.EXAMPLES
        return VerbParser(f"skinnet {verb}", description, examples, add)
    each = _OF_PICTURES[verb]
    return VerbParser(f"skinnet {verb}", each.description, each.examples, each.add)


def _make_parsers() -> dict[str, tuple[str, VerbParser]]:
    """For each verb what it does, and its parser."""
    return {verb: (summary, _make_parser(verb)) for verb, summary in _VERBS.items()}


def _run_photo_verb(verb: str, options: Any) -> int:
    each = _OF_PICTURES[verb]
    try:
        if each.prepare:
            _find(each.prepare)(options)
        return _BAD_INPUT if _find(each.run)(options) is False else _OK
    except ModuleNotFoundError as error:
        if verb not in MATERIAL_VERBS:
            raise
        raise _explain_missing(error, "textures", f"skinnet {verb}") from error


def _find(place: str) -> Any:
    """The function at MODULE:NAME."""
    module, _, name = place.partition(":")
    return getattr(import_module(module), name)


def _wants_help(arguments: list[str]) -> bool:
    end = arguments.index("--") if "--" in arguments else len(arguments)
    return bool({"-h", "--help"} & {*arguments[:end]})


def _run_pipeline(parser: VerbParser, verb: str, arguments: list[str]) -> int:
    level, arguments = take_verbosity(check_flags(parser, verb, arguments))
    set_verbosity(level)
    if level is Verbosity.VERBOSE:
        explain(describe_versions(SCAN_PACKAGES))
    try:
        with quit_at_interrupt():
            from skinnet.pipeline._command import run_verb

        return run_verb(verb, arguments)
    except ModuleNotFoundError as error:
        raise _explain_missing(error, "scans", f"skinnet {verb}") from error
