"""What worker processes of the tests do with photographs, by their names."""

import os
import signal
import time
from pathlib import Path
from typing import NamedTuple

from skinnet.errors import InputError, NoFaceError
from skinnet.files._partial import write_aside
from skinnet.images._walk import Found
from skinnet.inference._messages import note, print_line
from skinnet.inference._workers.turns import wait_turn


class Job(NamedTuple):
    """A work that needs no network; `folder` is where it writes."""

    folder: Path

    def load(self) -> None:
        if self.folder.name == "broken":
            raise InputError("The model is damaged.")

    def __call__(self, picture: Found) -> str:
        name = Path(picture.path).stem
        note(f"{name} is looked at.")
        if name.startswith("slow"):
            time.sleep(0.3)
        if name.startswith("die"):
            os.kill(os.getpid(), signal.SIGKILL)
        if name.startswith("bad"):
            raise InputError(f"{name} is damaged.")
        if name.startswith("wall"):
            raise NoFaceError(f"No face in {name}.")
        if name.startswith("fault"):
            raise ZeroDivisionError(name)
        if name.startswith("wait"):
            self._wait()
        wait_turn()
        with (self.folder / "order.txt").open("a", encoding="utf-8") as file:
            file.write(f"{picture.path}\n")
        print_line(f"{name} is done.")
        return name

    def _wait(self) -> None:
        """Begin to write a file, and do not end."""
        with write_aside(self.folder) as temporary:
            temporary(".txt").write_text(str(os.getpid()), encoding="utf-8")
            time.sleep(60)
