"""The process that runs cases: `python -m benchmarks.fuzzing.worker`, which `Runner` starts."""

import io
import json
import os
import re
import sys
import tempfile
import time
import traceback
import warnings
from contextlib import suppress
from pathlib import Path
from typing import Any, TextIO

from benchmarks.fuzzing.case import Case, make_case
from benchmarks.resources import read_resident_kb
from skinnet.errors import InputError

LONGEST_SENTENCE = 2000
"""Characters of a message that a person may still read."""

_CONTROL = re.compile("[\0-\x08\x0b-\x1f\x7f]")


def serve(requests: TextIO, answers: TextIO) -> None:
    """Run the cases that are asked for, one a line, and answer with an outcome for each.

    Args:
        requests: Lines of JSON, each the class and the seed of a case.
        answers: Outcomes are written here as lines of JSON.
    """
    for line in requests:
        kind, seed = json.loads(line)
        try:
            outcome = run_case(make_case(kind, seed))
        except Exception:  # of the fuzzer itself; the next case may be sound
            message = f"the case cannot be made:\n{traceback.format_exc()}"
            outcome = {"end": "fault", "message": message, "seconds": 0.0, "peak_gb": 0.0}
        print(json.dumps(outcome), file=answers, flush=True)


def run_case(case: Case) -> dict[str, Any]:
    """Run a case in this process.

    Returns:
        `end`, which is "result", "sentence" or "fault"; `message`; `seconds` of processor time; and
        `peak_gb` of this process.
    """
    home = os.getcwd()
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        for name, content in case.files.items():
            Path(folder, name).parent.mkdir(parents=True, exist_ok=True)
            Path(folder, name).write_bytes(content)
        os.chdir(folder)
        _reset_peak()
        started = time.process_time()
        end, message = _run(case, Path(folder))
        seconds = time.process_time() - started
        os.chdir(home)
    peak = read_resident_kb("VmHWM") / 1e6
    message = message.replace(folder, "")
    return {"end": end, "message": message, "seconds": seconds, "peak_gb": peak}


def _run(case: Case, folder: Path) -> tuple[str, str]:
    with warnings.catch_warnings(record=True) as noticed:
        warnings.resetwarnings()
        warnings.simplefilter("ignore", DeprecationWarning)
        warnings.simplefilter("ignore", PendingDeprecationWarning)
        warnings.simplefilter("ignore", ImportWarning)
        warnings.simplefilter("ignore", ResourceWarning)
        with _Printed() as printed:
            end, message = _run_quietly(case, folder)
    if end != "fault" and noticed:
        one = noticed[0]
        return "fault", f"a warning: {one.category.__name__}: {one.message} ({one.filename})"
    if end != "fault" and printed.text:
        return "fault", f"printed by a library: {printed.text[:500]}"
    return end, message


def _run_quietly(case: Case, folder: Path) -> tuple[str, str]:
    try:
        case.run(folder)
    except InputError as error:
        return _check_sentence(str(error))
    except KeyboardInterrupt:
        raise
    except BaseException:
        return "fault", f"{case.what}\n{traceback.format_exc()}"[-6000:]
    return "result", ""


def _check_sentence(message: str) -> tuple[str, str]:
    if len(message) > LONGEST_SENTENCE:
        return "fault", f"a message of {len(message)} characters: {message[:500]}"
    if message.count("\n") > 3 or "Traceback" in message:
        return "fault", f"a message of several lines: {message}"
    return "sentence", message


class _Printed:
    """What is written to standard output and standard error, by libraries in C too."""

    text = ""

    def __enter__(self) -> "_Printed":
        self._file = tempfile.TemporaryFile()
        self._kept = [os.dup(number) for number in (1, 2)]
        for number in (1, 2):
            os.dup2(self._file.fileno(), number)
        self._streams = sys.stdout, sys.stderr
        sys.stdout = io.TextIOWrapper(io.FileIO(1, "w", closefd=False), "utf-8", write_through=True)
        sys.stderr = io.TextIOWrapper(io.FileIO(2, "w", closefd=False), "utf-8", write_through=True)
        return self

    def __exit__(self, *_: object) -> None:
        for stream in (sys.stdout, sys.stderr):
            with suppress(ValueError):
                stream.flush()
        sys.stdout, sys.stderr = self._streams
        for number, kept in zip((1, 2), self._kept, strict=True):
            os.dup2(kept, number)
            os.close(kept)
        self._file.seek(0)
        self.text = self._file.read(100_000).decode("utf-8", "replace").strip()
        self._file.close()


def _reset_peak() -> None:
    """Forget the peak of this process, where the system can."""
    with suppress(OSError):
        Path("/proc/self/clear_refs").write_text("5", encoding="utf-8")


if __name__ == "__main__":
    # What cases print does not get into the answers.
    with os.fdopen(os.dup(1), "w", encoding="utf-8") as out:
        os.dup2(2, 1)
        serve(sys.stdin, out)
