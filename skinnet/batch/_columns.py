"""The columns of the rows that a batch writes: the summary of a face, flattened."""

import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple

from skinnet.images.faces._face_regions import REGION_NAMES
from skinnet.inference._index_table import INDICES
from skinnet.inference._uncertainty import PIGMENTS
from skinnet.inference.decomposition import MAP_FILES

READ, NO_FACE, FAILED = "read", "no_face", "failed"
"""What becomes of a photograph, in the column `status`."""

_ABOUT = {
    "key": ("string", "names one state of one photograph; the rows of its faces share it"),
    "file": ("string", "the photograph: its path, its URL, or its name in a Parquet file"),
    "source": ("string", "full path or URL of the file that was read"),
    "source_row": ("int64", "row in that file, from 0, if it is a Parquet file"),
    "source_size": ("int64", "size of that file in bytes"),
    "source_modified": ("time", "when that file was last written, in UTC"),
    "status": ("string", f"{READ}, {NO_FACE} or {FAILED}"),
    "reason": ("string", "why the photograph was not read; empty if it was"),
    "input_sha256": ("string", "SHA-256 of the photograph's bytes"),
}
_FACE = {
    "id": ("int64", "number of the face in the photograph, from the left, from 1"),
    "faces_found": ("int64", "faces that were found"),
    "photo_width": ("int64", "width of the photograph in pixels"),
    "photo_height": ("int64", "height of the photograph in pixels"),
    "colour_space_name": ("string", "colour space of the photograph"),
    "colour_space_known_from": ("string", "where that is stated; assumed if nowhere"),
    "notes": ("strings", "what the reader of the numbers should know"),
    **{
        f"box_{side}": ("int64", "what was read, in pixels from the upper left corner")
        for side in ("left", "top", "right", "bottom")
    },
    "skin_share": ("double", "part of what was read that is skin, in [0, 1]"),
    "tilt": ("double", "rotation of the face in the picture plane, in degrees"),
}
_CAPTURE = {
    "light_temperature_k": ("double", "temperature of the daylight in kelvin"),
    "camera_components": ("doubles", "sensitivities of the camera, as weights of components"),
    "camera_white_balance_r_over_g": ("double", "error of the white balance, red over green"),
    "camera_white_balance_b_over_g": ("double", "error of the white balance, blue over green"),
    "capture_known": ("strings", "what was given of light and camera"),
    "exif_camera": ("string", "maker and model, as EXIF states it"),
    "exif_flash": ("bool", "whether a flash fired, as EXIF states it"),
    "exif_white_balance": ("string", "auto or manual, as EXIF states it"),
    "exif_light_source": ("string", "the light, as EXIF states it"),
    "provider": ("string", "what ran the networks"),
    "version": ("string", "version of skinnet"),
    "model_version": ("string", "version of the model"),
    "model_trained_on": ("string", "what the model was trained on"),
    "model_optics": ("string", "preset of the skin model that the fractions belong to"),
}
_STATISTICS = {"mean": "mean", "std": "standard deviation", "p5": "5 %", "p95": "95 %"}
_FRACTIONS = {
    "mean": "mean volume fraction",
    "std": "its standard deviation over pixels",
    "median": "median volume fraction",
    "sd": "how uncertain the mean is: its standard deviation",
}


class Column(NamedTuple):
    """The name of a column, the kind of its values, and what it holds."""

    name: str
    kind: str
    description: str


def list_columns(lights: Sequence[str], maps: bool) -> list[Column]:
    """List the columns of a batch: names, kinds and descriptions."""
    found = [Column(name, *each) for name, each in (_ABOUT | _FACE).items()]
    found += [*_list_maps(), *_list_pigments(), *_list_indices("indices_", "the face")]
    for region in REGION_NAMES:
        found += _list_region(region)
    found.append(Column("landmarks", "points", "478 points of the face: [x, y] in pixels"))
    for light in lights:
        found.append(Column(_join("light", light), "double", f"weight of the light {light}"))
    found += [Column(name, *each) for name, each in _CAPTURE.items()]
    if maps:
        found += [Column(name_map(name), "bytes", _describe_png(name)) for name in MAP_FILES]
    return found


def name_map(name: str) -> str:
    """Name the column of a map."""
    return f"map_{name}"


def flatten(value: Any, name: str) -> Iterator[tuple[str, Any]]:
    """The numbers of a summary, by the keys that lead to them."""
    if isinstance(value, Mapping):
        for key, inner in value.items():
            if key == "interval":
                low, high = inner or (None, None)
                yield from ((f"{name}_interval_low", low), (f"{name}_interval_high", high))
            elif key != "unit":
                yield from flatten(inner, _join(name, key) if name else key)
    else:
        yield name, value


def _join(name: str, key: str) -> str:
    """A name that SQL takes without quotes; lights are called LED-B1 and the like."""
    return re.sub(r"\W", "_", f"{name}_{key}")


def _list_maps() -> Iterator[Column]:
    for name in MAP_FILES:
        if name != "mask":
            for key, words in _STATISTICS.items():
                text = f"{name} over skin: {words}"
                yield Column(f"maps_{name}_{key}", "double", text)


def _list_pigments() -> Iterator[Column]:
    for name in PIGMENTS:
        for key in ("mean", "sd"):
            yield Column(f"pigments_{name}_{key}", "double", f"{name}: {_FRACTIONS[key]}")
        yield from _list_interval(f"pigments_{name}", "double", name)
        level = f"{name}: probability of the interval"
        yield Column(f"pigments_{name}_level", "double", level)


def _list_interval(name: str, kind: str, what: str) -> Iterator[Column]:
    for end, words in (("low", "lower"), ("high", "upper")):
        text = f"{what}: {words} end of the 90 % interval"
        yield Column(f"{name}_interval_{end}", kind, text)


def _list_indices(prefix: str, where: str) -> Iterator[Column]:
    for index in INDICES:
        what, name = f"{index} of {where}", f"{prefix}{index}"
        yield Column(f"{name}_value", "double", what)
        yield Column(f"{name}_sd", "double", f"{what}: standard deviation")
        yield from _list_interval(name, "double", what)
    yield Column(f"{prefix}typology_group", "string", f"group of the typology angle of {where}")
    what = f"nearest tone of the Monk Skin Tone Scale to {where}"
    yield Column(f"{prefix}monk_tone_value", "int64", f"{what}, 1 to 10")
    yield from _list_interval(f"{prefix}monk_tone", "int64", what)
    yield Column(f"{prefix}monk_tone_delta_e", "double", f"CIEDE2000 to the {what}")


def _list_region(region: str) -> Iterator[Column]:
    prefix = f"regions_{region}"
    for pigment in PIGMENTS:
        for key, words in _FRACTIONS.items():
            yield Column(f"{prefix}_{pigment}_{key}", "double", f"{pigment} of {region}: {words}")
        yield from _list_interval(f"{prefix}_{pigment}", "double", f"{pigment} of {region}")
    yield Column(f"{prefix}_share", "double", f"part of {region} that is skin, in [0, 1]")
    yield Column(f"{prefix}_pixels", "int64", f"pixels of skin of {region}")
    yield from _list_indices(f"{prefix}_indices_", region)


def _describe_png(name: str) -> str:
    return f"{name} as a 16-bit PNG file: value = scale * pixel + offset, which its texts hold"
