"""The default data, which needs no file: the twin's procedural heads alone."""

from jsonargparse.typing import NonNegativeInt, PositiveInt

from train.twin.faces import TwinFaces


class SyntheticFaces(TwinFaces):
    """Procedural faces with varied skin, light, camera and exposure, with all ground truth.

    Args:
        size: side of the square pictures in pixels.
        batch_size: pictures in a batch of each process.
        train_samples: pictures that are called an epoch.
        val_samples: pictures of the validation set.
        test_samples: pictures of the test set.
        heads: heads of the training set, cast once.
        val_heads: heads of the validation set.
        test_heads: heads of the test set.
        geometry: folder in which the heads are kept.
        seed: of everything that is drawn.
        workers: processes that draw pictures; 0 draws them in the training process.
    """

    def __init__(
        self,
        size: PositiveInt = 128,
        batch_size: PositiveInt = 32,
        train_samples: PositiveInt = 6400,
        val_samples: PositiveInt = 128,
        test_samples: PositiveInt = 256,
        heads: PositiveInt = 96,
        val_heads: PositiveInt = 32,
        test_heads: PositiveInt = 32,
        geometry: str = "runs/geometry",
        seed: NonNegativeInt = 0,
        workers: NonNegativeInt = 0,
    ):
        super().__init__(
            size,
            batch_size,
            heads,
            val_heads,
            test_heads,
            train_samples,
            val_samples,
            test_samples,
            geometry=geometry,
            seed=seed,
            workers=workers,
        )
