"""What is already on disk, and what is said while work goes on."""

import hashlib
import json
import sys
from collections.abc import Mapping
from dataclasses import asdict, is_dataclass
from pathlib import Path
from typing import Any

from skinnet.files import write_text


def log(text: str) -> None:
    """A line of progress, on standard error, so that standard output holds results alone."""
    print(text, file=sys.stderr, flush=True)


def digest(*parts: object) -> str:
    """A short fingerprint of files' contents, settings and numbers, for `finished`."""
    sum_ = hashlib.sha256()
    for part in parts:
        if isinstance(part, Path):
            for file in sorted(part.rglob("*")) if part.is_dir() else [part]:
                sum_.update(file.read_bytes() if file.is_file() else b"")
        else:
            plain = asdict(part) if is_dataclass(part) and not isinstance(part, type) else part
            sum_.update(json.dumps(plain, sort_keys=True, default=str).encode())
        sum_.update(b"\0")
    return sum_.hexdigest()[:16]


def finished(record: Path, fingerprint: str, files: list[Path]) -> dict[str, Any] | None:
    """The record of a stage finished from the same inputs, if its files are all there."""
    if not all(file.is_file() for file in [record, *files]):
        return None
    try:
        found = json.loads(record.read_text(encoding="utf-8"))
    except ValueError:
        return None
    return found if isinstance(found, dict) and found.get("inputs") == fingerprint else None


def write_record(path: Path, fingerprint: str, values: Mapping[str, Any]) -> dict[str, Any]:
    """Write what a stage found, last of its files, with the fingerprint of its inputs."""
    record = {"inputs": fingerprint, **values}
    write_text(path, json.dumps(record, indent=2, allow_nan=False) + "\n")
    return record
