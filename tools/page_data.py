"""Writes what the web page shares with Python: `python -m tools.page_data`.

The page says the same sentences, by the same limits. They are read from the modules that hold them,
and written to `web/src/python_data.js`; a test fails where that file is another.
"""

import ast
import inspect
import json
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from skinnet.files import write_text
from skinnet.images import _colour_content as colour
from skinnet.images import _face_cover as face_cover
from skinnet.images import _face_skin as face_skin
from skinnet.images import _skin_colours as skin_colours
from skinnet.images import _skin_gaps as skin_gaps
from skinnet.images.faces import _face_regions as face_regions
from skinnet.images.faces import _face_zones as face_zones
from skinnet.images.skin_segmentation import SKIN_AREAS
from skinnet.inference import _doubts as doubts
from skinnet.inference import _face_checks as faces
from skinnet.inference._references import balances, profile_use, tone_curve
from skinnet.inference.full_resolution import _colour_table as colour_table
from skinnet.video import (
    _baseline,
    _blood_response,
    _change_map,
    _change_scale,
    _face_follower,
    _frame_colours,
    _frame_noise,
    _least_change,
    _look_series,
    _map_frame,
    _noise,
    _readings,
    _regions,
    _resting_maps,
    _shot,
    _slow_errors,
    _still_image,
    _texture_space,
    _tone_doubt,
    _track_files,
    _track_panel,
    _video_frames,
    track,
    tracker,
)

TARGET = Path(__file__).parents[1] / "web" / "src" / "python_data.js"

_SENTENCES = {
    "melaninDoubt": (doubts, "Melanin cannot be told"),
    "hemoglobinDoubt": (doubts, "Hemoglobin cannot be told"),
    "lightDoubt": (doubts, "is strongly coloured"),
    "tinted": (doubts, "looks tinted ... the pigments"),
    "noSkin": (doubts, "No skin was found of"),
    "littleSkin": (doubts, "Nearly no skin of ... Its means"),
    "daylight": (doubts, "Give a photograph in daylight"),
    "whiteDoubt": (profile_use, "is far from what is seen without it"),
    "darkSkin": (doubts, "Dark skin is often read as paler"),
    "clipped": (doubts, "is overexposed"),
    "small": (faces, "pixels wide"),
    "outside": (faces, "half of it is needed"),
    "partlyOutside": (faces, "its means are those of this part"),
    "drawn": (faces, "seems to be drawn"),
    "noColour": (colour, "There is no colour in"),
    "tooDark": (colour, "it is too dark"),
    "giveColour": (colour, "give the colour photograph"),
    "greySkin": (colour, "the skin in it is grey"),
    "tone": (colour, "it has one tone of"),
    "noFace": (tracker, "No face was found in the"),
    "framesWithoutFace": (tracker, "frames show no face"),
    "cut": (tracker, "There is a cut at"),
    "noSkinInVideo": (_resting_maps, "No skin was found in the face of the video"),
    "compressed": (_video_frames, "bits a pixel"),
    "shotRefused": (tracker, "is not read"),
    "unclear": (_least_change, "cannot be told"),
    "unreadable": (_least_change, "cannot be read in this face"),
    "whyUnclear": (_least_change, "its skin is dark"),
    "disclaimer": (track, "This is no medical device"),
}
"""Where each sentence is, and some of its words."""

_LIMITS: dict[str, tuple[ModuleType, tuple[str, ...]]] = {
    "DOUBTS": (
        doubts,
        (
            *("_MELANIN_SPAN", "_HEMOGLOBIN_SPAN", "_COLOURED", "_CLIPPED_SHARE", "_DARK_SKIN"),
            *("_TINTED", "_CASTS", "_LITTLE_SKIN"),
        ),
    ),
    "BALANCES": (balances, ("MOST_BLIND",)),
    "FACES": (
        faces,
        (
            *("_LEAST_WIDTH", "_LEAST_INSIDE", "_MOST_INSIDE", "_COLOUR_SIZE", "_FLAT_SIZE"),
            *("_STEPS", "_FLAT_SHARE", "_COLOUR_WIDTH", "_MIDDLE", "_DARK", "_WHITE"),
        ),
    ),
    "COLOUR": (
        colour,
        (
            *("_PIXELS", "_CELLS", "_KNOTS", "_LUMA_CHROMA", "_FACE_MARGIN", "_CLOSE_UP", "_GREY"),
            *("_HEAD", "_FACE", "_HEAD_LIMIT", "_FACE_LIMIT", "_ON_CURVE", "_DARK", "_TINTS"),
        ),
    ),
    "SKIN": (
        skin_colours,
        (
            *("USUAL_RATIOS", "_SKIN_PRECISION", "_MIN_COVARIANCE", "_SPECULAR_SHARES"),
            *("_LOWEST", "_BIN", "_BINS", "_UNSEEN"),
        ),
    ),
    "MASK": (
        face_skin,
        (
            *("_FACE_SIZE", "_SHADING", "_LEAST_EVIDENCE", "_MOST_EVIDENCE", "_LEAST_PRIOR"),
            *("_FACE_ODDS", "_BEARD_ODDS", "_NECK_ODDS", "_LIPS_ODDS", "_LIPS", "_LIPS_WIDTH"),
            *("_BEARD_DARKNESS", "_BEARD_ROUGHNESS", "_LEAST_BEARD", "_EDGE_RADIUS"),
            "_EDGE_VARIANCE",
        ),
    ),
    "GAPS": (
        skin_gaps,
        (
            *("_LARGEST_HOLE", "_SHADOW", "_HIGHLIGHT", "_LOWER_FACE", "_MOST_OFF"),
            *("_LEAST_BEARD", "_ABOVE"),
        ),
    ),
    "COVER": (face_cover, ("_LEAST_EYES", "_LEAST_SHARE")),
    "OUTLINES": (
        face_zones,
        (
            *("_OVAL", "_BROWS", "_NOSTRILS", "_JAW", "_BEARD", "_CHIN_PAD", "_CLOTH", "_NECK"),
            *("RIGHT_EYE", "LEFT_EYE", "LIPS", "INNER_LIPS", "BROW", "CHIN"),
        ),
    ),
    "REGION_OUTLINES": (face_regions, ("_WHOLE", "_CHEEKS", "_LEAST_AREA")),
    "REGIONS": (_regions, ("NAMES", "REGIONS", "FACE")),
    "STATES": (_readings, ("READ", "LOST", "HIDDEN")),
    "INTERVAL": (_readings, ("QUANTILE",)),
    "LEAST_CHANGE": (_least_change, ("_MUCH", "UNREADABLE")),
    "FOLLOWER": (
        _face_follower,
        ("_LEAST_ODDS", "_SEARCH", "_MARGIN", "_SMOOTH", "_CUT", "_THUMBNAIL"),
    ),
    "TEXTURE": (_texture_space, ("SIZE", "_MARGIN")),
    "FRAME_COLOURS": (_frame_colours, ("BRIGHTEST", "DARKEST")),
    "TONE_CURVE": (tone_curve, ("_STEPS",)),
    "TONE_DOUBT": (_tone_doubt, ("_BEND_SD", "_STEP", "_LEAST")),
    "COLOUR_TABLE": (colour_table, ("NODES", "_SHADING")),
    "RESTING": (_resting_maps, ("_MOST_GLOSS", "_LEAST")),
    "RESPONSE": (
        _blood_response,
        ("_RANGE", "_NODES", "_LEAST_COLOUR", "_ROUNDS", "_ANSWER", "_GAIN_SD"),
    ),
    "NOISE": (_noise, ("_SECONDS", "_MOST", "_FLOOR")),
    "SLOW_ERRORS": (_slow_errors, ("_PATCH", "_LEAST_FILLED", "_SMOOTH", "_SECONDS")),
    "LOOKS": (
        _look_series,
        ("_SPACING", "_MOST", "_LEAST", "_CUT", "_LEAST_SPREAD", "_ROUNDS"),
    ),
    "BASELINE": (_baseline, ("_LEAST_TEXELS", "_LEAST_SHARE", "_MOST_CHROMA")),
    "FRAME_NOISE": (_frame_noise, ("_CHROMA_BY_BEND", "_MOST_FACTOR")),
    "CHANGE_SCALE": (_change_scale, ("_SCALE_SD", "_SCALE_BY_TONE", "_MOST_SCALE_SD")),
    "CHANGE_MAP": (
        _change_map,
        ("_BLUR", "_LEAST_SEEN", "_NOISE_SD", "_GLOSS_SD", "_LIGHT_SD", "_STEP", "_LEAST_COLOUR"),
    ),
    "SHOT": (_shot, ("_MOST_BUFFERED", "_GLOSS_SD", "_GLOSS_BY_BEND", "_GLOSS_BY_SHADING")),
    "TRACKER": (tracker, ("_BASELINE", "_LOOKS")),
    "STILL": (_still_image, ("_BLOCK", "_MOST_BLOCK", "_MOST_MEAN", "_LEAST_SECONDS")),
    "FILES": (_video_frames, ("_LEAST_BITS",)),
    "CHANGES": (_map_frame, ("LARGEST_CHANGE", "_CHANGE")),
    "COURSE": (_track_panel, ("_COLOURS", "_SHOWN")),
    "TRACK_TABLE": (_track_files, ("_FIELDS", "_LEVEL")),
}


def main() -> int:
    """Write the file."""
    write_text(TARGET, make_module())
    return 0


def make_module() -> str:
    """Make the module of JavaScript."""
    sentences = {name: _find_sentence(*place) for name, place in _SENTENCES.items()}
    parts = {"SENTENCES": sentences} | {
        name: {limit.lstrip("_"): _round(getattr(module, limit)) for limit in limits}
        for name, (module, limits) in _LIMITS.items()
    }
    parts["SENTENCES"]["grey"] = colour._ALL_GREY
    parts["SKIN"]["AREAS"] = SKIN_AREAS
    parts["TONE_DOUBT"]["USUAL_BEND"] = _tone_doubt.USUAL.bend
    constants = (f"export const {name} = {_write(part)};\n" for name, part in parts.items())
    head = "/** Written by `python -m tools.page_data`; do not change it by hand. */\n"
    return "\n".join((head, *constants))


def _write(part: dict[str, Any]) -> str:
    """One line for each entry."""
    lines = (
        f"  {name}: {json.dumps(value, ensure_ascii=False)},\n" for name, value in part.items()
    )
    return "{\n" + "".join(lines) + "}"


def _find_sentence(module: ModuleType, words: str) -> str:
    """The one text of a module with some words; `{name}` stands for what is filled in.

    Words that stand apart in it are separated by dots. What follows a semicolon about `--region` is
    for the command alone.
    """
    nodes = list(ast.walk(ast.parse(inspect.getsource(module))))
    wholes = [node for node in nodes if isinstance(node, ast.JoinedStr)]
    inner = {id(part) for whole in wholes for part in ast.walk(whole) if part is not whole}
    inner |= {id(node.value) for node in nodes if isinstance(node, ast.Expr)}  # docstrings
    texts = (_read_text(node) for node in nodes if id(node) not in inner)
    parts = words.split(" ... ")
    (found,) = {text for text in texts if all(part in text for part in parts)}
    before, option, _ = found.partition("; --region")
    return f"{before}." if option else found


def _read_text(node: ast.AST) -> str:
    match node:
        case ast.Constant(value=str(text)):
            return text
        case ast.JoinedStr(values=values):
            return "".join(_read_text(value) for value in values)
        case ast.FormattedValue(value=ast.Name(id=name)):
            return f"{{{name}}}"
        case ast.FormattedValue(value=ast.Attribute(attr=name)):
            return f"{{{name}}}"
        case ast.FormattedValue(value=ast.Call(args=[ast.Name(id=name)])):
            return f"{{{name}}}"
        case ast.FormattedValue():
            return "{value}"
    return ""


def _round(limit: Any) -> Any:
    """A limit as numbers of JSON; those of single precision by their shortest digits."""
    if isinstance(limit, np.ndarray | tuple):
        return [_round(each) for each in limit]
    if isinstance(limit, np.floating | np.integer):
        return float(np.format_float_scientific(limit))  # whatever the print options are
    return limit


if __name__ == "__main__":
    raise SystemExit(main())
