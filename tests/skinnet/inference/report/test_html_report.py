"""The report of a run is one page that holds every face, every reason, and nothing that runs."""

import tracemalloc
from collections.abc import Callable
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest
from flat_decomposer import SKIN, WALL, names, run, save

from skinnet import Decomposition
from skinnet.errors import InputError
from skinnet.inference._report import html_report
from skinnet.inference._report.face_row import show_text
from skinnet.inference._report.html_report import FaceReport
from skinnet.inference.results import _Result

Run = Callable[..., tuple[int, str, str]]
DARK = (60, 40, 30)
EVIL = "<img src=x onerror=alert(1)> \"'&.png"

__all__ = ["run"]


class Page(HTMLParser):
    """The elements of a page, and its text without style and script."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.elements: list[tuple[str, dict[str, str | None]]] = []
        self.text, self._inside, self.open = "", "", list[str]()
        self.feed(text)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.elements.append((tag, dict(attrs)))
        self._inside = tag
        if tag not in ("meta", "br", "img"):
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag
        self._inside = ""

    def handle_data(self, data: str) -> None:
        if self._inside not in ("style", "script"):
            self.text += data

    def find(self, tag: str) -> list[dict[str, str | None]]:
        return [attributes for name, attributes in self.elements if name == tag]


def read(path: Path) -> Page:
    page = Page(path.read_text(encoding="utf-8"))
    assert page.open == []
    return page


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Three people, a wall, and a file that is no picture."""
    for name, colour in (("a.png", SKIN), ("b.png", DARK), (EVIL, SKIN), ("wall.png", WALL)):
        save(tmp_path / "in" / name, colour)
    (tmp_path / "in" / "z.jpg").write_bytes(b"")
    return tmp_path / "in"


def test_every_face_and_every_reason_is_in_it(run: Run, folder: Path, tmp_path: Path) -> None:
    code, _, err = run("predict", folder, "-o", tmp_path / "out", "--report")
    assert code == 2 and f"The report is {tmp_path / 'out' / 'report.html'}." in err
    page = read(tmp_path / "out" / "report.html")
    assert "3 photographs, 3 faces read, 2 not read (1 could not be read, 1 without a face)" in (
        page.text
    )
    assert "20 %" in page.text and "90 %: 17 to 24 %" in page.text
    assert "usual: 1.3 to 43 %" in page.text
    assert f"No face was found in {folder / 'wall.png'}" in page.text
    assert f"{folder / 'z.jpg'} is empty" in page.text
    values = [each.get("data-value") for each in page.find("td") if each.get("data-label")]
    assert values.count("0.2") == 2 and values.count("0.06") == 1


def test_it_needs_no_other_file_and_runs_nothing_but_its_own(
    run: Run, folder: Path, tmp_path: Path
) -> None:
    run("predict", folder, "-o", tmp_path / "out", "--report")
    page = read(tmp_path / "out" / "report.html")
    pictures = page.find("img")
    assert len(pictures) == 3 + 4 * 3
    assert all(str(each["src"]).startswith("data:image/webp;base64,") for each in pictures)
    assert all(each["alt"] for each in pictures)
    assert len(page.find("script")) == len(page.find("style")) == 1
    assert not page.find("link") and not page.find("iframe")
    assert all(not key.startswith("on") for _, each in page.elements for key in each)
    assert [str(each["href"])[:2] for each in page.find("a")] == ["./"] * 3
    policy = page.find("meta")[2]["content"]
    assert policy is not None and policy.startswith("default-src 'none'; img-src data:;")
    assert "unsafe" not in policy and policy.count("sha256-") == 2


def test_names_of_files_are_text(run: Run, folder: Path, tmp_path: Path) -> None:
    run("predict", folder, "-o", tmp_path / "out", "--report")
    page = read(tmp_path / "out" / "report.html")
    assert EVIL in page.text and f"melanin of {folder / EVIL}" in [
        each["alt"] for each in page.find("img")
    ]


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("a&b <i>\"'", "a&amp;b &lt;i&gt;&quot;&#x27;"),
        ("a\nb\x1b[2J\x7f", "a\\x0ab\\x1b[2J\\x7f"),
        ("a\udcff.jpg", "a\\udcff.jpg"),
    ],
)
def test_texts_are_escaped(text: str, shown: str) -> None:
    assert show_text(text) == shown


def test_a_report_lies_beside_the_maps_or_where_it_is_wanted(
    run: Run, folder: Path, tmp_path: Path
) -> None:
    run("predict", folder / "a.png", "--report")
    assert "report.html" in names(folder / "skinmaps")
    run("predict", folder / "a.png", "--report", tmp_path / "new" / "page.htm")
    assert names(tmp_path / "new") == ["page.htm"]
    (link,) = read(tmp_path / "new" / "page.htm").find("a")
    assert (tmp_path / "new" / str(link["href"])).resolve() == folder / "skinmaps" / "a_panel.png"


def test_an_older_report_is_replaced_and_nothing_else(
    run: Run, folder: Path, tmp_path: Path
) -> None:
    page = tmp_path / "page.html"
    page.write_text("<html>mine</html>")
    code, _, err = run("predict", folder / "a.png", "--report", page)
    assert code == 2 and f"{page} exists, and is not a report of skinnet" in err
    assert page.read_text() == "<html>mine</html>" and not (folder / "skinmaps").exists()
    page.unlink()
    for name in ("a.png", "b.png"):
        assert run("predict", folder / name, "--report", page)[0] == 0
    assert "b.png" in read(page).text and "a.png" not in read(page).text


@pytest.mark.parametrize("name", ["photographs", "a.png", "page.txt"])
def test_a_page_ends_in_html(tmp_path: Path, name: str) -> None:
    with pytest.raises(InputError, match=rf"ends in \.html; got .*{name}\. Give --report after"):
        FaceReport(tmp_path / name)


def test_a_page_that_cannot_be_written_is_said(
    run: Run, folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object) -> None:
        raise OSError(28, "No space left on device")

    page = tmp_path / "page.html"
    assert run("predict", folder / "a.png", "--report", page)[0] == 0
    before = page.read_bytes()
    monkeypatch.setattr(html_report.shutil, "copyfileobj", fail)
    code, _, err = run("predict", folder / "b.png", "--report", page)
    assert code == 2 and "cannot be written (No space left on device)" in err
    assert page.read_bytes() == before and names(tmp_path) == ["in", "page.html"]


def test_memory_does_not_grow_with_the_number_of_faces(
    tmp_path: Path,
    decomposition: Decomposition,
    astronaut: np.ndarray,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(html_report, "_IN_MEMORY", 1 << 14)
    page = FaceReport(tmp_path / "page.html")
    row = html_report.make_row(
        *(
            astronaut,
            decomposition,
            {"file": "a.png"} | decomposition.summary(),
            Path("a_panel.png"),
        ),
        tmp_path,
    )
    monkeypatch.setattr(html_report, "make_row", lambda *_: row)
    result = _Result("a", decomposition, {})
    tracemalloc.start()
    for _ in range(1000):
        page.add_rows(html_report.make_rows(astronaut, [result], tmp_path, tmp_path / "page.html"))
    page.finish("1000 faces")
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    written = (tmp_path / "page.html").stat().st_size
    assert written > 1000 * len(row) and peak < 2_000_000 < written
    assert written < 20_000_000


def test_without_the_flag_nothing_is_written(tmp_path: Path) -> None:
    page = FaceReport(None)
    page.add_rows(["<tr></tr>"])
    page.add_failure("a", "b")
    page.finish("")
    assert names(tmp_path) == []


def test_an_interrupt_writes_what_was_read(
    run: Run, folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    add, done = FaceReport.add_rows, list[int]()

    def interrupt(self: FaceReport, *arguments: object) -> None:
        if done:
            raise KeyboardInterrupt
        add(self, *arguments)  # type: ignore[arg-type]
        done.append(1)

    monkeypatch.setattr(FaceReport, "add_rows", interrupt)
    path = tmp_path / "faces.html"
    code, _, said = run("predict", folder, "-o", tmp_path / "maps", "--report", path)
    assert code == 130 and f"Interrupted. {path} has the 1 faces that were read." in said
    assert "The run was interrupted." in read(path).text
