"""Everything that is drawn by lot for one picture of a head: skin, paint, light, camera."""

import numpy as np
from numpy.typing import NDArray

from skinnet.physics import LIGHTS

Lot = dict[str, NDArray[np.float32]]

MELANIN = (0.015, 0.25)
"""Base melanin, even in its logarithm: typology angles of 73 to -38 degrees, and with
the gloss that an instrument sees a lightness of 80 to 30."""

WIDE_MELANIN, SHINE = (0.015, 0.33), 0.35
"""Of training alone: base melanin, and the mean logarithm of how much more skin shines.

Very dark skin in photographs is darker and greyer than skin of the test; a network that has not
seen any reads pale skin in little light."""

HEMOGLOBIN = (0.018, 0.090)
"""Base blood, even in its logarithm: somewhat beyond the middle 90 % of measured forearms."""

WHITE_BALANCE_SD = 0.03
CHART = (168, 208)
"""Rows and columns of the charts that skin is painted on."""

NO_SKIN = {"worn": 0, "skin_melanin": np.zeros((1, *CHART)), "skin_blood": np.zeros((1, *CHART))}
"""A lot whose face wears no skin of a hybrid model."""

MOLES = 6
HAIR = ((0.010, 0.008, 0.007), (0.05, 0.03, 0.02), (0.13, 0.07, 0.03), (0.36, 0.25, 0.13),
        (0.30, 0.30, 0.30), (0.60, 0.59, 0.57), (0.18, 0.06, 0.02))  # fmt: skip
IRIS = ((0.03, 0.02, 0.01), (0.08, 0.05, 0.02), (0.06, 0.10, 0.12), (0.07, 0.10, 0.05))
FRAMES = ((0.02, 0.02, 0.02), (0.10, 0.05, 0.03), (0.45, 0.40, 0.30), (0.35, 0.35, 0.36))


def draw_lot(rng: np.random.Generator, size: int, wide: bool = False) -> Lot:
    """One picture of `size` pixels square; every value is float32. `wide` is for training."""
    melanin = np.exp(rng.uniform(*np.log(WIDE_MELANIN if wide else MELANIN)))
    parts = [_skin(rng, melanin), _marks(rng), _features(rng, melanin), _surroundings(rng)]
    parts += [draw_light(rng), draw_camera(rng, size), NO_SKIN]
    lot = {name: value for part in parts for name, value in part.items()}
    if wide:
        lot["oil"] = np.asarray(lot["oil"]) * np.exp(rng.exponential(SHINE))
    return {name: np.asarray(value, np.float32) for name, value in lot.items()}


def _skin(rng: np.random.Generator, melanin: float) -> dict[str, object]:
    return {
        "f_mel": melanin,
        "f_blood": np.exp(rng.uniform(*np.log(HEMOGLOBIN))),
        **draw_regions(rng),
        "melanin_coarse": rng.normal(0, 0.08, (1, 8, 10)),
        "blood_coarse": rng.normal(0, 0.12, (1, 8, 10)),
        "melanin_middle": rng.normal(0, rng.uniform(0.01, 0.06), (1, 24, 30)),
        "blood_middle": rng.normal(0, rng.uniform(0.02, 0.09), (1, 24, 30)),
        "melanin_fine": rng.normal(0, rng.uniform(0.01, 0.07), (1, 84, 104)),
        "blood_fine": rng.normal(0, rng.uniform(0.01, 0.07), (1, 84, 104)),
        "bump": rng.uniform(0.01, 0.07) * rng.standard_normal((2, *CHART), np.float32),
        **draw_gloss(rng),
    }


def draw_regions(rng: np.random.Generator) -> dict[str, object]:
    """Log factors of both pigments at forehead, cheeks, nose, lids, lips, chin."""
    return {
        "melanin_regions": rng.normal((0.1, 0, 0, 0.12, -0.2, 0), (0.12, 0.1, 0.1, 0.15, 0.3, 0.1)),
        "blood_regions": rng.normal((0, 0.3, 0.25, 0.1, 0.8, 0), (0.1, 0.25, 0.2, 0.2, 0.3, 0.12)),
    }


def draw_gloss(rng: np.random.Generator) -> dict[str, object]:
    """How much oil lies on the skin, and the roughness of its lobe."""
    return {"oil": np.exp(rng.normal(-0.1, 0.4)), "roughness": rng.uniform(0.32, 0.65)}


def _marks(rng: np.random.Generator) -> dict[str, object]:
    """Freckles, moles, vessels and spots, sparse on the chart."""
    freckles = rng.random((1, 120, 150)) < rng.choice([0, 0.01, 0.05], p=(0.7, 0.15, 0.15))
    spots = rng.random((1, 60, 74)) < rng.choice([0, 0.004], p=(0.7, 0.3))
    vessels = np.abs(rng.normal(0, 1, (1, 56, 70)))
    return {
        "freckles": rng.uniform(0.2, 0.7) * freckles,
        "spots": rng.uniform(0.2, 0.6) * spots,
        "vessels": rng.choice([0, rng.uniform(0.1, 0.4)], p=(0.6, 0.4)) * (vessels < 0.12),
        # Azimuth, elevation, radius, and log factor of each mole; most of them are absent.
        "moles": np.column_stack(
            [
                rng.uniform((-1.0, -1.0), (1.0, 0.7), (MOLES, 2)),
                rng.uniform(0.008, 0.022, MOLES),
                rng.uniform(0.6, 1.6, MOLES) * (rng.random(MOLES) < 0.25),
            ]
        ),
    }


def _features(rng: np.random.Generator, melanin: float) -> dict[str, object]:
    # Fair hair goes with fair skin; grey hair goes with all.
    fair = melanin < 0.06
    dark = rng.choice(len(HAIR), p=(0.26, 0.2, 0.14, 0.12, 0.12, 0.08, 0.08) if fair
                      else (0.62, 0.16, 0.02, 0.0, 0.12, 0.08, 0.0))  # fmt: skip
    iris = rng.integers(len(IRIS)) if fair else rng.integers(2)
    return {
        "hair": (np.array(HAIR[dark]) * np.exp(rng.normal(0, 0.3))).clip(0.004, 0.8),
        "strands": rng.normal(0, 0.35, (1, 16, 110)),
        "brow": rng.uniform(0.3, 1.0),
        "brow_shape": rng.normal(0, (0.015, 0.03, 0.008)),
        "beard": rng.choice([0.0, rng.uniform(0.7, 1.0)], p=(0.78, 0.22)),
        "moustache": rng.choice([0.0, 1.0], p=(0.3, 0.7)),
        "stubble": rng.choice([0.0, rng.uniform(0.05, 0.35)], p=(0.6, 0.4)),
        "beard_grain": rng.random((1, *CHART), np.float32),
        "lashes": rng.uniform(0.2, 0.9),
        "iris": np.array(IRIS[iris]) * np.exp(rng.normal(0, 0.3)),
        # Nearly neutral: what tells the light's colour.
        "sclera": rng.uniform(0.30, 0.52) * np.exp(rng.normal((0.02, 0, -0.01), 0.025)),
        "teeth": rng.uniform(0.4, 0.65) * np.exp(rng.normal((0.06, 0, -0.15), (0.03, 0, 0.08))),
        "frame": FRAMES[rng.integers(len(FRAMES))],
        "make_up": rng.choice([0.0, rng.uniform(0.2, 0.8)], p=(0.85, 0.15)),
        "lipstick": (np.array([0.35, 0.05, 0.07]) * np.exp(rng.normal(0, 0.3, 3))).clip(0.01, 0.8),
    }


def _surroundings(rng: np.random.Generator) -> dict[str, object]:
    tint = rng.choice([0.03, 0.3], p=(0.6, 0.4))
    cloth = rng.choice([0.03, 0.5], p=(0.6, 0.4))
    return {
        "wall": _colour(rng, tint)[:, None, None]
        * np.exp(_clutter(rng, 3) + rng.normal(0, 0.2, (1, 3, 3))),
        "clutter": _clutter(rng, 12),
        "litter": _clutter(rng, 40),
        "wall_light": np.exp(rng.normal(-0.2, 0.5)),
        "cloth": _colour(rng, cloth),
        "shirt": _colour(rng, 0.02) if rng.random() < 0.3 else (0.75, 0.75, 0.77),
        "pattern": rng.choice([0.1, 0.3], p=(0.7, 0.3)) * _clutter(rng, 40),
        "tie": rng.choice([0.0, 1.0], p=(0.6, 0.4)),
        "tie_colour": _colour(rng, 0.8),
    }


def _clutter(rng: np.random.Generator, cells: int) -> NDArray[np.float64]:
    """Log brightness of what stands about, some of it coloured."""
    grey = rng.normal(0, 0.5, (1, cells, cells)) * rng.choice([0.03, 0.3, 1.0], p=(0.6, 0.25, 0.15))
    tint = rng.normal(0, 0.2, (3, cells, cells)) * rng.choice([0.03, 0.3, 1.0], p=(0.6, 0.25, 0.15))
    return grey + tint


def _colour(rng: np.random.Generator, spread: float) -> NDArray[np.float64]:
    grey = np.exp(rng.uniform(np.log(0.02), np.log(0.9)))
    return (grey * np.exp(rng.normal(0, spread, 3))).clip(0.005, 1)


def draw_light(rng: np.random.Generator) -> dict[str, object]:
    """A sky of spherical harmonics, one to three lamps, and the mixture of their spectra."""
    lamps = rng.normal((0, 0.5, 0.8), (0.7, 0.4, 0.3), (3, 3))
    shares = rng.dirichlet(np.ones(rng.integers(1, 4)))
    sky = rng.normal(0, 1, 9) * (0, 0.16, 0.14, 0.16, 0.05, 0.05, 0.05, 0.05, 0.05)
    sky[1] += 0.10  # more light from above
    daylight = np.eye(len(LIGHTS))[0]
    other = rng.dirichlet(np.full(len(LIGHTS) - 1, 0.4)) * rng.choice([0, rng.uniform(0, 0.4)])
    weights = daylight * (1 - other.sum()) + np.r_[0, other]
    return {
        "sky": sky + np.r_[rng.uniform(0.25, 0.75), np.zeros(8)],
        "lamps": lamps / np.linalg.norm(lamps, axis=1, keepdims=True),
        "strength": np.r_[shares, np.zeros(3 - len(shares))] * rng.uniform(0.15, 0.95),
        # Half width of a lamp in radians: a bare flash, a window.
        "softness": np.exp(rng.uniform(np.log(0.08), np.log(0.7), 3)),
        "light": weights,
        "temperature": 1e6 / np.clip(rng.normal(172, 12), 120, 235),
    }


def draw_camera(rng: np.random.Generator, size: int) -> dict[str, object]:
    """Exposure, white balance, tone curve, blur, noise and compression."""
    return {
        "pick": rng.random(),
        "white_balance": rng.normal(0, WHITE_BALANCE_SD, 2),
        "exposure": np.exp(rng.normal(0, 0.5)),
        "metering": rng.uniform(0, 0.7),
        "tone": rng.normal((0, 0.12), (0.03, 0.15)),
        "blur": rng.uniform(0.35, 1.1) * rng.choice([1, 1, 1, 2]),
        "grain": rng.standard_normal((3, size, size), np.float32),
        "noise": rng.uniform(0, 1, 2) ** 2 * (0.010, 0.012),
        "quality": rng.choice([0, rng.uniform(35, 95)], p=(0.4, 0.6)),
        "flip": rng.integers(2),
    }
