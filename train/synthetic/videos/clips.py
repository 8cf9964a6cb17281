"""Clips of all tones, movements and courses, sampled from a seed."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import torch

from train.synthetic.faces import COLLATE, SyntheticFaces, SyntheticScenes
from train.synthetic.sampling.face_sampling import MELANIN_RANGE
from train.synthetic.scene import SceneParameters
from train.synthetic.videos.blood_course import BloodCourse, sample_course
from train.synthetic.videos.clip_renderer import ClipRenderer, ClipSettings
from train.synthetic.videos.head_motion import KINDS, HeadMotion, sample_motion

QUALITY = (8, 17)
"""Range of constant rate factors of H.264: .1 to 1 bit a pixel, as telephones write."""

_SCENES = 8
"""Scenes for each clip: seeds from 0 to 7 take different ones."""


class ClipPlan(NamedTuple):
    """What is sampled of a clip.

    Attributes:
        number: Number of the clip.
        melanin: Base fraction of melanin.
        course: How the blood changes.
        motion: How head and exposure change.
        quality: Constant rate factor of H.264.
    """

    number: int
    melanin: float
    course: BloodCourse
    motion: HeadMotion
    quality: int


@dataclass(frozen=True)
class Clips:
    """Random clips; the same seed gives the same ones.

    Attributes:
        count: Number of clips: tones are spread evenly over all of them.
        settings: Length and size.
        seed: Seed of all but the heads.
        heads: Heads that are shared.
        size: Side in pixels at which heads are cast.
        ict: File of ICT-FaceKit; None: all heads are procedural.
        geometry: Folder of the heads.
    """

    count: int = 60
    settings: ClipSettings = ClipSettings()
    seed: int = 0
    heads: int = 64
    size: int = 256
    ict: str | None = None
    geometry: str = "runs/geometry"

    def make_faces(self) -> SyntheticFaces:
        """Make the data, and load its heads."""
        data = SyntheticFaces(
            self.size,
            test_heads=self.heads,
            test_samples=max(self.count, 1) * _SCENES,
            ict=self.ict,
            geometry=self.geometry,
        )
        data.setup("test")
        return data

    def plan(self, number: int) -> ClipPlan:
        """Sample a clip. Tones go up and down, so that each movement and event has all of them."""
        rng = np.random.default_rng([self.seed, 25, number])
        low, high = np.log(MELANIN_RANGE)
        order = np.random.default_rng([self.seed, 26]).permutation(self.count)
        place = (order[number % self.count] + rng.random()) / self.count
        melanin = float(np.exp(low + place * (high - low)))
        course = sample_course(rng, number, self.settings.seconds)
        motion = sample_motion(rng, KINDS[number % len(KINDS)])
        return ClipPlan(number, melanin, course, motion, int(rng.integers(*QUALITY)))

    def make_renderer(self, data: SyntheticFaces, plan: ClipPlan) -> ClipRenderer:
        """Make the renderer of a clip, of the first scene in which a face is found.

        Raises:
            ValueError: No face is found in eight scenes.
        """
        scenes = data.test_dataloader().dataset
        assert isinstance(scenes, SyntheticScenes)
        for again in range(_SCENES):
            place = (again + self.seed) % _SCENES * self.count + plan.number
            scene = _give_melanin(scenes[place], plan.melanin)
            batch = COLLATE["mild"]([scene])
            seed = 1000 * self.seed + plan.number
            try:
                return ClipRenderer(
                    batch, data.decoder, plan.course, plan.motion, self.settings, seed
                )
            except ValueError:
                continue
        raise ValueError(f"No face is found in the scenes of clip {plan.number}.")


def _give_melanin(scene: SceneParameters, melanin: float) -> SceneParameters:
    """Replace the base fraction of melanin, and keep the face's exposure: a meter would."""
    skin = scene.face.skin
    pigment = skin.melanin._replace(fraction=torch.full_like(skin.melanin.fraction, melanin))
    face = scene.face._replace(skin=skin._replace(melanin=pigment))
    camera = scene.camera._replace(
        metering=torch.full_like(scene.camera.metering, 0.8),
        exposure=scene.camera.exposure**0.3,
    )
    return scene._replace(face=face, camera=camera)
