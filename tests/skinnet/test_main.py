"""Ctrl-C while the command starts ends it without a word."""

import os
import signal
import subprocess
import sys

import pytest


@pytest.mark.skipif(os.name != "posix", reason="Signals are those of POSIX.")
def test_an_interrupt_while_the_command_is_imported_says_nothing() -> None:
    code = (
        "import os, signal, sys, threading\n"
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        "class Interrupt:\n"
        "    def find_spec(self, name, *_):\n"
        "        if name == 'skinnet.cli':\n"
        "            os.kill(os.getpid(), signal.SIGINT)\n"
        "sys.meta_path.insert(0, Interrupt())\n"
        "from skinnet.__main__ import run\n"
        "run()\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True)
    assert done.returncode == 130 and done.stderr == b""


@pytest.mark.skipif(os.name != "posix", reason="Signals are those of POSIX.")
def test_afterwards_an_interrupt_is_as_usual(monkeypatch: pytest.MonkeyPatch) -> None:
    from skinnet.__main__ import run

    monkeypatch.setattr(sys, "argv", ["skinnet", "--version"])
    usual = signal.signal(signal.SIGINT, signal.default_int_handler)  # a job may ignore it
    try:
        assert run() == 0
        assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    finally:
        signal.signal(signal.SIGINT, usual)
