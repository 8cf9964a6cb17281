"""A bar on a terminal; what is printed meanwhile stands above it."""

import io
import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager, redirect_stderr, redirect_stdout

import pytest

from skinnet.inference import _progress
from skinnet.inference._messages import note, print_line
from skinnet.inference._progress import show_progress


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


@contextmanager
def open_terminal() -> Iterator[Terminal]:
    """Both streams on one terminal."""
    terminal = Terminal()
    with redirect_stdout(terminal), redirect_stderr(terminal):
        yield terminal


def test_a_bar_has_count_rate_time_and_failures() -> None:
    with open_terminal() as terminal, show_progress(3) as advance:
        advance(0)
        advance(1)
        note("b.jpg is damaged.")
        advance(1)
    text = terminal.getvalue()
    assert "2 of 3 |" in text and " photographs/s, " in text and " left, 1 failed" in text
    assert "\rskinnet: b.jpg is damaged.\n" in text
    assert text.endswith("\r")  # the bar is gone at the end


def test_lines_are_written_whole_above_the_bar() -> None:
    with open_terminal() as terminal:
        with show_progress(2):
            print("<a", end="")
            before = terminal.getvalue()
            print_line("b")
            assert sys.stdout.encoding == terminal.encoding
        assert sys.stdout is terminal
    assert "<a" not in before and "\r<ab\n" in terminal.getvalue()


@pytest.mark.parametrize(("total", "quiet"), [(1, False), (5, True)])
def test_one_file_or_a_quiet_run_has_no_bar(total: int, quiet: bool) -> None:
    with open_terminal() as terminal, show_progress(total, quiet) as advance:
        advance(0)
    assert terminal.getvalue() == ""


def test_off_a_terminal_a_line_is_printed_now_and_then(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    now = iter([0.0, 30.0, 70.0, 100.0, 140.0, 200.0])
    monkeypatch.setattr(_progress.time, "monotonic", lambda: next(now))
    with show_progress(5) as advance:
        for failed in (0, 1, 1, 1, 1):
            advance(failed)
    assert capsys.readouterr().err == (
        "skinnet: 2 of 5 done, 1 failed, 0.029 per second, about 2 min left.\n"
        "skinnet: 4 of 5 done, 1 failed, 0.029 per second, about 1 min left.\n"
    )


@pytest.mark.skipif(os.name != "posix", reason="Windows has no pseudo-terminals of this kind")
def test_a_terminal_that_does_not_know_its_size_has_a_bar() -> None:
    main, terminal = os.openpty()  # 0 x 0, as in some containers
    code = (
        "from skinnet.inference._progress import show_progress\n"
        "with show_progress(2) as advance:\n"
        "    advance(1)\n"
    )
    done = subprocess.run([sys.executable, "-c", code], stdout=terminal, stderr=terminal)
    os.close(terminal)
    text = os.read(main, 4096).decode()
    os.close(main)
    assert done.returncode == 0 and "0 of 2 |" in text
