"""One shot of a video, between two cuts: its baseline, its resting maps, and its readings."""

from contextlib import suppress
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from skinnet.errors import InputError
from skinnet.images.faces._face_place import place_face, to_box
from skinnet.images.faces.face import Face
from skinnet.inference._uncertainty import PIGMENTS
from skinnet.inference.decomposer import Decomposer
from skinnet.inference.full_resolution._colour_table import tabulate_colours
from skinnet.video._baseline import Baseline
from skinnet.video._blood_response import BloodResponse
from skinnet.video._change_map import ChangeMap
from skinnet.video._change_scale import find_scale_sd
from skinnet.video._face_follower import Followed
from skinnet.video._frame_colours import FrameColours
from skinnet.video._frame_noise import FrameNoise
from skinnet.video._look_series import LookSeries, PooledMelanin
from skinnet.video._readings import HIDDEN, LOST, READ, Reading, make_blank
from skinnet.video._regions import FACE, NAMES
from skinnet.video._resting_maps import Look, RestingMaps, pool_looks, read_look
from skinnet.video._texture_space import Points, TextureSpace, sample
from skinnet.video._tone_doubt import ToneDoubt

_MOST_BUFFERED = 1200
"""Frames of the baseline that are kept at most; later ones of it are left out."""

_GLOSS_SD, _GLOSS_BY_BEND = 0.006, 0.5
"""Standard deviation of the change of gloss, in shares of a region's green light, of a still head,
and by how much it grows with the bend of the mesh."""

_GLOSS_BY_SHADING = 0.5
"""How much gloss may change with shading, where the head turns in the light."""

Array = NDArray[np.float64]


class _Buffered(NamedTuple):
    """A frame of the baseline that waits for its end."""

    number: int
    time: float
    colours: NDArray[np.float32] | None
    bend: float


class Shot:
    """Reads the frames of one shot.

    Args:
        decomposer: Reads the face at rest.
        number: Number of the shot, from 1.
        start: Time stamp of its first frame, in seconds.
        baseline: First and last second of the baseline, from the start of the shot.
        looks: Frames of the baseline that the network reads.
        colours: Samples frames.
        capture: What is known of light and camera.
        with_maps: Whether readings have a map of the face.

    Attributes:
        refusal: Why a frame of the baseline could not be read; None if all could.
        is_refused: Whether none could, so that no frame of the shot is read.
    """

    def __init__(
        self,
        decomposer: Decomposer,
        number: int,
        start: float,
        baseline: tuple[float, float],
        looks: int,
        colours: FrameColours,
        capture: object | None,
        with_maps: bool,
    ) -> None:
        self._decomposer, self.number, self.start = decomposer, number, start
        self._baseline, self._wanted = baseline, looks
        self._colours, self._capture, self._with_maps = colours, capture, with_maps
        self._doubt = ToneDoubt(colours.tone)
        self._space: TextureSpace | None = None
        self._buffer: list[_Buffered] = []
        self._looks: list[Look] = []
        self._times: list[float] = []
        self._series = LookSeries()
        self.rest: RestingMaps | None = None
        self.portrait: NDArray[np.uint8] | None = None
        self.notes: tuple[str, ...] = ()
        self.refusal: InputError | None = None
        self.is_refused = False

    def add(
        self, number: int, time: float, frame: NDArray[np.uint8], followed: Followed
    ) -> list[Reading]:
        """Add a frame. Returns the readings that are ready: all of the baseline at its end."""
        if self.is_refused:
            return [make_blank(number, time, self.number, HIDDEN, len(NAMES))]
        colours = self._sample(frame, followed)
        if self.rest is None and colours is not None:
            self._look(frame, time, followed)
        if self.rest is not None:
            if colours is not None and self._series.is_due(time):
                self._look_again(frame, time, followed)
            return [self._read(number, time, colours, followed.bend)]
        if len(self._buffer) < _MOST_BUFFERED:
            self._buffer.append(_Buffered(number, time, colours, followed.bend))
        if time - self.start >= self._baseline[1] and (self._looks or self.refusal):
            return self.finish()
        return []

    def finish(self) -> list[Reading]:
        """End the baseline now. Returns the readings of the frames that waited."""
        waiting, self._buffer = self._buffer, []
        if self.rest is None and self._looks:
            self._begin(waiting)
        if self.rest is None:
            self.is_refused = self.refusal is not None
            state = HIDDEN if self.is_refused else LOST
            return [make_blank(one.number, one.time, self.number, state, len(NAMES))
                    for one in waiting]  # fmt: skip
        return [self._read(*one) for one in waiting]

    @property
    def space(self) -> TextureSpace:
        """The texture space of the shot."""
        assert self._space is not None
        return self._space

    def _sample(self, frame: NDArray[np.uint8], followed: Followed) -> NDArray[np.float32] | None:
        if followed.landmarks is None:
            return None
        if self._space is None:
            self._space = TextureSpace.from_landmarks(followed.landmarks)
        return self._colours(frame, self._space, followed.landmarks)

    def _look(self, frame: NDArray[np.uint8], time: float, followed: Followed) -> None:
        """Let the network read the frame, if it is time for another look."""
        begin, end = self._baseline
        due = begin + len(self._looks) * (end - begin) / max(self._wanted - 1, 1)
        if time - self.start < due - 1e-6 or len(self._looks) >= self._wanted:
            return
        assert followed.landmarks is not None
        try:
            look = self._read_look(frame, time, followed.landmarks)
        except InputError as error:  # a later frame may be better
            self.refusal = error
            return
        self._looks.append(look)
        self._times.append(time)
        if self.portrait is None:
            points = self.space.place(followed.landmarks)
            picked = sample(frame.astype(np.float32), points)
            self.portrait = np.rint(self.space.fill(picked, 232.0)).astype(np.uint8)

    def _read_look(self, frame: NDArray[np.uint8], time: float, landmarks: Points) -> Look:
        square = place_face(landmarks)
        face = Face(to_box(square), float(np.degrees(square.tilt)), 1.0, landmarks)
        name = f"the frame at {time:.2f} s"
        return read_look(self._decomposer, frame, face, self.space, name, self._capture)

    def _look_again(self, frame: NDArray[np.uint8], time: float, followed: Followed) -> None:
        """Read melanin once more; readings that were given do not depend on it."""
        assert followed.landmarks is not None
        self._series.postpone(time)
        with suppress(InputError):  # such as a face that has become too small
            self._add_melanin(time, self._read_look(frame, time, followed.landmarks))

    def _add_melanin(self, time: float, look: Look) -> None:
        face = self._base.regions[NAMES.index(FACE)]
        share = float(look.maps["mask"][face].mean()) if face.any() else 0.0
        self._series.add(time, look.maps["melanin"], share)

    def pool_melanin(self) -> PooledMelanin:
        """Pool the melanin of all looks of the shot."""
        face = self._base.regions[NAMES.index(FACE)]
        return self._series.pool(face if face.any() else self.space.inside[self.space.inside])

    def _begin(self, waiting: list[_Buffered]) -> None:
        """Set the baseline, and the answer of the regions to blood."""
        self.notes = tuple(dict.fromkeys(note for look in self._looks for note in look.notes))
        self.rest = pool_looks(self._looks)
        begin, end = self._baseline
        chosen = [
            one.colours
            for one in waiting
            if one.colours is not None and begin <= one.time - self.start <= end
        ] or [one.colours for one in waiting if one.colours is not None]
        regions = self.space.regions[:, self.space.inside]
        self._base = Baseline(chosen, self.rest.skin, regions)
        self._learn(waiting)

    def _learn(self, waiting: list[_Buffered]) -> None:
        """Learn melanin, the answer to blood, and the noise, before the first frame is solved."""
        assert self.rest is not None
        for time, look in zip(self._times, self._looks, strict=True):
            self._add_melanin(time, look)
        self._series.start(self._times[-1])
        tops = tuple(self._decomposer.encoder.output_info[name].range[1] for name in PIGMENTS)
        table = tabulate_colours(self._decomposer.decoder, self.rest.capture, (tops[0], tops[1]))
        regions = self._base.regions
        self._response = BloodResponse(table, self.rest, regions)
        self._direction = self._response.differentiate()
        at_rest = self.resting_melanin(), self.resting_blood()
        self._scale_sd = find_scale_sd(table, self.rest, regions, *at_rest)
        self._resting = self.space.fill(self.rest.hemoglobin)
        self._map = ChangeMap(table, self.rest, self._base, self.space)
        frames = [(one.time, self._base.compare(one.colours))
                  for one in waiting if one.colours is not None]  # fmt: skip
        self._noise = FrameNoise(self._base, self.space.inside, frames)

    def _read(
        self, number: int, time: float, colours: NDArray[np.float32] | None, bend: float
    ) -> Reading:
        if colours is None:
            return make_blank(number, time, self.number, LOST, len(NAMES))
        compared = self._base.compare(colours)
        ratios = compared.ratios
        read = np.asarray(np.isfinite(ratios).all(1))
        if not read[NAMES.index(FACE)]:
            return make_blank(number, time, self.number, HIDDEN, len(NAMES))
        self._noise.add(time, compared)
        shown = np.where(read[:, None], ratios, 0.0)
        # Red answers least to blood, so that its ratio tells how much light there is.
        doubt = self._doubt.find_covariance(self._base.levels, shown[:, 0])
        noise = self._noise.find_covariance(bend) + doubt
        gloss = _GLOSS_SD + _GLOSS_BY_BEND * bend**2 + _GLOSS_BY_SHADING * _spread_shading(ratios)
        found = self._response.solve(shown, noise, gloss)
        change = np.where(read, found.change, np.nan)
        sd = np.where(read, np.hypot(found.sd, self._scale_sd * found.change), np.nan)
        base, base_sd = self.resting_blood()
        return Reading(
            number,
            time,
            self.number,
            READ,
            change,
            sd,
            base * np.exp(change),
            np.hypot(base_sd, sd),
            np.where(read, np.exp(found.gain), np.nan),
            ratios,
            self._map(compared, float(found.gain[0])) if self._with_maps else None,
            self._direction,
            self._resting if self._with_maps else None,
            np.where(read, found.sd, np.nan),
        )

    def resting_blood(self) -> tuple[Array, Array]:
        """Mean hemoglobin of the regions at rest, and the sd of its logarithm, [regions]."""
        return self._average(1)

    def resting_melanin(self) -> tuple[Array, Array]:
        """The same of melanin, as the baseline's looks read it."""
        return self._average(0)

    def average_melanin(self, pooled: PooledMelanin) -> tuple[Array, Array]:
        """The same of melanin that is pooled over the whole shot."""
        return self._average(0, pooled.texels)

    def _average(
        self, pigment: int, texels: NDArray[np.float32] | None = None
    ) -> tuple[Array, Array]:
        assert self.rest is not None
        values = (self.rest.melanin, self.rest.hemoglobin)[pigment] if texels is None else texels
        share = self._decomposer.encoder.region_share[pigment]
        face, means, sds = self.rest.face_sd[pigment], [], []
        for mask in self._base.regions:
            some = bool(mask.any())
            means.append(float(values[mask].mean()) if some else np.nan)
            pixels = float((self.rest.pixel_sd[pigment][mask] ** 2).mean()) if some else 0.0
            sds.append(float(np.sqrt(face**2 + share * max(pixels - face**2, 0))))
        sds[0] = float(face)
        return np.array(means), np.array(sds)


def _spread_shading(ratios: Array) -> float:
    """Standard deviation over the regions [regions, 3] of their gain: exposure is common to all."""
    gains = ratios[1:, 0]
    known = gains[np.isfinite(gains)]
    return float(known.std()) if len(known) > 1 else 0.0
