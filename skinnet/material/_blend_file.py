"""A .blend file with the node group, made by Blender where there is one."""

import shutil
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

from skinnet.errors import InputError

_ARGUMENTS = ("--background", "--factory-startup", "--python-exit-code", "1", "--python")
_LONGEST = 600.0
"""Seconds; a first start of Blender reads several hundred megabytes."""


def find_blender(program: str | None) -> tuple[str, ...]:
    """Find what runs a script in Blender.

    Args:
        program: Blender, or a Python that has bpy; None: this Python if it has bpy, else `blender`
            on the PATH.

    Returns:
        The beginning of the command, before the script; empty if there is no Blender.

    Raises:
        InputError: `program` is not there.
    """
    if program is None:
        if find_spec("bpy") is not None:
            return (sys.executable,)
        path = shutil.which("blender")
        return () if path is None else (path, *_ARGUMENTS)
    path = shutil.which(program)
    if path is None:
        raise InputError(
            f"There is no program {program}; --blender is Blender, or a Python that has bpy."
        )
    return (path,) if Path(path).name.startswith("python") else (path, *_ARGUMENTS)


def write_blend(path: Path, command: tuple[str, ...], script: Path) -> None:
    """Run the script in Blender, and save what it makes.

    Args:
        path: The file to write.
        command: As of `find_blender`.
        script: The script of the shader, with its table beside it.

    Raises:
        InputError: Blender fails.
    """
    whole = [*command, str(script), "--", str(path)]
    try:
        done = subprocess.run(whole, capture_output=True, text=True, timeout=_LONGEST, check=False)
        said, code = (done.stderr or done.stdout).strip(), done.returncode
    except (OSError, subprocess.TimeoutExpired) as error:
        said, code = str(error), 1
    if code or not path.exists():
        last = said.splitlines()[-1] if said else f"exit code {code}"
        raise InputError(
            f"{command[0]} could not make the .blend file ({last}); the other files are complete. "
            f"Open {script} in Blender's Text Editor and run it there, or name another program "
            "with --blender."
        )
