"""Data in an order that depends on how much was seen, so that resuming goes on exactly."""

from collections.abc import Callable, Iterator
from typing import Any

from torch.utils.data import DataLoader, Dataset, Sampler


class StreamSampler(Sampler[int]):
    """Places in an endless stream: from the first not yet seen to the end of its epoch.

    `seen` says how many samples training has seen over all epochs. It is asked whenever an epoch
    starts, after a resume too, where Lightning itself would start the epoch's data again.
    """

    def __init__(self, epoch: int, seen: Callable[[], int]):
        self.epoch = epoch
        self.seen = seen

    def __iter__(self) -> Iterator[int]:
        start = self.seen()
        return iter(range(start, (start // self.epoch + 1) * self.epoch))

    def __len__(self) -> int:
        return self.epoch


class StreamLoader(DataLoader[Any]):
    """A loader over a `StreamSampler`.

    It has a state, an empty one, which is how Lightning is told that it can be resumed.
    """

    def __init__(
        self,
        dataset: Dataset[Any],
        batch_size: int,
        samples: int,
        seen: Callable[[], int],
        workers: int = 0,
    ):
        epoch = max(samples // batch_size, 1) * batch_size
        sampler = StreamSampler(epoch, seen)
        super().__init__(dataset, batch_size, sampler=sampler, num_workers=workers)

    def state_dict(self) -> dict[str, Any]:
        return {}

    def load_state_dict(self, state: dict[str, Any]) -> None:
        pass
