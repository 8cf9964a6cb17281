"""The page in a headless Chromium, which is skipped with a reason where something is missing."""

import os
import shutil
import threading
from collections.abc import Callable, Iterator
from typing import Any

import pytest
from page_steps import wait_for_maps

from skinnet.errors import InputError
from skinnet.inference._web.page_server import PageServer


@pytest.fixture(scope="session")
def server() -> Iterator[PageServer]:
    """The page's server."""
    try:
        server = PageServer(0)
    except InputError as error:
        pytest.skip(str(error))
    thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.05})
    thread.start()
    yield server
    server.shutdown()
    thread.join()
    server.server_close()


@pytest.fixture(scope="session")
def browser() -> Iterator[Any]:
    """Chromium, which finds no host but this one."""
    sync_api = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    path = find_chromium()
    if path is None:
        pytest.skip("Chromium is not installed: apt-get install chromium")
    arguments = [
        "--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1",
        "--use-fake-device-for-media-stream",
        "--use-fake-ui-for-media-stream",
    ]
    if os.name == "posix" and os.geteuid() == 0:
        arguments.append("--no-sandbox")  # which refuses to run as root
    with sync_api.sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=path, args=arguments)
        yield browser
        browser.close()


def find_chromium() -> str | None:
    """The path of an installed Chromium or Chrome."""
    names = ("chromium", "chromium-browser", "google-chrome")
    return next((path for name in names if (path := shutil.which(name))), None)


@pytest.fixture
def open_page(server: PageServer, browser: Any) -> Iterator[Callable[..., Any]]:
    """Open the page; what goes wrong in it fails the test."""
    faults: list[str] = []
    contexts: list[Any] = []

    def open_one(path: str = "", **options: Any) -> Any:
        contexts.append(browser.new_context(**options))
        page = contexts[-1].new_page()
        page.on("pageerror", lambda error: faults.append(str(error)))
        page.goto(server.address + path)
        return page

    yield open_one
    for context in contexts:
        context.close()
    assert not faults


@pytest.fixture(scope="module")
def sample_page(server: PageServer, browser: Any) -> Iterator[Any]:
    """The page with the sample read, and what it `requested`; tests leave it as they found it."""
    context = browser.new_context(viewport={"width": 1280, "height": 1600})
    page = context.new_page()
    page.requested = []
    context.on("request", lambda request: page.requested.append(request.url))
    page.goto(server.address)
    page.click("#sample")
    wait_for_maps(page)
    yield page
    context.close()
