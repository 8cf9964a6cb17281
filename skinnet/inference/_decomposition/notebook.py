"""How a notebook shows a decomposition: a small picture, the numbers, and the notes."""

from base64 import b64encode
from collections.abc import Iterator
from html import escape
from io import BytesIO

from PIL import Image

from skinnet.inference._decomposition.readings import SkinReadings
from skinnet.inference._tiles import draw_grid, draw_picture, draw_pigment_map
from skinnet.inference._uncertainty import LEVEL, PIGMENTS, describe_percent

_SCALE, _QUALITY = 0.6, 85
"""Size of the picture in that of the panel's tiles, and its quality as JPEG."""

_UNITS = {"melanin": "of the epidermis", "hemoglobin": "of the dermis"}


def to_html(readings: SkinReadings) -> str:
    """Make HTML that stands alone, with every text escaped."""
    height, width = readings.mask.shape
    title = f"Decomposition of {width} x {height} pixels"
    rows = "".join(
        f'<tr><th scope="row">{escape(name)}</th><td>{escape(value)}</td></tr>'
        for name, value in _list_numbers(readings)
    )
    notes = "".join(f"<li>{escape(note)}</li>" for note in readings.notes)
    return (
        f'<figure style="margin:0"><img alt="{escape(_describe(readings))}" '
        f'src="data:image/jpeg;base64,{_encode_picture(readings)}">'
        f"<figcaption>{title}</figcaption></figure><table>{rows}</table>"
        f"{f'<ul>{notes}</ul>' if notes else ''}"
    )


def _describe(readings: SkinReadings) -> str:
    shown = "photograph" if readings._source is not None else "reconstruction"
    return f"{shown}, map of melanin and map of hemoglobin, with their scales in percent"


def _list_numbers(readings: SkinReadings) -> Iterator[tuple[str, str]]:
    """Yield names and numbers of what was read, with units."""
    intervals = readings.interval()
    for name in PIGMENTS:
        if name in readings.means:
            value = describe_percent(readings.means[name], intervals[name])
            yield name, f"{value} {_UNITS[name]}"
        else:
            yield name, "no skin was found"
    indices = readings.indices()
    if indices is not None:
        angle = indices.typology_angle
        low, high = angle.interval
        group = indices.typology_group.replace("_", " ")
        yield "typology angle", f"{angle.value:.0f}° ({low:.0f} to {high:.0f}°), {group}"
    yield "skin", f"{readings.skin_share:.0%} of what was read"
    if readings.face_id is not None:
        yield "face", f"{readings.face_id} of {readings.faces_found}"
    if readings.capture_known:
        yield "known of the capture", ", ".join(readings.capture_known).replace("_", " ")
    yield "intervals", f"hold the true value with a probability of {LEVEL:.0%}"


def _encode_picture(readings: SkinReadings) -> str:
    """The photograph and both maps side by side, as JPEG in base 64."""
    box, source = readings.box.slices, readings._source
    photo = readings.reconstruction if source is None else source.picture.srgb
    first = "photograph" if source is not None else "reconstruction"
    tiles = [draw_picture(first, photo[box])]
    tiles += [
        draw_pigment_map(name, getattr(readings, name)[box], readings.mask[box])
        for name in PIGMENTS
    ]
    image = Image.fromarray(draw_grid(tiles, len(tiles)))
    size = round(image.width * _SCALE), round(image.height * _SCALE)
    buffer = BytesIO()
    image.resize(size, Image.Resampling.LANCZOS).save(buffer, "JPEG", quality=_QUALITY)
    return b64encode(buffer.getvalue()).decode()
