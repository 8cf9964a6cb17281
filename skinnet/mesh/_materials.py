"""MTL files: the colour and the pictures of each material."""

import re
from pathlib import Path
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from skinnet.errors import InputError
from skinnet.mesh._foreign_name import show_name
from skinnet.mesh._obj_lines import Lines, read_lines

_MAPS = re.compile(rb"(map_\w+|bump|disp|decal|norm|refl)$")
_SWITCHES = frozenset("blendu blendv cc clamp".split())
_WORDS = _SWITCHES | frozenset("boost bm texres imfchan type mm".split())
_VECTORS = frozenset("o s t".split())
_WITHOUT_EFFECT = frozenset("blendu blendv boost bm texres".split())
"""Options that filter a picture, or concern bumps."""
_DEFAULTS = {"cc": ["off"], "mm": [0.0, 1.0], "t": [0.0, 0.0, 0.0]}


class PictureStatement(NamedTuple):
    """A line of an MTL file that names a picture; lines count from 1."""

    library: Path
    material: str
    keyword: str
    rest: bytes
    line: int

    def parse(self, lenient: bool = False) -> "Placement":
        """Parse the options before the name; `lenient` passes over those that are refused.

        Raises:
            InputError: For an option that changes the picture's colours, or one that is not known.
        """
        return _parse_placement(self, lenient)

    def describe(self) -> str:
        """Describe where the picture is named."""
        return f"{self.keyword} of material {self.material!r} (line {self.line} of {self.library})"


class Material(NamedTuple):
    """A material; numbers are as the file states them, None where it does not."""

    library: Path
    name: bytes
    diffuse: tuple[float, float, float] | None
    opacity: float | None
    pictures: tuple[PictureStatement, ...]

    @property
    def shown(self) -> str:
        """The name for messages."""
        return show_name(self.name)

    def choose_picture(self) -> PictureStatement | None:
        """Choose the picture of the diffuse colour, else that of the ambient colour."""
        for keyword in ("map_kd", "map_ka"):
            named = [each for each in self.pictures if each.keyword.lower() == keyword]
            if len({each.rest for each in named}) > 1:
                raise InputError(
                    f"{named[1].describe()} names a second picture, {show_name(named[1].rest)}, "
                    f"after {show_name(named[0].rest)}; keep one, or give the picture with "
                    "--texture."
                )
            if named:
                return named[0]
        return None


class Placement(NamedTuple):
    """The name of a picture, and how its texture coordinates are changed."""

    name: bytes
    scale: Float[np.ndarray, "2"]
    offset: Float[np.ndarray, "2"]
    clamp: bool

    @property
    def is_plain(self) -> bool:
        """Whether texture coordinates stay as they are."""
        return bool((self.scale == 1).all() and (self.offset == 0).all()) and not self.clamp

    def place(self, uv: Float[np.ndarray, "_ 2"]) -> Float[np.ndarray, "_ 2"]:
        """Scale and shift texture coordinates."""
        return np.asarray(uv * self.scale + self.offset)


def read_materials(path: Path) -> dict[bytes, Material]:
    """Read the materials of an MTL file by name.

    What stands before the first name belongs to a material without one.

    Raises:
        InputError: If the file cannot be read, or defines a material twice in different ways.
    """
    lines = read_lines(path)
    found: dict[bytes, Material] = {}
    current = Material(path, b"", None, None, ())
    for number in range(len(lines.starts)):
        word, _, rest = lines.take(number).replace(b"\t", b" ").partition(b" ")
        if word.lower() == b"newmtl":
            _add(found, current)
            current = Material(path, rest.strip(), None, None, ())
        elif rest.strip():
            current = _add_line(lines, number, current, word, rest.strip())
    _add(found, current)
    return found


def _parse_placement(statement: PictureStatement, lenient: bool) -> Placement:
    rest, given = _split_options(statement)
    for option, values in given.items():
        harmless = option in _WITHOUT_EFFECT or values == _DEFAULTS.get(option)
        if not lenient and not harmless and option not in ("s", "o", "clamp"):
            shown = " ".join(str(value) for value in values)
            raise InputError(
                f"{statement.describe()} has the option -{option} {shown}, which is not applied; "
                "remove it, or give the finished picture with --texture."
            )
    scale, offset = (_pad(given.get(key, []), fill) for key, fill in (("s", 1.0), ("o", 0.0)))
    return Placement(rest, scale, offset, given.get("clamp") == ["on"])


def _add(found: dict[bytes, Material], material: Material) -> None:
    if material == Material(material.library, b"", None, None, ()):
        return
    before = found.setdefault(material.name, material)
    one, other = ([each.rest for each in mtl.pictures] for mtl in (before, material))
    if one != other or before.diffuse != material.diffuse:
        raise InputError(
            f"{material.library} defines material {show_name(material.name)!r} twice, in different "
            "ways; give them different names."
        )


def _add_line(lines: Lines, number: int, current: Material, word: bytes, rest: bytes) -> Material:
    keyword = word.lower()
    if _MAPS.match(keyword):
        name, written = show_name(current.name), word.decode("ascii", "replace")
        statement = PictureStatement(lines.path, name, written, rest, number + 1)
        return current._replace(pictures=(*current.pictures, statement))
    if keyword == b"kd":
        numbers = [_number(each) for each in rest.split()[:3]]
        if None not in numbers:  # other colours are spectra or CIE XYZ
            red, green, blue = [*numbers, *(numbers[:1] * 2)][:3]
            return current._replace(diffuse=(red or 0.0, green or 0.0, blue or 0.0))
    if keyword in (b"d", b"tr"):
        values = [value for each in rest.split() if (value := _number(each)) is not None]
        if values:
            opacity = values[-1] if keyword == b"d" else 1 - values[-1]
            return current._replace(opacity=opacity)
    return current


def _split_options(statement: PictureStatement) -> tuple[bytes, dict[str, list[float | str]]]:
    rest, given = statement.rest, dict[str, list[float | str]]()
    while rest.startswith(b"-"):
        word, _, after = rest.partition(b" ")
        option = word[1:].decode("latin-1").lower()
        if option in _VECTORS:
            values, rest = _take(after, 3)
        elif option in _WORDS:
            values, rest = _take_words(after, 2 if option == "mm" else 1)
        else:
            return rest, given  # a name that begins with a hyphen
        given[option] = values
    return rest, given


def _take(text: bytes, most: int) -> tuple[list[float | str], bytes]:
    values: list[float | str] = []
    while len(values) < most:
        word, _, after = text.lstrip().partition(b" ")
        value = _number(word)
        if value is None:
            break
        values.append(value)
        text = after
    return values, text.strip()


def _take_words(text: bytes, count: int) -> tuple[list[float | str], bytes]:
    words = text.split(None, count)
    values = [_number(word) for word in words[:count]]
    shown = [
        word.decode("latin-1").lower() if value is None else value
        for word, value in zip(words[:count], values, strict=True)
    ]
    return shown, words[count].strip() if len(words) > count else b""


def _number(word: bytes) -> float | None:
    try:
        return float(word)
    except ValueError:
        return None


def _pad(values: list[float | str], fill: float) -> Float[np.ndarray, "2"]:
    numbers = [float(value) for value in values[:2]]
    return np.array([*numbers, *[fill] * (2 - len(numbers))])
