"""A batch in one process: Ray and the networks are stood in for, all else is as it is."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager

import numpy as np
import pytest
from flat_decomposer import FlatDecomposer

from skinnet.batch.__main__ import main
from skinnet.batch._job import Job, Model, read_model
from skinnet.batch._worker import Worker

Run = Callable[..., tuple[int, str, str]]


@contextmanager
def connect(address: str | None) -> Iterator[int]:
    """Two cores."""
    yield 2


def read_blocks(job: Job, count: int, workers: int | None, cores: int) -> Iterator[tuple[int, str]]:
    """One worker, in this process."""
    worker = Worker(job)
    for number in range(count):
        done = worker({"block": np.array([number])})
        yield number, str(done["fault"][0])


@pytest.fixture(scope="session")
def model() -> Model:
    """The shipped model, which is opened once."""
    return read_model(None)


@pytest.fixture
def run(model: Model, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Run:
    """Runs the command: exit code, output and messages."""
    monkeypatch.setattr("skinnet.batch._run.import_ray", lambda: None)
    monkeypatch.setattr("skinnet.batch._run.read_model", lambda _: model)
    monkeypatch.setattr("skinnet.batch._run.connect", connect)
    monkeypatch.setattr("skinnet.batch._run.read_blocks", read_blocks)
    monkeypatch.setattr("skinnet.batch._worker.make_decomposer", lambda *_: FlatDecomposer())

    def run(*arguments: object) -> tuple[int, str, str]:
        capsys.readouterr()
        code = main([str(argument) for argument in arguments])
        return code, *capsys.readouterr()

    return run
