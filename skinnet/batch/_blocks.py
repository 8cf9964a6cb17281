"""Blocks of photographs: what one worker reads at once, and one part of the output holds."""

import math
from collections.abc import Iterator, Sequence

import pyarrow as pa
import pyarrow.parquet as pq

from skinnet.batch._parquet_input import open_parquet
from skinnet.batch._photographs import Photograph
from skinnet.batch._places import Place, explain

LARGEST, LARGEST_WITH_MAPS = 256, 16
"""Photographs of a block: a minute of work, and a file of a size that readers like."""

_BLOCKS_OF_A_CORE = 8
"""So many that all cores end at about the same time."""

_FIELDS = ("file", "source", "row", "size", "modified", "fault")
_SCHEMA = pa.schema(
    [
        pa.field(name, pa.int64() if name in ("row", "size", "modified") else pa.string())
        for name in _FIELDS
    ]
)


def choose_size(count: int, cores: int, maps: bool) -> int:
    """Choose the number of photographs of a block."""
    fair = math.ceil(count / (cores * _BLOCKS_OF_A_CORE))
    return max(1, min(fair, LARGEST_WITH_MAPS if maps else LARGEST))


def write_plan(place: Place, photographs: Sequence[Photograph], size: int) -> list[int]:
    """Write the blocks of a run, each a group of rows of one Parquet file.

    Returns:
        The number of photographs of each block.
    """
    starts = range(0, len(photographs), size)
    with explain(place.url), place.filesystem.open_output_stream(place.path) as stream:
        with pq.ParquetWriter(stream, _SCHEMA, compression="zstd") as writer:
            for start in starts:
                writer.write_table(_make_table(photographs[start : start + size]))
    return [min(size, len(photographs) - start) for start in starts]


def read_block(place: Place, number: int) -> list[Photograph]:
    """Read one block of a plan."""
    with open_parquet(place) as file:
        columns = file.read_row_group(number).to_pydict()
    return list(_make_photographs(columns))


def _make_table(photographs: Sequence[Photograph]) -> pa.Table:
    columns = dict(zip(_FIELDS, zip(*photographs, strict=True), strict=True))
    return pa.table({name: pa.array(columns[name], _SCHEMA.field(name).type) for name in _FIELDS})


def _make_photographs(columns: dict[str, list]) -> Iterator[Photograph]:  # type: ignore[type-arg]
    for values in zip(*(columns[name] for name in _FIELDS), strict=True):
        yield Photograph(*values)
