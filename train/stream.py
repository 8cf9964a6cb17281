"""Data in an order that depends on how much was seen, so that resuming goes on exactly."""

from collections.abc import Callable, Iterator
from typing import Any

from lightning import Trainer
from torch import distributed
from torch.utils.data import DataLoader, Dataset
from torch.utils.data.distributed import DistributedSampler

from skinnet.errors import InputError


class StreamSampler(DistributedSampler[int]):
    """Places in an endless stream: from the first not yet seen to the end of its epoch.

    `seen` says how many samples this process has seen over all epochs. It is asked whenever an
    epoch starts, after a resume too, where Lightning itself would start the epoch's data again.
    Processes that train together take turns, so that each step sees the samples that one process
    would see in it; Lightning leaves a `DistributedSampler` as it is.

    Args:
        epoch: samples of an epoch over all processes, a multiple of their number.
        seen: see above.
        replicas: processes that train together.
        rank: which of them this is.
    """

    def __init__(self, epoch: int, seen: Callable[[], int], replicas: int = 1, rank: int = 0):
        super().__init__(range(epoch), replicas, rank, shuffle=False)  # type: ignore[arg-type]
        self.seen = seen

    def __iter__(self) -> Iterator[int]:
        start = self.seen() * self.num_replicas
        end = (start // self.total_size + 1) * self.total_size
        return iter(range(start + self.rank, end, self.num_replicas))


class StreamLoader(DataLoader[Any]):
    """A loader over a `StreamSampler`, `batch_size` samples a step in every process.

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
        replicas, rank = processes()
        step = batch_size * replicas
        sampler = StreamSampler(max(samples // step, 1) * step, seen, replicas, rank)
        super().__init__(dataset, batch_size, sampler=sampler, num_workers=workers)

    def state_dict(self) -> dict[str, Any]:
        return {}

    def load_state_dict(self, state: dict[str, Any]) -> None:
        pass


def seen_samples(trainer: Trainer | None, batch_size: int) -> int:
    """Samples that this process has trained on, over all epochs and interruptions.

    Raises `InputError` where gradients are accumulated: an epoch's last step may then be of fewer
    batches, and what was seen does not follow from the steps.
    """
    if trainer is None:
        return 0
    if trainer.accumulate_grad_batches != 1:
        raise InputError(
            f"--trainer.accumulate_grad_batches is {trainer.accumulate_grad_batches}; leave it at "
            "1 and give a larger batch_size, or more processes."
        )
    return int(trainer.global_step * batch_size)


def processes() -> tuple[int, int]:
    """How many processes train together, and which of them this is."""
    if not (distributed.is_available() and distributed.is_initialized()):
        return 1, 0
    return distributed.get_world_size(), distributed.get_rank()
