"""Everything that is drawn by lot for one synthetic portrait, before any of it is rendered."""

import numpy as np
from numpy.typing import NDArray

from skinnet.camera import COMPONENTS, LIGHTS
from skinnet.shape.procedural import IDENTITY

Scene = dict[str, NDArray[np.float32]]

HAIR = ((0.010, 0.008, 0.007), (0.05, 0.03, 0.02), (0.13, 0.07, 0.03), (0.36, 0.25, 0.13),
        (0.30, 0.30, 0.30), (0.60, 0.59, 0.57), (0.18, 0.06, 0.02))  # fmt: skip
IRIS = ((0.03, 0.02, 0.01), (0.08, 0.05, 0.02), (0.06, 0.10, 0.12), (0.07, 0.10, 0.05))

MELANIN = (0.01, 0.24)
HEMOGLOBIN = (0.018, 0.08)
WHITE_BALANCE_SD = 0.03


def draw_scene(rng: np.random.Generator, size: int) -> Scene:
    """One scene, its picture to be `size` pixels square; every value is float32."""
    parts = (_pose(rng), _skin(rng), _features(rng), _surroundings(rng), _light(rng), _capture(rng))
    scene = {name: value for part in parts for name, value in part.items()}
    scene["grain"] = rng.normal(0, rng.uniform(0.0, 0.012), (3, size, size))
    return {name: np.asarray(value, np.float32) for name, value in scene.items()}


def draw_conditions(rng: np.random.Generator, size: int) -> Scene:
    """Light, gloss, camera and grain of a picture of a face that is drawn otherwise."""
    skin = _skin(rng)
    scene = {name: skin[name] for name in ("oil", "sharpness")} | _light(rng) | _capture(rng)
    scene["grain"] = rng.normal(0, rng.uniform(0.0, 0.012), (3, size, size))
    return {name: np.asarray(value, np.float32) for name, value in scene.items()}


def _pose(rng: np.random.Generator) -> dict[str, object]:
    return {
        "identity": rng.normal(0, 1, IDENTITY).clip(-2.5, 2.5),
        "angles": rng.normal(0, (0.12, 0.30, 0.10)).clip(-0.6, 0.6),
        "zoom": rng.uniform(0.48, 0.88),
        "centre": rng.normal(0, (0.06, 0.08)).clip(-0.2, 0.2) + (0.0, 0.05),
    }


def _skin(rng: np.random.Generator) -> dict[str, object]:
    return {
        "f_mel": np.exp(rng.uniform(*np.log(MELANIN))),
        "f_blood": np.exp(rng.uniform(*np.log(HEMOGLOBIN))),
        # Log factors of melanin and hemoglobin at forehead, cheeks, nose, lids, lips, chin.
        "melanin_regions": rng.normal((0.1, 0, 0, 0.1, -0.3, 0), (0.15, 0.1, 0.1, 0.15, 0.3, 0.1)),
        "blood_regions": rng.normal((0, 0.3, 0.2, 0.1, 0.8, 0.0), (0.1, 0.2, 0.2, 0.2, 0.3, 0.1)),
        "melanin_coarse": rng.normal(0, 0.08, (1, 8, 9)),
        "blood_coarse": rng.normal(0, 0.10, (1, 8, 9)),
        "melanin_fine": rng.normal(0, rng.uniform(0.01, 0.07), (1, 48, 58)),
        "blood_fine": rng.normal(0, rng.uniform(0.01, 0.07), (1, 48, 58)),
        "freckles": rng.random((1, 70, 84)) < rng.choice([0, 0, 0, 0, 0.01, 0.04]),
        "oil": rng.uniform(0, 0.45) ** 1.5,
        "sharpness": np.exp(rng.uniform(np.log(4), np.log(60))),
    }


def _features(rng: np.random.Generator) -> dict[str, object]:
    hair = np.array(HAIR[rng.integers(len(HAIR))]) * np.exp(rng.normal(0, 0.3))
    return {
        "hair": hair.clip(0.004, 0.8),
        "strands": rng.normal(0, 0.3, (1, 12, 90)),
        "hairline": rng.choice([rng.uniform(0.55, 0.95), rng.uniform(0.95, 1.4)], p=(0.8, 0.2)),
        "sides": rng.uniform(0.95, 1.45),
        "volume": rng.uniform(0.02, 0.22),
        "length": rng.choice([0.0, rng.uniform(0.2, 1.3)], p=(0.5, 0.5)),
        "brow": rng.uniform(0.4, 1.0),
        "beard": rng.choice([0.0, rng.uniform(0.1, 1.0)], p=(0.7, 0.3)),
        "iris": IRIS[rng.integers(len(IRIS))],
        "eye": rng.uniform(0.030, 0.060),
        "smile": rng.choice([0.0, rng.uniform(0.02, 0.075)], p=(0.5, 0.5)),
        "glasses": rng.choice([0.0, 1.0], p=(0.85, 0.15)),
    }


def _surroundings(rng: np.random.Generator) -> dict[str, object]:
    tint = rng.choice([0.02, 0.25])
    return {
        "wall": _colour(rng, tint)[:, None, None] * np.exp(rng.normal(0, 0.25, (3, 3, 3))),
        "clutter": rng.choice([0.0, 1.0]) * rng.normal(0, 0.5, (3, 14, 14)),
        "cloth": _colour(rng, 0.5)[:, None, None] * np.exp(rng.normal(0, 0.1, (1, 5, 5))),
        "pattern": rng.choice([0.0, 0.4]) * rng.normal(0, 1, (3, 24, 24)),
        "shoulders": rng.uniform((0.75, 0.5, 0.9), (1.15, 1.2, 2.2)),
        "neck": rng.uniform(0.36, 0.52),
    }


def _colour(rng: np.random.Generator, spread: float) -> NDArray[np.float64]:
    grey = np.exp(rng.uniform(np.log(0.02), np.log(0.9)))
    return (grey * np.exp(rng.normal(0, spread, 3))).clip(0.005, 1)


def _light(rng: np.random.Generator) -> dict[str, object]:
    lamps = rng.normal((0, 0.5, 0.8), (0.7, 0.4, 0.3), (3, 3))
    strength = rng.dirichlet(np.ones(3)) * rng.uniform(0.2, 0.9)
    return {
        "sky": np.concatenate([[rng.uniform(0.25, 0.8)], rng.normal((0, 0.1, 0.1), 0.12)]),
        "lamps": lamps / np.linalg.norm(lamps, axis=1, keepdims=True),
        "strength": strength,
        "occlusion": rng.uniform(0, 6),
        "exposure": np.exp(rng.normal(0.1, 0.35)),
        "wall_light": np.exp(rng.normal(-0.2, 0.5)),
        "blur": rng.uniform(0.0, 0.9),
    }


def _capture(rng: np.random.Generator) -> dict[str, object]:
    weights = rng.dirichlet(np.full(len(LIGHTS), 0.2)) + np.eye(len(LIGHTS))[0] * rng.integers(2)
    return {
        "light": weights / weights.sum(),
        "temperature": 1e6 / rng.uniform(60, 240),
        "camera": rng.normal(0, 0.8, COMPONENTS).clip(-2.5, 2.5),
        "white_balance": rng.normal(0, WHITE_BALANCE_SD, 2),
    }
