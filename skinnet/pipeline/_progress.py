"""Records of finished steps, which are not repeated."""

import hashlib
import json
from collections.abc import Mapping
from dataclasses import asdict, is_dataclass
from pathlib import Path
from typing import Any

from skinnet.files import write_text
from skinnet.files._reading import read_file


def compute_fingerprint(*parts: object) -> str:
    """Compute a short hash of the contents of files, settings and numbers."""
    digest = hashlib.sha256()
    for part in parts:
        if isinstance(part, Path):
            for file in sorted(part.rglob("*")) if part.is_dir() else [part]:
                digest.update(file.read_bytes() if file.is_file() else b"")
        else:
            plain = asdict(part) if is_dataclass(part) and not isinstance(part, type) else part
            digest.update(json.dumps(plain, sort_keys=True, default=str).encode())
        digest.update(b"\0")
    return digest.hexdigest()[:16]


def read_finished(record: Path, fingerprint: str, files: list[Path]) -> dict[str, Any] | None:
    """Read the record of a step; None if its inputs have changed or a file is missing."""
    if not all(file.is_file() for file in [record, *files]):
        return None
    try:
        found = json.loads(read_file(record))
    except ValueError:
        return None
    return found if isinstance(found, dict) and found.get("inputs") == fingerprint else None


def write_record(path: Path, fingerprint: str, values: Mapping[str, Any]) -> dict[str, Any]:
    """Write the record of a step, after its files, with the fingerprint of its inputs."""
    record = {"inputs": fingerprint, **values}
    write_text(path, json.dumps(record, indent=2, allow_nan=False) + "\n")
    return record
