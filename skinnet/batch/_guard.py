"""Ends what Ray has started on this machine if the command is killed."""

import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from secrets import token_hex

_NAME = "SKINNET_BATCH_SESSION"

_WATCH = """
import os, signal, sys, time
sys.stdin.buffer.read()
for wait in (0, 1, 2):
    time.sleep(wait)
    for process in filter(str.isdecimal, os.listdir("/proc")):
        try:
            with open(f"/proc/{process}/environ", "rb") as file:
                ours = sys.argv[1].encode() in file.read().split(b"\\0")
            if ours:
                os.kill(int(process), signal.SIGKILL)
        except OSError:
            continue
"""
"""A program that waits for the end of its input, and then ends the processes of a session."""


@contextmanager
def end_together() -> Iterator[None]:
    """Have all processes that are started in the block end with this one, on Linux.

    Ray's servers end with the process that started them, but its two agents do not: they are
    children of a server. All inherit a variable of the environment, by which they are known.
    """
    if not sys.platform.startswith("linux"):
        yield
        return
    token = token_hex(16)
    command = [sys.executable, "-S", "-c", _WATCH, f"{_NAME}={token}"]
    watch = subprocess.Popen(command, stdin=subprocess.PIPE, start_new_session=True)
    os.environ[_NAME] = token
    try:
        yield
    finally:
        del os.environ[_NAME]
        watch.kill()
        watch.communicate()
