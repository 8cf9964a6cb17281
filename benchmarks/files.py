"""Reports of files that tools of this kind read wrongly: how many are read rightly.

Every case is a test in `tests/reports`, with its right value; a file is a kind.
"""

import io
import time
from collections import Counter
from contextlib import redirect_stdout
from pathlib import Path

import pytest
from PIL import Image
from skimage.data import astronaut

from benchmarks import report
from skinnet.errors import InputError
from skinnet.images import read_photo

REPORTS = Path(__file__).parents[1] / "tests" / "reports"
_REPEATS = 15


class CaseCounter:
    """A pytest plugin that counts the cases of each file, and those that pass."""

    def __init__(self) -> None:
        self.tried: Counter[str] = Counter()
        self.right: Counter[str] = Counter()
        self.wrong: list[str] = []

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Count a test once: where it is called, or where its set-up fails."""
        if report.skipped or (report.when != "call" and not report.failed):
            return
        kind = Path(report.nodeid.partition("::")[0]).stem.removeprefix("test_")
        self.tried[kind] += 1
        self.right[kind] += report.passed
        if report.failed:
            self.wrong.append(report.nodeid)


def measure(reports: Path = REPORTS) -> report.Results:
    """Run all cases, and time the reading of an ordinary JPEG."""
    return count_cases(reports) | {"jpeg_over_pillow": round(time_reading(), 3)}


def count_cases(reports: Path) -> report.Results:
    """Run the cases of a folder.

    Returns:
        `tried`, `right`, `share_right`, `kinds` with the first two of each file, and the names of
        those that are `wrong`.
    """
    counter = CaseCounter()
    with redirect_stdout(io.StringIO()):
        code = pytest.main([str(reports), "-p", "no:cacheprovider"], plugins=[counter])
    if code not in (pytest.ExitCode.OK, pytest.ExitCode.TESTS_FAILED):
        raise InputError(f"pytest ended with {code!r} in {reports}; run it there to see why.")
    tried, right = counter.tried.total(), counter.right.total()
    return {
        "tried": tried,
        "right": right,
        "share_right": round(right / tried, 4),
        "kinds": {
            kind: {"tried": counter.tried[kind], "right": counter.right[kind]}
            for kind in sorted(counter.tried)
        },
        "wrong": counter.wrong,
    }


def time_reading(width: int = 4000, height: int = 3000) -> float:
    """Time of `read_photo` on a JPEG, in times of Pillow's decoder on the same bytes."""
    file = io.BytesIO()
    Image.fromarray(astronaut()).resize((width, height)).save(file, "JPEG", quality=90)
    content = file.getvalue()
    ours, pillow = [], []
    for _ in range(_REPEATS):
        start = time.perf_counter()
        read_photo(io.BytesIO(content))
        middle = time.perf_counter()
        Image.open(io.BytesIO(content)).load()
        ours.append(middle - start)
        pillow.append(time.perf_counter() - middle)
    return min(ours) / min(pillow)


def layout(results: report.Results) -> str:
    """Format a line for each kind."""
    rows = [(kind.replace("_", " "), count) for kind, count in results["kinds"].items()]
    lines = [f"{kind:<28}{count['right']:>5} of {count['tried']}" for kind, count in rows]
    lines.append(f"{'all':<28}{results['right']:>5} of {results['tried']}")
    lines += [f"wrong: {name}" for name in results["wrong"]]
    ratio = results["jpeg_over_pillow"]
    return "\n".join([*lines, f"a JPEG of 12 megapixels takes {ratio} times Pillow's decoding"])


if __name__ == "__main__":
    report.main(measure, __doc__ or "", layout)
