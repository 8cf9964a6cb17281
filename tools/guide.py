"""What mkdocs needs to make the guide: `make docs`.

A hook adds pages and pictures that lie outside of docs/. Links between files work in a checkout as
they stand; in the guide, links to these files lead to the pages that the hook adds. An extension of
griffe shows the examples of docstrings as code.
"""

import re
from pathlib import Path
from posixpath import dirname, join, normpath, relpath
from typing import Any

import griffe
from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page

ROOT = Path(__file__).parents[1]
OUTSIDE = {
    "CONTRIBUTING.md": "contributing.md",
    "SECURITY.md": "security.md",
    "skinnet/inference/models/MODEL_CARD.md": "model-card.md",
    "skinnet/inference/models/CHANGELOG.md": "model-changes.md",
    "demo/astronaut.png": "demo/astronaut.png",
    "demo/face_parts.png": "demo/face_parts.png",
    "demo/strip.png": "demo/strip.png",
    "demo/tones.png": "demo/tones.png",
}
"""Files of the repository, and where they are in the guide."""

_EXAMPLE = re.compile(r"^Example:$", re.MULTILINE)
_CODE_OR_LINK = re.compile(
    r"(?P<code>^```.*?^```$)|\]\((?!\w+:|#)(?P<path>[^)#]+)(?P<anchor>#[^)]*)?\)",
    re.MULTILINE | re.DOTALL,
)


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the files that lie outside of docs/."""
    for source, place in OUTSIDE.items():
        files.append(File.generated(config, place, abs_src_path=str(ROOT / source)))
    return files


def on_page_markdown(markdown: str, page: Page, **_: Any) -> str:
    """Turn links between files of the repository into links between pages of the guide."""
    return turn_links(markdown, page.file.src_uri)


def turn_links(markdown: str, place: str) -> str:
    """Turn links between files into links between pages, except in code.

    Args:
        markdown: Text of the page.
        place: Path of the page in the guide.

    Returns:
        The text with its links turned.
    """
    origin = next((source for source, to in OUTSIDE.items() if to == place), f"docs/{place}")

    def turn(found: "re.Match[str]") -> str:
        if found["code"] is not None:
            return found[0]
        target = normpath(join(origin, "..", found["path"]))
        inside = OUTSIDE.get(target, target.removeprefix("docs/"))
        return f"]({relpath(inside, dirname(place) or '.')}{found['anchor'] or ''})"

    return _CODE_OR_LINK.sub(turn, markdown)


class ExampleSections(griffe.Extension):
    """Gives the section `Example` the name that griffe knows."""

    def on_object(self, *, obj: griffe.Object, **_: Any) -> None:
        """Rename the section in the docstring of an object."""
        if obj.docstring is not None:
            obj.docstring.value = _EXAMPLE.sub("Examples:", obj.docstring.value)
