"""Tables of spectra, charts and capture profiles."""

from functools import cache
from pathlib import Path
from random import Random

import numpy as np
import yaml

from benchmarks.fuzzing.case import Case
from benchmarks.fuzzing.changes import change_text, change_value
from skinnet.inference import CaptureProfile
from skinnet.inference._references.chart import load_chart
from skinnet.physics.sources import load_camera, load_light

_WORDS = b"wavelength nm red green blue R G B power row column name L a b ; , NaN inf - # %".split()


def make(rng: Random) -> Case:
    """Make a table, which is read as what it was."""
    kind = rng.choice(("light", "camera", "lab", "spectra", "profile"))
    if kind == "profile":
        return Case(_read_profile, {"a.yaml": _write_profile(rng)}, kind)
    text = change_text(_make_tables()[kind], rng, tuple(_WORDS))
    if rng.random() < 0.2:
        text = text.replace(b",", rng.choice((b";", b"\t", b" ", b", ")))
    if rng.random() < 0.1:
        text = text.decode("latin-1").encode(rng.choice(("utf-16", "utf-8-sig", "utf-32")))
    return Case(
        {"light": _read_light, "camera": _read_camera}.get(kind, _read_chart), {"a.csv": text}, kind
    )


def _read_light(folder: Path) -> None:
    light = load_light(folder / "a.csv")
    assert light.isfinite().all() and (light >= 0).all() and light.sum() > 0


def _read_camera(folder: Path) -> None:
    camera = load_camera(folder / "a.csv")
    assert camera.shape[1] == 3 and camera.isfinite().all()


def _read_chart(folder: Path) -> None:
    chart = load_chart(folder / "a.csv")
    assert np.isfinite(chart.cells).all() and np.isfinite(chart.colours).all()


def _read_profile(folder: Path) -> None:
    profile = CaptureProfile.load(folder / "a.yaml")
    profile.save(folder / "again.yaml")
    CaptureProfile.load(folder / "again.yaml")


def _write_profile(rng: Random) -> bytes:
    document: object = {
        "kind": "skinnet capture profile",
        "format": 1,
        "skinnet": "0.2.0",
        "source": {"picture": "a.jpg", "reference": "chart", "format": "JPEG", "camera": "Canon"},
        "capture": {
            "light": {"D65": 0.7, "A": 0.3},
            "temperature": 5000.0,
            "camera": [0.1, 0.2, 0.3],
            "white_balance": [0.1, -0.1],
            "exposure": 1.0,
            "linear": False,
        },
        "correction": [[1.0, 0, 0], [0, 1, 0], [0, 0, 1]],
        "delta_e": [3.0, 1.0],
    }
    for _ in range(rng.choice((0, 1, 1, 2))):
        document = change_value(document, rng)
    text = yaml.safe_dump(document).encode()
    return change_text(text, rng) if rng.random() < 0.4 else text


@cache
def _make_tables() -> dict[str, bytes]:
    bands = range(380, 781, 10)
    patches = [(row, column) for row in range(1, 5) for column in range(1, 7)]
    headings = ",".join(str(band) for band in range(400, 721, 10))
    spectra = [
        ",".join(f"{0.03 * (row + column):.3f}" for _ in range(33)) for row, column in patches
    ]
    tables = {
        "light": "\n".join(["wavelength,power", *(f"{w},{w / 700:.4f}" for w in bands)]),
        "camera": "\n".join(
            [
                "wavelength,red,green,blue",
                *(f"{w},{w / 800:.3f},0.5,{1 - w / 900:.3f}" for w in bands),
            ]
        ),
        "lab": "\n".join(
            [
                "row,column,L,a,b",
                *(f"{r},{c},{20 * r},{5 * c - 15},{10 - 3 * r}" for r, c in patches),
            ]
        ),
        "spectra": "\n".join(
            [
                f"row,column,{headings}",
                *(f"{r},{c},{s}" for (r, c), s in zip(patches, spectra, strict=True)),
            ]
        ),
    }
    return {name: text.encode() for name, text in tables.items()}
