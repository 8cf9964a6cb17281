"""Synthetic faces photographed several times: the same head and skin in other light and cameras."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from benchmarks.pictures import find_known
from benchmarks.portraits import PIGMENTS
from benchmarks.test_sets import SHARED, find_ict
from skinnet.physics import Capture
from train.batch import Batch
from train.synthetic.faces import COLLATE, SyntheticFaces, SyntheticScenes
from train.synthetic.scene import SceneParameters
from train.synthetic.variety import Captures


@dataclass(frozen=True)
class RepeatedFaces:
    """Sizes and sources; the defaults are those of the published figures.

    Attributes:
        people: Faces, each with a skin of its own.
        shots: Photographs of each.
        changed: Faces whose pigments are changed.
        heads: Heads that the faces share.
        size: Side of the pictures in pixels.
        captures: Kind of light and cameras.
        optics: Preset of the skin.
        ict: File of ICT-FaceKit; None: all heads are procedural.
        geometry: Folder of the heads.
        seed: Seed of everything.
    """

    people: int = 256
    shots: int = 5
    changed: int = 64
    heads: int = 64
    size: int = 160
    captures: Captures = "wide"
    optics: str = "measured"
    ict: str | None = str(SHARED / "models" / "ict_facekit.npz")
    geometry: str = "runs/geometry"
    seed: int = 0

    def make_faces(self) -> SyntheticFaces:
        """Make the data, and load its heads."""
        data = SyntheticFaces(
            self.size,
            batch_size=self.shots,
            test_heads=self.heads,
            test_samples=self.people * self.shots,
            ict=find_ict(self.ict),
            geometry=self.geometry,
            optics=self.optics,
            seed=self.seed,
            captures=self.captures,
        )
        data.setup("test")
        return data


class Shot(NamedTuple):
    """One photograph of a face.

    Attributes:
        photograph: uint8 sRGB, [size, size, 3].
        skin: Where it shows skin, bool [size, size].
        truth: Natural logarithm of the mean fractions of melanin and hemoglobin, [2].
        known: All that is known of its capture, [1].
    """

    photograph: NDArray[np.uint8]
    skin: NDArray[np.bool_]
    truth: NDArray[np.float64]
    known: Capture


def render_people(settings: RepeatedFaces) -> Iterator[list[Shot]]:
    """Render the photographs of each person."""
    data = settings.make_faces()
    scenes = data.test_dataloader().dataset
    assert isinstance(scenes, SyntheticScenes)
    for person in range(settings.people):
        first = scenes[person]
        others = [scenes[person + shot * settings.people] for shot in range(1, settings.shots)]
        again = [other._replace(head=first.head, face=first.face) for other in others]
        yield split_shots(data.render(COLLATE["mild"]([first, *again]), "test"))


def split_shots(batch: Batch) -> list[Shot]:
    """Split a batch into its photographs; one without skin has a truth of NaN."""
    assert batch.truth is not None
    known = find_known(batch)
    skin = batch.mask > 0.5
    eight_bits = (255 * batch.photograph).round().to(torch.uint8).movedim(1, -1).contiguous()
    return [
        Shot(
            eight_bits[number].numpy(),
            skin[number].numpy(),
            _average_truth(batch, skin, number),
            known.map(lambda value, number=number: value[number : number + 1]),
        )
        for number in range(len(skin))
    ]


def _average_truth(batch: Batch, skin: Tensor, number: int) -> NDArray[np.float64]:
    assert batch.truth is not None
    means = [getattr(batch.truth, name)[number][skin[number]].double().mean() for name in PIGMENTS]
    return torch.stack(means).log().numpy()


def render_changed(
    settings: RepeatedFaces, factors: Sequence[float]
) -> Iterator[tuple[str, list[Shot]]]:
    """Render faces with one pigment multiplied, by its name; all else stays, the exposure too."""
    data = settings.make_faces()
    scenes = data.test_dataloader().dataset
    assert isinstance(scenes, SyntheticScenes)
    for number in range(min(settings.changed, settings.people)):
        fixed = fix_exposure(data, scenes[number])
        for name in PIGMENTS:
            changed = [scale_pigment(fixed, name, factor) for factor in factors]
            yield name, split_shots(data.render(COLLATE["mild"](changed), "test"))


def scale_pigment(scene: SceneParameters, name: str, factor: float) -> SceneParameters:
    """Multiply a pigment of the face of a scene."""
    pigment = getattr(scene.face.skin, name)
    pigment = pigment._replace(fraction=pigment.fraction * factor)
    skin = scene.face.skin._replace(**{name: pigment})
    return scene._replace(face=scene.face._replace(skin=skin))


def fix_exposure(data: SyntheticFaces, scene: SceneParameters) -> SceneParameters:
    """Fix the exposure that the camera's meter chose, which would follow the skin."""
    manual = scene._replace(
        camera=scene.camera._replace(
            exposure=torch.ones_like(scene.camera.exposure),
            metering=torch.zeros_like(scene.camera.metering),
        )
    )
    batch = data.render(COLLATE["mild"]([scene, manual]), "test")
    assert batch.truth is not None
    metered, plain = batch.truth.shading.double().sum((1, 2))
    exposure = (metered / plain.clamp_min(1e-6)).float()
    return manual._replace(camera=manual.camera._replace(exposure=exposure))
