"""What -v says before a verb runs."""

from skinnet import __version__
from skinnet.inference._command.assumptions import describe_assumptions, describe_versions
from skinnet.inference._command.photo_arguments import add_predict
from skinnet.inference._command.verb_parser import VerbParser


def test_what_is_not_given_is_assumed() -> None:
    parser = VerbParser("skinnet predict", "Read.", add=add_predict)
    said = describe_assumptions(parser, parser.parse(["a.jpg", "--light", "D65"]))
    assert "region face" in said and "detail yes" in said and "camera none" in said
    assert "light" not in said and "input" not in said
    assert "region" not in describe_assumptions(parser, parser.parse(["a", "--whole-image"]))


def test_versions_are_named() -> None:
    assert describe_versions() == f"skinnet {__version__}"
    said = describe_versions(["numpy", "no-such-package"])
    assert said.startswith(f"skinnet {__version__}, Python 3.")
    assert ", numpy " in said and said.endswith("no-such-package absent")
