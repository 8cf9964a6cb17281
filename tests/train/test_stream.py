"""Data go on from where training stopped."""

from itertools import islice

import pytest
from lightning import Trainer

from skinnet.errors import InputError
from train.stream import StreamLoader, StreamSampler, count_seen_samples


def test_an_epoch_starts_at_what_was_seen_and_ends_where_it_would_have_ended() -> None:
    assert list(StreamSampler(10, lambda: 0)) == list(range(10))
    assert list(StreamSampler(10, lambda: 14)) == list(range(14, 20))
    assert list(StreamSampler(10, lambda: 20)) == list(range(20, 30))


def test_processes_share_each_step_of_one_process() -> None:
    shares = [list(StreamSampler(12, lambda: 2, replicas=2, rank=rank)) for rank in range(2)]
    assert shares == [[4, 6, 8, 10], [5, 7, 9, 11]]
    assert len(StreamSampler(12, lambda: 0, replicas=2)) == 6


def test_a_loader_has_whole_batches_only() -> None:
    loader = StreamLoader(list(range(100)), 4, 10, lambda: 0)  # type: ignore[arg-type]
    assert [batch.tolist() for batch in islice(loader, 5)] == [[0, 1, 2, 3], [4, 5, 6, 7]]
    assert len(loader) == 2


def test_accumulated_gradients_are_refused() -> None:
    quiet = {"logger": False, "enable_checkpointing": False, "enable_progress_bar": False}
    assert count_seen_samples(Trainer(accelerator="cpu", **quiet), 8) == 0
    trainer = Trainer(accelerator="cpu", accumulate_grad_batches=3, **quiet)
    with pytest.raises(InputError, match="accumulate_grad_batches is 3"):
        count_seen_samples(trainer, 8)
