"""The default data, which needs no file: the twin's procedural heads alone."""

from typing import Any

from jsonargparse.typing import PositiveInt

from train.twin.faces import TwinFaces


class SyntheticFaces(TwinFaces):
    """Procedural faces with varied skin, light, camera and exposure, with all ground truth.

    Args:
        size: side of the square pictures in pixels.
        heads: heads of the training set, cast once.
        val_heads: heads of the validation set.
        test_heads: heads of the test set.
        test_samples: pictures of the test set.
        kwargs: the rest of what `TwinFaces` takes, but for `ict` and `skins`.
    """

    def __init__(
        self,
        size: PositiveInt = 128,
        heads: PositiveInt = 96,
        val_heads: PositiveInt = 32,
        test_heads: PositiveInt = 32,
        test_samples: PositiveInt = 256,
        **kwargs: Any,
    ):
        super().__init__(
            size=size,
            heads=heads,
            val_heads=val_heads,
            test_heads=test_heads,
            test_samples=test_samples,
            ict=None,
            skins=None,
            **kwargs,
        )
