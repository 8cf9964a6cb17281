"""Scarves, roll-necks and collars around the neck."""

import numpy as np

from train.synthetic.bodies.body import Neck
from train.synthetic.bodies.labelled_mesh import LabelledMesh
from train.synthetic.bodies.shell import make_sheet, sample_waves
from train.synthetic.labels import CLOTH, SCARF


def make_scarf(neck: Neck, rng: np.random.Generator) -> LabelledMesh:
    """Make a scarf that is wound around the neck, with folds along it."""
    azimuth, around = np.meshgrid(np.linspace(-np.pi, np.pi, 121), np.linspace(0, 2 * np.pi, 48))
    thick = rng.uniform(0.1, 0.17) * (
        1 + 0.2 * sample_waves(rng, np.sin(azimuth), 0 * around, (2, 1))
    )
    tall = rng.uniform(1.3, 2.2) * thick
    twist = around + rng.uniform(-1, 1) * np.sin(azimuth / 2)
    fold = 0.02 * sample_waves(rng, azimuth, 2 * twist, (1.5, 3)) + 0.012 * np.cos(5 * twist)
    out = (thick + fold) * np.sin(around)
    sag = rng.uniform(0.0, 0.16)
    x = neck.x + (neck.half_width + thick * 0.8 + out) * np.sin(azimuth)
    z = neck.z + (neck.half_depth + thick * 0.8 + out + sag) * np.cos(azimuth)
    y = rng.uniform(-1.3, -1.15) - sag * np.cos(azimuth) + (tall + fold) * np.cos(around)
    return make_sheet(np.stack([x, y, z], -1), SCARF, azimuth, around / 2)


def make_roll_neck(neck: Neck, rng: np.random.Generator) -> LabelledMesh:
    """Make the roll-neck of a pullover."""
    azimuth, down = np.meshgrid(np.linspace(-np.pi, np.pi, 161), np.linspace(0, 1, 40))
    top = rng.uniform(-0.98, -0.82) - 0.12 * np.cos(azimuth)
    rim = np.sin(np.pi * down.clip(0, 0.5)) ** 0.5
    ribs = 0.006 * np.cos(70 * azimuth) + 0.01 * sample_waves(rng, azimuth, down, (2, 5))
    off = 0.06 + 0.05 * rim + ribs
    slim = 0.84 + 0.2 * down
    x = neck.x + (slim * neck.half_width + off) * np.sin(azimuth)
    z = neck.z + (slim * neck.half_depth + off) * np.cos(azimuth)
    y = top + (-1.4 - top) * down
    return make_sheet(np.stack([x, y, z], -1), SCARF, azimuth, y)


def make_collar(neck: Neck, rng: np.random.Generator) -> LabelledMesh:
    """Make the turned-down collar of a shirt or polo shirt, open in front."""
    gap = rng.uniform(0.08, 0.5)
    side, around = np.meshgrid(np.linspace(-1, 1, 121), np.linspace(0, 1, 24))
    azimuth = np.pi + side * (np.pi - gap)
    front = np.abs(side) ** 6
    inner, point = (around < 0.35), rng.uniform(0.05, 0.25)
    share = np.where(inner, around / 0.35, 1 - (around - 0.35) / 0.65)
    tall = rng.uniform(0.18, 0.28)
    off = np.where(inner, 0.05 + 0.04 * (1 - share), 0.06 + 0.16 * (1 - share))
    base = rng.uniform(-1.36, -1.28) - 0.12 * front
    y = base + tall * share - np.where(inner, 0, (0.06 + point * front) * (1 - share))
    y = y + 0.05 * (1 - np.cos(azimuth)) / 2
    x = neck.x + (neck.half_width + off) * np.sin(azimuth)
    z = neck.z + (neck.half_depth + off + 0.08 * front) * np.cos(azimuth)
    return make_sheet(np.stack([x, y, z], -1), CLOTH, x, y)
