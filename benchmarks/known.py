"""What each thing that is known of a capture brings, on synthetic faces in wide captures.

    python -m benchmarks.known [--json] [--faces N] [--pairs N] [--people N]

The ladder, each step read of the same faces:

- `nothing`;
- `white`: white balance and exposure by a white or grey card, measured with its errors;
- `chart`: the classic chart beside the face, photographed by the same camera with the same
  processing, is read as `skinnet predict --chart` does. What it tells (white balance, exposure,
  tone curve; light and camera where they are sure) is used as for users. The spectra of the
  patches that are photographed are another copy than those that the reading assumes;
- `light`: the card, and the true light by name;
- `light_and_camera`: the camera by name, too;
- `raw`: the same face as a RAW file, in linear light without processing or compression, with the
  card, the light and the camera.

Each step has, of each pigment, `r_image` (correlation of the mean fraction of each face with the
true one), `error` (root mean square of its logarithm) and `coverage` of the 90 % intervals.
`chart.refused` is the share of charts that are refused; those faces are read with the white card.

`compare` has `benchmarks.changes` for `blind` and `chart`, and `person` five shots of each of some
people, of which nothing is known, fused as `skinnet person` does.
"""

import sys
from collections.abc import Iterator, Mapping
from typing import NamedTuple

import numpy as np
import torch
from numpy.typing import NDArray

from benchmarks import changes
from benchmarks.pictures import choose_known
from benchmarks.portraits import PIGMENTS
from benchmarks.reader import NetworkReader
from benchmarks.repeated_faces import RepeatedFaces, fix_exposure, split_shots
from benchmarks.report import Results, main
from benchmarks.scene_chart import read_scene_chart
from benchmarks.skin_readings import SkinReading, read_skin, stack_readings
from benchmarks.synthetic_constancy import correlate, measure_interval_coverage, measure_people
from skinnet.errors import InputError
from skinnet.images.picture import Picture
from skinnet.inference.capture import Capture as NamedCapture
from skinnet.inference.capture_profile import CaptureProfile
from skinnet.network import SkinAutoencoder
from skinnet.physics import LIGHTS, Capture
from train.synthetic.faces import COLLATE, SyntheticFaces, SyntheticScenes
from train.synthetic.sampling.wide_captures import make_no_processing
from train.synthetic.scene import SceneParameters

SPLIT = "test"

_CARD: tuple[str, ...] = ("white_balance", "exposure")
_LIT = (*_CARD, "light", "temperature")
_NAMED = (*_LIT, "camera")
_RAW = (*_NAMED, "linear")


class Seen(NamedTuple):
    """A photograph as the network sees it, uint8 sRGB [size, size, 3], and what it is told [1]."""

    photograph: NDArray[np.uint8]
    told: Capture | None


class Rung(NamedTuple):
    """A face on every step of the ladder.

    Attributes:
        truth: Natural logarithms of the true mean fractions, [2].
        steps: What is seen, by step.
        refused: Whether the chart was refused.
    """

    truth: NDArray[np.float64]
    steps: Mapping[str, Seen]
    refused: bool


def measure(faces: int = 256, pairs: int = 64, people: int = 256) -> Results:
    """Measure the ladder, and the verbs that stand on it.

    Args:
        faces: Faces on the ladder.
        pairs: Pairs with a change, and as many without, that are compared.
        people: People in five shots each.
    """
    if faces < 3:
        raise InputError(f"A correlation needs 3 faces or more; got {faces}.")
    reader = NetworkReader(SkinAutoencoder.from_pretrained())
    found = score_ladder(list(_read_ladder(RepeatedFaces(people=faces, shots=1), reader)))
    found["compare"] = changes.measure(pairs, ("blind", "chart"))
    scores, _ = measure_people(RepeatedFaces(people=people), {"own": reader})
    fused = scores["own"]["fused5"]
    found["person"] = {
        name: {"r_image": fused[name]["r"], "coverage": fused[name]["coverage"]}
        for name in PIGMENTS
    }
    return found


class Read(NamedTuple):
    """What is read of a face on every step, its truth [2], and whether its chart was refused."""

    truth: NDArray[np.float64]
    steps: Mapping[str, SkinReading]
    refused: bool


def _read_ladder(settings: RepeatedFaces, reader: NetworkReader) -> Iterator[Read]:
    data = settings.make_faces()
    scenes = data.test_dataloader().dataset
    assert isinstance(scenes, SyntheticScenes)
    for number in range(settings.people):
        rung = climb(data, scenes[number], number)
        read = {
            name: read_skin(reader, seen.photograph, known=seen.told)
            for name, seen in rung.steps.items()
        }
        yield Read(rung.truth, read, rung.refused)
        sys.stderr.write(f"\rFaces: {number + 1} read.")
    sys.stderr.write("\n")


def climb(data: SyntheticFaces, scene: SceneParameters, number: int) -> Rung:
    """Photograph a face for every step of the ladder.

    Args:
        data: Renders it.
        scene: One scene.
        number: Its number, on which the noise of the chart depends.
    """
    plain = _tell_all(fix_exposure(data, scene))
    batch = data.render(COLLATE["mild"]([plain, _make_raw(plain)]), SPLIT)
    assert batch.known is not None
    (shot, raw), known = split_shots(batch), batch.known
    first, second = (known.map(lambda value, row=row: value[row : row + 1]) for row in (0, 1))
    card = Seen(shot.photograph, choose_known(first, _CARD))
    profile = read_scene_chart(COLLATE["mild"]([plain]), data.decoder.camera, SPLIT, number)
    steps = {
        "nothing": Seen(shot.photograph, None),
        "white": card,
        "chart": card if profile is None else _apply(profile, shot.photograph),
        "light": Seen(shot.photograph, choose_known(first, _LIT)),
        "light_and_camera": Seen(shot.photograph, choose_known(first, _NAMED)),
        "raw": Seen(raw.photograph, choose_known(second, _RAW)),
    }
    return Rung(shot.truth, steps, profile is None)


def _tell_all(scene: SceneParameters) -> SceneParameters:
    """Mark everything as known, so that the rendered capture holds it, with its errors."""
    known = scene.camera.known
    one = torch.ones_like(known.white)
    told = known._replace(
        white=one, light=one, temperature=one, camera=one, linear=one, exposure=one
    )
    return scene._replace(camera=scene.camera._replace(known=told))


def _make_raw(scene: SceneParameters) -> SceneParameters:
    """The same picture as a RAW file."""
    camera = scene.camera
    return scene._replace(
        camera=camera._replace(
            tone=torch.zeros_like(camera.tone),
            quality=torch.zeros_like(camera.quality),
            linear=torch.ones_like(camera.linear),
            processing=make_no_processing(),
        )
    )


def _apply(profile: CaptureProfile, photograph: NDArray[np.uint8]) -> Seen:
    """Use a profile as users do: undo the tone curve, and tell the rest."""
    if profile.tone is None:
        return Seen(photograph, to_tensors(profile.capture))
    picture, told = profile.linearise(Picture("chart", photograph))
    return Seen(picture.srgb, to_tensors(told))


def to_tensors(capture: NamedCapture) -> Capture:
    """Turn a capture of names and numbers into tensors [1]."""
    parts = {name: value for name, value in capture._asdict().items() if value is not None}
    if "light" in parts:
        parts["light"] = [float(parts["light"].get(name, 0)) for name in LIGHTS]
    return Capture(
        **{name: torch.tensor(value, dtype=torch.float32)[None] for name, value in parts.items()}
    )


def score_ladder(faces: list[Read]) -> Results:
    """Score what is read on every step."""
    truth = np.stack([face.truth for face in faces])
    found: Results = {}
    for name in faces[0].steps:
        reading = stack_readings(face.steps[name] for face in faces)
        found[name] = _score(reading, truth)
    found["chart"]["refused"] = float(np.mean([face.refused for face in faces]))
    return found


def _score(reading: SkinReading, truth: NDArray[np.float64]) -> Results:
    scores = correlate(reading.pigments, truth)
    error = reading.pigments - truth
    return {
        name: {
            "r_image": scores[name]["r"],
            "error": float(np.sqrt(np.nanmean(error[:, index] ** 2))),
            "coverage": measure_interval_coverage(error[:, index], reading.sd[:, index]),
        }
        for index, name in enumerate(PIGMENTS)
    }


if __name__ == "__main__":
    main(
        measure,
        "What each thing that is known of a capture brings.",
        counts={
            "faces": "faces on the ladder; 256 by default",
            "pairs": "pairs with a change, and as many without; 64 by default",
            "people": "people in five shots each; 256 by default",
        },
    )
