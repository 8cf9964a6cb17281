"""Curves have whole lines only, whatever a disk does."""

import errno
import io
import threading
from pathlib import Path

import pytest

from train.logs import CurveLogger, hush_writers

HEAD = "step,metric,value\n"


def test_a_part_of_a_line_is_removed_when_a_run_goes_on(tmp_path: Path) -> None:
    (tmp_path / "metrics.csv").write_text(HEAD + "1,a,2\n2,a,")
    logger = CurveLogger(str(tmp_path))
    logger.start()
    logger.log_metrics({"a": 3.0}, 2)
    assert (tmp_path / "metrics.csv").read_text() == HEAD + "1,a,2\n2,a,3\n"


def test_a_full_disk_leaves_whole_lines(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    logger = CurveLogger(str(tmp_path))
    logger.start()

    class Full(io.FileIO):
        """A file on a disk with room for three bytes."""

        def write(self, data: object) -> int:
            if len(data) > 3:  # type: ignore[arg-type]
                return super().write(bytes(data)[:3])  # type: ignore[call-overload]
            raise OSError(errno.ENOSPC, "No space left on device")

    with monkeypatch.context() as patch:
        patch.setattr(Path, "open", lambda self, *_: Full(self, "a+"))
        with pytest.raises(OSError, match=r"No space left on device: '[^']*metrics\.csv'"):
            logger.log_metrics({"a": 3.0}, 1)
    assert (tmp_path / "metrics.csv").read_bytes() == HEAD.encode()


def test_threads_do_not_print_errors_of_a_disk(capfd: pytest.CaptureFixture[str]) -> None:
    def fail() -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    with hush_writers():
        thread = threading.Thread(target=fail)
        thread.start()
        thread.join()
    assert capfd.readouterr().err == ""
