"""Commands keep their promises when the caller has closed a stream, or interrupts them early."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from skinnet.cli import main

posix = pytest.mark.skipif(os.name != "posix", reason="File numbers are those of POSIX.")


def run_closed(closed: list[int], *arguments: str) -> "subprocess.CompletedProcess[bytes]":
    """Run the command with some of its standard streams closed."""
    closing = "; ".join(f"os.close({number})" for number in closed)
    code = (
        f"import os, sys; {closing}; "
        f"os.execv(sys.executable, [sys.executable, '-m', 'skinnet', *{list(arguments)!r}])"
    )
    return subprocess.run([sys.executable, "-c", code], stdin=subprocess.DEVNULL, timeout=120)


@posix
@pytest.mark.parametrize("closed", [[0], [1], [2], [1, 2], [0, 1, 2]])
def test_closed_streams(tmp_path: Path, closed: list[int]) -> None:
    assert run_closed(closed, "predict", str(tmp_path / "absent.png")).returncode == 2


@posix
@pytest.mark.slow
def test_a_photograph_is_read_without_streams(tmp_path: Path, astronaut: np.ndarray) -> None:
    Image.fromarray(astronaut).save(tmp_path / "a.png")
    assert run_closed([0, 1, 2], "predict", str(tmp_path / "a.png")).returncode == 0
    assert (tmp_path / "skinmaps" / "a.json").is_file()


@posix
def test_an_interrupt_while_libraries_are_imported_says_nothing() -> None:
    code = (
        "import os, signal\n"
        "from skinnet.inference._messages import quit_at_interrupt\n"
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        "with quit_at_interrupt():\n"
        "    os.kill(os.getpid(), signal.SIGINT)\n"
        "    raise ImportError('as NumPy raises')\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True)
    assert done.returncode == 130 and done.stderr == b""


@posix
def test_after_the_imports_an_interrupt_is_as_usual() -> None:
    from skinnet.inference._messages import quit_at_interrupt

    usual = signal.signal(signal.SIGINT, signal.default_int_handler)  # a job may ignore it
    try:
        with quit_at_interrupt():
            pass
        assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    finally:
        signal.signal(signal.SIGINT, usual)


@posix
def test_an_endless_standard_input_is_refused() -> None:
    arguments = [sys.executable, "-m", "skinnet", "predict", "-"]
    with open("/dev/zero", "rb") as endless:
        done = subprocess.run(arguments, stdin=endless, capture_output=True, timeout=120)
    assert done.returncode == 2 and b"standard input is larger than the limit" in done.stderr


@pytest.mark.parametrize("verb", ["predict", "edit", "maps", "compare"])
def test_names_do_not_control_the_terminal(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], verb: str
) -> None:
    name = tmp_path / "a\x1b[31m\u202egnp\n.obj"
    name.write_bytes(b"none")
    more = {"compare": [str(name)], "edit": ["--melanin", "2"]}
    assert main([verb, str(name), *more.get(verb, [])]) == 2
    said = capsys.readouterr().err
    assert r"a\x1b[31m\u202egnp\n.obj" in said and "\x1b" not in said and "\u202e" not in said
