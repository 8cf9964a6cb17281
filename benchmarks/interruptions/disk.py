"""A folder to write into: a small file system of its own, where one can be mounted."""

import os
import shutil
import subprocess
from pathlib import Path

_LARGE = 1 << 30


class Disk:
    """A folder whose free space can be set.

    Args:
        folder: The folder, which exists and is empty.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.mounted = _call("mount", "-t", "tmpfs", "-o", f"size={_LARGE}", "none", str(folder))

    def close(self) -> None:
        """Give the file system back."""
        if self.mounted:
            _call("umount", "--lazy", str(self.folder))

    def limit(self, free: int | None = None) -> None:
        """Leave so many bytes free; None for many."""
        if not self.mounted:
            return
        page = os.sysconf("SC_PAGE_SIZE")
        size = _LARGE if free is None else self.used() + max(free // page, 1) * page
        if not _call("mount", "-o", f"remount,size={size}", str(self.folder)):
            raise OSError(f"{self.folder} cannot be given {size} bytes")

    def used(self) -> int:
        """The bytes that are used."""
        if not self.mounted:
            return sum(file.stat().st_size for file in self.folder.rglob("*") if file.is_file())
        state = os.statvfs(self.folder)
        return (state.f_blocks - state.f_bfree) * state.f_frsize

    def restore(self, content: Path) -> None:
        """Replace what is in the folder by a copy of another folder."""
        self.limit()
        for entry in self.folder.iterdir():
            shutil.rmtree(entry) if entry.is_dir() else entry.unlink()
        shutil.copytree(content, self.folder, dirs_exist_ok=True)


def _call(*command: str) -> bool:
    try:
        return subprocess.run(command, capture_output=True).returncode == 0
    except OSError:
        return False
