"""A bar on a terminal; what is printed meanwhile stands above it."""

import io
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
