"""A face that was found in a photograph."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from skinnet.images.box import Box


@dataclass(frozen=True, eq=False, repr=False)
class Face:
    """A face that was found in a photograph.

    Attributes:
        box: A square around the face, from the brows to the chin of an upright one; its sides are
            those of the picture also if the face is tilted, and it may exceed the photograph.
        tilt: Angle in degrees by which the head is turned clockwise in the picture, in (-180, 180].
        score: Probability that this is a face, in [0, 1].
        landmarks: Columns and rows of the 478 points of MediaPipe's face mesh, float32 [478, 2], in
            pixels from the photograph's upper left corner; the last ten are the irises.

    Example:
        >>> from skimage.data import astronaut
        >>> from skinnet.images import find_faces
        >>> find_faces(astronaut())[0].landmarks.shape
        (478, 2)
    """

    box: Box
    tilt: float
    score: float
    landmarks: NDArray[np.float32]

    def __repr__(self) -> str:
        return f"<Face {self.box}, tilt {self.tilt:.0f} degrees, score {self.score:.2f}>"
