"""Data in an order that depends on how much was seen, so that resumed runs continue exactly."""

from collections.abc import Callable, Iterator
from typing import Any

from lightning import Trainer
from torch import distributed
from torch.utils.data import DataLoader, Dataset, default_collate
from torch.utils.data.distributed import DistributedSampler

from skinnet.errors import InputError


class StreamSampler(DistributedSampler[int]):
    """Indices of an endless stream: from the first not yet seen to the end of its epoch.

    Lightning would start the data of an epoch again after a resume; this sampler continues it.
    Processes that train together take turns, so that each step sees the samples that one process
    would see in it. Lightning does not replace a `DistributedSampler`.

    Args:
        epoch: Samples of an epoch over all processes, a multiple of their number.
        seen: Returns how many samples this process has seen over all epochs. It is called whenever
            an epoch starts.
        replicas: Number of processes that train together.
        rank: Number of this process.
    """

    def __init__(
        self, epoch: int, seen: Callable[[], int], replicas: int = 1, rank: int = 0
    ) -> None:
        super().__init__(range(epoch), replicas, rank, shuffle=False)  # type: ignore[arg-type]
        self.seen = seen

    def __iter__(self) -> Iterator[int]:
        start = self.seen() * self.num_replicas
        end = (start // self.total_size + 1) * self.total_size
        return iter(range(start + self.rank, end, self.num_replicas))


class StreamLoader(DataLoader[Any]):
    """A loader over a `StreamSampler`.

    Lightning resumes only loaders that have a state, so this one has an empty state.

    Args:
        dataset: The samples by index.
        batch_size: Samples of a step in every process.
        samples: Samples of an epoch, rounded down to whole steps.
        seen: As in `StreamSampler`.
        workers: Processes that load samples.
        collate: Makes a batch of a list of samples.
    """

    def __init__(
        self,
        dataset: Dataset[Any],
        batch_size: int,
        samples: int,
        seen: Callable[[], int],
        workers: int = 0,
        collate: Callable[[list[Any]], Any] = default_collate,
    ) -> None:
        replicas, rank = _get_processes()
        step = batch_size * replicas
        sampler = StreamSampler(max(samples // step, 1) * step, seen, replicas, rank)
        super().__init__(
            dataset, batch_size, sampler=sampler, num_workers=workers, collate_fn=collate
        )

    def state_dict(self) -> dict[str, Any]:
        """Return an empty state."""
        return {}

    def load_state_dict(self, state: dict[str, Any]) -> None:
        """Ignore the state; the sampler counts the samples itself."""


def count_seen_samples(trainer: Trainer | None, batch_size: int) -> int:
    """Count the samples that this process has trained on, over all epochs and interruptions.

    Raises:
        InputError: If gradients are accumulated. The last step of an epoch may then have fewer
            batches, so that the samples do not follow from the steps.
    """
    if trainer is None:
        return 0
    if trainer.accumulate_grad_batches != 1:
        raise InputError(
            f"--trainer.accumulate_grad_batches is {trainer.accumulate_grad_batches}; leave it at "
            "1 and give a larger batch_size, or more processes."
        )
    return int(trainer.global_step * batch_size)


def _get_processes() -> tuple[int, int]:
    """The number of processes that train together, and the number of this one."""
    if not (distributed.is_available() and distributed.is_initialized()):
        return 1, 0
    return distributed.get_world_size(), distributed.get_rank()
