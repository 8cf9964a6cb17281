"""Photographs without truth as training data, beside synthetic faces whose pigments are known."""

from abc import abstractmethod
from functools import partial
from typing import Any

from lightning import LightningDataModule
from lightning.pytorch.utilities import CombinedLoader
from torch.utils.data import DataLoader, Dataset

from skinnet.errors import InputError
from train.batch import Batch
from train.stream import StreamLoader, count_seen_samples
from train.synthetic.faces import SyntheticFaces
from train.synthetic.scene import SceneParameters


class BesideSynthetic(LightningDataModule):
    """Photographs of which every step sees a batch beside one of synthetic faces.

    Attributes:
        size: Side of the square crops in pixels.
        batch_size: Samples of photographs in a batch of each process.
        synthetic: Synthetic faces of the same size.
    """

    size: int
    batch_size: int
    synthetic: SyntheticFaces

    @abstractmethod
    def has_read(self) -> bool:
        """Whether the photographs were read."""

    @abstractmethod
    def read(self) -> None:
        """Read the photographs."""

    @abstractmethod
    def stream(self) -> Dataset[Any]:
        """Stream the photographs of training, endlessly; its length is that of an epoch."""

    @abstractmethod
    def keep(self) -> DataLoader[Any]:
        """Load the photographs kept for validation."""

    @abstractmethod
    def make_batch(self, photographs: Any) -> Batch:
        """Make a batch of samples of photographs."""

    def prepare_data(self) -> None:
        """Read the photographs, and cast the synthetic heads that are missing."""
        self._read_once()
        self.synthetic.trainer = self.trainer
        self.synthetic.prepare_data()

    def setup(self, stage: str) -> None:
        """Read the photographs, and the synthetic heads that a stage needs."""
        self._read_once()
        self.synthetic.trainer = self.trainer
        self.synthetic.setup(stage)

    def _read_once(self) -> None:
        if self.has_read():
            return
        # This is not checked in the constructor, whose errors the parser replaces with its own.
        if self.synthetic.size != self.size:
            raise InputError(
                f"Photographs are cut to {self.size} pixels and synthetic faces have "
                f"{self.synthetic.size}; give --data.init_args.size and "
                "--data.init_args.synthetic.size the same number."
            )
        self.read()

    def train_dataloader(self) -> CombinedLoader:
        """Make the endless loader of photographs and synthetic faces."""
        photographs = self.stream()
        steps = max(len(photographs) // self.batch_size, 1)  # type: ignore[arg-type]
        seen = partial(count_seen_samples, self.trainer, self.batch_size)
        loaders = {
            "portraits": StreamLoader(photographs, self.batch_size, steps * self.batch_size, seen),
            "synthetic": self.synthetic.stream(steps, self.trainer),
        }
        return CombinedLoader(loaders, "min_size")

    def val_dataloader(self) -> CombinedLoader:
        """Make the loader of the photographs kept for validation, beside synthetic faces."""
        return self._combine(self.synthetic.val_dataloader())

    def test_dataloader(self) -> CombinedLoader:
        """Make the loader of the photographs kept for validation, beside synthetic test faces."""
        return self._combine(self.synthetic.test_dataloader())

    def _combine(self, synthetic: DataLoader[SceneParameters]) -> CombinedLoader:
        """Validation photographs beside synthetic faces; the shorter set repeats."""
        return CombinedLoader({"portraits": self.keep(), "synthetic": synthetic}, "max_size_cycle")

    def on_after_batch_transfer(self, batch: Any, dataloader_idx: int) -> dict[str, Batch]:
        """Make a batch of the photographs, and render the synthetic faces."""
        synthetic = self.synthetic.on_after_batch_transfer(batch["synthetic"], dataloader_idx)
        return {"portraits": self.make_batch(batch["portraits"]), "synthetic": synthetic}
