"""The numbers of a decomposition as plain types, for JSON."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from skinnet._version import __version__
from skinnet.inference._decomposition.maps import MAP_FILES, SKIN_THRESHOLD
from skinnet.inference._decomposition.readings import SkinReadings
from skinnet.inference._uncertainty import PIGMENTS, summarise_mean


def summarise(readings: SkinReadings) -> dict[str, Any]:
    """Summarise maps, light and camera, as `Decomposition.to_dict` describes."""
    skin = readings.mask > SKIN_THRESHOLD
    height, width = skin.shape
    names = [name for name in MAP_FILES if name != "mask"]
    return {
        "id": readings.face_id,
        "faces_found": readings.faces_found,
        "photo": {"width": width, "height": height},
        "colour_space": {
            "name": readings.colour_space.name,
            "known_from": readings.colour_space.known_from,
        },
        "notes": list(readings.notes),
        "box": readings.box._asdict(),
        "skin_share": _round(readings.skin_share),
        "tilt": None if readings.tilt is None else round(readings.tilt, 1),
        "maps": {
            name: {"unit": readings.describe_map(name).unit}
            | _summarise(readings.get_map(name)[skin])
            for name in names
        },
        "pigments": {name: _summarise_pigment(readings, name) for name in PIGMENTS},
        "indices": None if (indices := readings.indices()) is None else indices.to_json(),
        "regions": {name: region.to_json() for name, region in readings.regions.items()},
        "landmarks": None if readings.landmarks is None else _round_points(readings.landmarks),
        "light": round_all(readings.light),
        "camera": round_all(readings.camera),
        "capture_known": list(readings.capture_known),
        "exif": dict(readings.exif),
        "provider": readings.provider,
        "version": __version__,
        "model": dict(readings.model),
    }


def _summarise_pigment(readings: SkinReadings, name: str) -> dict[str, Any]:
    mean = readings.means.get(name)
    summary = summarise_mean(mean, readings._log_sds[name], readings._find_top(name))
    rounded: dict[str, Any] = round_all(summary)
    return rounded


def _round_points(points: NDArray[np.float32]) -> list[list[float]]:
    return [[round(x, 1), round(y, 1)] for x, y in points.tolist()]


def _summarise(values: NDArray[np.float32]) -> dict[str, float | None]:
    if values.size == 0:
        return dict.fromkeys(("mean", "std", "p5", "p95"))
    p5, p95 = np.percentile(values, [5, 95])
    wide = values.astype(np.float64)
    numbers = {"mean": wide.mean(), "std": wide.std(), "p5": p5, "p95": p95}
    return {name: _round(float(number)) for name, number in numbers.items()}


def round_all(numbers: Any) -> Any:
    """Round the numbers of a summary to six significant digits."""
    if isinstance(numbers, dict):
        return {name: round_all(value) for name, value in numbers.items()}
    if isinstance(numbers, list):
        return [_round(number) for number in numbers]
    return None if numbers is None else _round(numbers)


def _round(number: float) -> float:
    """Six significant digits."""
    return float(f"{number:.6g}")
