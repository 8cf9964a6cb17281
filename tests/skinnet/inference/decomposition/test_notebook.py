"""What a notebook shows is valid HTML, and every text in it is escaped."""

import base64
import io
import re
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
from PIL import Image

from skinnet import Decomposer, Decomposition

VOID = {"img"}


class Checker(HTMLParser):
    """Raises an error unless every element is closed in its order; keeps tags and text."""

    def __init__(self) -> None:
        super().__init__(convert_charrefs=True)
        self.open: list[str] = []
        self.tags: list[str] = []
        self.text: list[str] = []
        self.attributes: dict[str, str | None] = {}

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        self.attributes |= dict(attrs)
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.text.append(data)


def check(html: str) -> Checker:
    checker = Checker()
    checker.feed(html)
    checker.close()
    assert not checker.open
    return checker


def test_it_has_a_picture_and_the_numbers(astronaut: np.ndarray) -> None:
    read = Decomposer(threads=1)(astronaut, detail=False)
    html = read._repr_html_()
    checker = check(html)
    assert {"figure", "img", "figcaption", "table", "tr", "th", "td"} == set(checker.tags)
    text = " ".join(checker.text)
    low, high = (100 * end for end in read.interval()["melanin"])
    assert f"({low:.2g} to {high:.2g} %) of the epidermis" in text
    assert "typology angle" in text and "512 x 512 pixels" in text
    encoded = re.fullmatch(r"data:image/jpeg;base64,([A-Za-z0-9+/=]+)", checker.attributes["src"])
    assert encoded is not None
    picture = Image.open(io.BytesIO(base64.b64decode(encoded[1])))
    assert picture.size[0] < 700 and len(html) < 100_000
    assert np.asarray(picture).std() > 20


def test_texts_are_escaped(decomposition: Decomposition) -> None:
    hostile = '<script>alert("&")</script>'
    html = replace(decomposition, notes=(hostile,))._repr_html_()
    assert "<script" not in html
    checker = check(html)
    assert hostile in checker.text and "script" not in checker.tags


def test_without_skin_it_says_so(skinless_file: Path, astronaut: np.ndarray) -> None:
    html = Decomposer(skinless_file, threads=1)(astronaut)._repr_html_()
    assert check(html).text.count("no skin was found") == 2


def test_the_dictionary_has_plain_types(decomposition: Decomposition) -> None:
    def list_types(value: object) -> set[type]:
        if isinstance(value, dict):
            return {type(key) for key in value}.union(*map(list_types, value.values()), {dict})
        if isinstance(value, list):
            return set[type]().union(*map(list_types, value), {list})
        return {type(value)}

    found = decomposition.to_dict()
    assert list_types(found) <= {dict, list, str, int, float, bool, type(None)}
    assert found["provider"] == "cpu"
    assert found == decomposition.summary()
