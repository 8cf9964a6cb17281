"""What `skinnet` alone prints: its verbs."""

from collections.abc import Mapping

from skinnet.inference._command import completion
from skinnet.inference._command.photo_verbs import PHOTO_VERBS

_TEXT = """\
usage: skinnet VERB ...

Melanin and hemoglobin maps of a photograph of skin.

verbs of photographs:
{photographs}

{textures}verbs of scans:
{scans}

more verbs:
{more}

options:
  -h, --help     show this text, or after a verb the flags of the verb
  --version      show the version
  -q, --quiet    print errors, and what was asked for, nothing else
  -v, --verbose  print what was assumed, versions and times too

examples:
  # maps, a panel and a summary, in the folder skinmaps beside the photograph
  skinnet predict photo.jpg
  # a tanned copy
  skinnet edit photo.jpg --melanin 1.5
  # the flags of a verb
  skinnet help predict"""

_MORE = {"completion": completion.SUMMARY, "help VERB": "show the flags of a verb"}


def describe_verbs(scans: Mapping[str, str], textures: Mapping[str, str]) -> str:
    """Describe the command and all its verbs.

    Args:
        scans: The verbs of the classic pipeline, and what each does.
        textures: The verbs of textures and materials, and what each does.

    Returns:
        The help of `skinnet`.
    """
    photographs = {name: verb.summary for name, verb in PHOTO_VERBS.items()}
    return _TEXT.format(
        photographs=_list(photographs),
        textures=f"verbs of textures:\n{_list(textures)}\n\n" if textures else "",
        scans=_list(scans),
        more=_list(_MORE),
    )


def _list(verbs: Mapping[str, str]) -> str:
    return "\n".join(f"  {name:12} {summary}" for name, summary in verbs.items())
