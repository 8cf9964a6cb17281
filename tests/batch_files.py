"""Inputs of batches, and what batches write."""

from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq


def read_rows(folder: Path) -> list[dict[str, Any]]:
    """All rows of an output, as a reader of Parquet sees them, by photograph."""
    rows = pq.read_table(folder).to_pylist()
    return sorted(rows, key=lambda row: (row["file"], row["id"] or 0))


def list_parts(folder: Path) -> dict[str, int]:
    """Names of the parts, and when each was written."""
    return {path.name: path.stat().st_mtime_ns for path in folder.glob("*.parquet")}


def write_parquet(path: Path, **columns: Any) -> Path:
    """Write a small Parquet file with two rows a group."""
    pq.write_table(pa.table(columns), path, row_group_size=2)
    return path
