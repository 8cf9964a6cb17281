"""The worker: one process on one core, which reads blocks and writes parts."""

from collections.abc import Iterator, Mapping
from functools import cached_property
from typing import Any

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from skinnet.batch._attempts import REASON, Attempts
from skinnet.batch._blocks import read_block
from skinnet.batch._contents import load
from skinnet.batch._job import Job, make_decomposer
from skinnet.batch._output import Output, name_part
from skinnet.batch._photographs import Photograph
from skinnet.batch._places import find_place
from skinnet.batch._rows import Row, make_failure, make_schema, read_rows
from skinnet.errors import InputError
from skinnet.inference.decomposer import Decomposer


class Worker:
    """Reads blocks of photographs; Ray Data keeps one on each core.

    Args:
        job: What is to be done.
    """

    def __init__(self, job: Job) -> None:
        self.job = job
        self.output = Output(find_place(job.output), job.token)
        self.schema = make_schema(job.model.lights, job.reading.maps)

    def __call__(self, batch: Mapping[str, NDArray[Any]]) -> dict[str, NDArray[Any]]:
        """Read blocks.

        Args:
            batch: `block`, numbers of blocks of the plan.

        Returns:
            `block`, and `fault`: why a block could not be written, or an empty word.
        """
        faults = [self._read(int(number)) for number in batch["block"]]
        return {"block": batch["block"], "fault": np.array(faults, object)}

    def _read(self, number: int) -> str:
        try:
            self.output.check_run()
            self._read_block(read_block(self.output.plan, number))
        except (InputError, OSError) as error:
            return str(error)
        return ""

    def _read_block(self, photographs: list[Photograph]) -> None:
        part = name_part(each.key for each in photographs)
        if self.output.has(part):  # a worker wrote it, and died before it could say so
            return
        attempts = Attempts(self.output.name_attempt(part))
        self.output.write(part, self._make_tables(photographs, attempts))
        attempts.end()

    def _make_tables(self, photographs: list[Photograph], attempts: Attempts) -> Iterator[pa.Table]:
        """The rows of a block; with maps a table for each photograph, which bounds the memory."""
        rows: list[Row] = []
        for found in self._list_rows(photographs, attempts):
            rows += found
            if self.job.reading.maps:
                yield pa.Table.from_pylist(rows, self.schema)
                rows = []
        if rows:
            yield pa.Table.from_pylist(rows, self.schema)

    def _list_rows(self, photographs: list[Photograph], attempts: Attempts) -> Iterator[list[Row]]:
        """The rows of each photograph."""
        deadly = {number for number in range(len(photographs)) if attempts.is_deadly(number)}
        numbers = [number for number in range(len(photographs)) if number not in deadly]
        contents = load([photographs[number] for number in numbers], self.job)
        for number in numbers:
            attempts.begin(number)
            content = next(contents)
            yield read_rows(self.decomposer, content, self.job.reading, self.job.model)
        for number in deadly:
            yield [make_failure(photographs[number], self.job.model, REASON)]

    @cached_property
    def decomposer(self) -> Decomposer:
        """The networks, on one thread."""
        return make_decomposer(self.job)
