"""The process in which cases run, one for each process of pytest."""

from collections.abc import Iterator

import pytest

from benchmarks.fuzzing.runner import Runner


@pytest.fixture(scope="session")
def runner() -> Iterator[Runner]:
    with Runner() as runner:
        yield runner
