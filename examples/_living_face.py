"""Rendered faces whose expression and blood change, in one light and with one exposure."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from examples._portraits import Sitter, compose_portrait
from skinnet.appearance import DynamicModel
from skinnet.errors import InputError
from skinnet.physics import SkinDecoder
from train.synthetic.scene import map_tensors
from train.synthetic.videos.blood_course import BloodCourse
from train.synthetic.videos.clip_renderer import ClipRenderer, ClipSettings
from train.synthetic.videos.head_motion import HeadMotion

MOVES: dict[str, dict[str, float]] = {
    "smile": {"mouthSmile_L": 0.8, "mouthSmile_R": 0.8, "cheekSquint_L": 0.5, "cheekSquint_R": 0.5},
    "frown": {"browDown_L": 0.9, "browDown_R": 0.9, "mouthFrown_L": 0.6, "mouthFrown_R": 0.6},
}
"""Weights of ICT-FaceKit's shapes in each expression."""

_BENDS = {"smile": (0.0, 0.9, 0.1), "frown": (0.0, -0.6, -0.7)}
"""Opening of the mouth, smile and lift of the brows of heads without such shapes."""

_STILL = BloodCourse(60, 0, 0, "none", 1, 1, 0, False)

Amounts = Mapping[str, float]


class _Expression(HeadMotion):
    """A head that keeps still, with an expression."""

    def __init__(self, bend: NDArray[np.float64]) -> None:
        super().__init__("still", np.zeros((6, 3, 3)), np.zeros((3, 3)), np.zeros((3, 3, 3)))
        object.__setattr__(self, "bend", bend)

    def expression(self, time: float) -> NDArray[np.float64]:
        """The same at all times."""
        bend: NDArray[np.float64] = self.__dict__["bend"]
        return bend


class _Bust(ClipRenderer):
    """A head with one expression, whose blood a dynamic model changes."""

    model: DynamicModel
    amounts: Amounts | None = None

    def _find_change(self, time: float) -> NDArray[np.float64]:
        rest = self._hemoglobin
        if self.amounts is None:
            return np.zeros(rest.shape)
        skin = self._skin[0, 0].numpy()
        changed = self.model.sample(rest, self.amounts, self.landmarks, skin=skin, most=1.0)
        return np.log(np.maximum(changed, 1e-6) / np.maximum(rest, 1e-6)).astype(np.float64)


class LivingFace:
    """A person whose expression and blood change.

    Args:
        sitter: The person.
        size: Side of the pictures in pixels.
        ict: ICT-FaceKit as an .npz, whose shapes make the expressions; None: a procedural head,
            whose picture is bent.
        model: How blood changes.

    Raises:
        InputError: No face is found in the picture.
    """

    def __init__(self, sitter: Sitter, size: int, ict: Path | None, model: DynamicModel) -> None:
        self.sitter, self.size, self.ict, self.model = sitter, size, ict, model
        self._busts: dict[tuple[tuple[str, float], ...], _Bust] = {}
        self._rest = self._make_bust({})
        self._busts[()] = self._rest

    def render(self, expression: Amounts, blood: Amounts) -> NDArray[np.uint8]:
        """Render a picture, uint8 sRGB [size, size, 3].

        Args:
            expression: How much of each of `MOVES`, from 0 to 1.
            blood: Amounts of the model's states and coefficients.
        """
        key = tuple((name, round(share, 2)) for name, share in expression.items() if share > 0.005)
        if key not in self._busts:
            self._busts[key] = self._make_bust(dict(key))
        bust = self._busts[key]
        bust.amounts = blood
        return bust.render(0.0)

    def _make_bust(self, expression: Amounts) -> _Bust:
        weights: dict[str, float] = {}
        bend = np.zeros(3)
        for name, share in expression.items():
            weights.update({shape: share * weight for shape, weight in MOVES[name].items()})
            bend += share * np.array(_BENDS[name])
        scene = compose_portrait(self.sitter, 2 * self.size, self.ict, weights)
        batch = map_tensors(lambda value: value[None], scene)
        motion = _Expression(bend if self.ict is None else np.zeros(3))
        settings = ClipSettings(size=self.size, noise=0.0, face=0.5)
        try:
            bust = _Bust(batch, SkinDecoder(), _STILL, motion, settings, 0)
        except ValueError as error:
            raise InputError(f"{error} Give a larger --size.") from error
        bust.model = self.model
        if hasattr(self, "_rest"):  # the frame and the exposure are those of the face at rest
            bust._zoom, bust._centre = self._rest._zoom, self._rest._centre
            bust._gain = self._rest._gain
        return bust
