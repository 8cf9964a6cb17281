"""The report of a run in a headless Chromium: it sorts, by keyboard too, and axe finds no fault."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any
from urllib.parse import unquote, urlparse

import pytest
from flat_decomposer import FlatDecomposer, save

from skinnet.cli import main

COLOURS = {
    "a.png": (200, 140, 120),
    "<b onclick=alert(1)>.png": (60, 40, 30),
    "c.png": (120, 80, 60),
}
ORDER = list(COLOURS)


@pytest.fixture(scope="module")
def report(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A report of three photographs, and of a file that is none."""
    folder = tmp_path_factory.mktemp("photographs")
    for name, colour in COLOURS.items():
        save(folder / name, colour)
    (folder / "<script>alert(2)<").write_bytes(b"")
    (folder / "d.jpg").write_bytes(b"")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("skinnet.inference._photo_verbs.Decomposer", FlatDecomposer)
        main(["predict", str(folder), "--report", str(folder / "a page.html"), "-q"])
    return folder / "a page.html"


@pytest.fixture
def page(report: Path, browser: Any) -> Iterator[Any]:
    """The page, which asks for nothing, opens no dialog and has no error."""
    context = browser.new_context(viewport={"width": 1400, "height": 900})
    page = context.new_page()
    faults: list[str] = []
    page.on("pageerror", lambda error: faults.append(str(error)))
    page.on("console", lambda message: faults.append(message.text))
    page.on("dialog", lambda dialog: faults.append(dialog.message))
    asked: list[str] = []
    context.on("request", lambda request: asked.append(request.url))
    page.goto(report.as_uri())
    yield page
    context.close()
    assert faults == []
    assert [each for each in asked if not each.startswith("data:")] == [report.as_uri()]


def list_names(page: Any) -> list[str]:
    return page.locator("#faces tbody th > bdi").all_inner_texts()


def test_a_click_sorts_and_another_turns(page: Any) -> None:
    assert sorted(list_names(page)) == sorted(ORDER)
    button = page.get_by_role("button", name="Melanin")
    button.click()
    dark_first = [ORDER[1], ORDER[2], ORDER[0]]
    assert list_names(page) == dark_first
    head = page.locator("th", has=button)
    assert head.get_attribute("aria-sort") == "ascending"
    button.click()
    assert list_names(page) == dark_first[::-1]
    assert head.get_attribute("aria-sort") == "descending"
    assert page.locator("#told").inner_text() == "Sorted by Melanin, descending."


def test_the_keyboard_alone_sorts(page: Any) -> None:
    page.keyboard.press("Tab")
    assert page.evaluate("document.activeElement.id") == "by"
    page.keyboard.type("Hemo")
    assert list_names(page) == [ORDER[1], ORDER[2], ORDER[0]]
    page.keyboard.press("Tab")
    page.keyboard.press("Enter")
    assert list_names(page) == [ORDER[0], ORDER[2], ORDER[1]]
    page.keyboard.press("Tab")
    page.keyboard.press("Space")
    assert page.locator("#told").inner_text() == "Sorted by Face, ascending."


def test_pictures_are_shown_and_links_lead_to_panels(page: Any, report: Path) -> None:
    assert page.evaluate(
        "[...document.images].every((image) => image.complete && image.naturalWidth > 9)"
    )
    links = page.evaluate("[...document.links].map((link) => link.href)")
    assert len(links) == 3
    for link in links:
        assert Path(unquote(urlparse(link).path)).is_file()


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("width", [390, 1400])
def test_axe_finds_no_fault(page: Any, scheme: str, width: int) -> None:
    axe = pytest.importorskip("axe_playwright_python.sync_playwright", reason="axe is missing")
    page.set_viewport_size({"width": width, "height": 844})
    page.emulate_media(color_scheme=scheme)
    violations = axe.Axe().run(page).response["violations"]
    assert [(each["id"], each["impact"]) for each in violations] == []
    assert page.evaluate("document.documentElement.scrollWidth") <= width
