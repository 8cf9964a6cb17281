"""Steps that tests of the web page share."""

import re
from typing import Any

FIRST_MAPS_MS = 60_000
"""Time that the page gets to read a photograph on a busy machine."""


def wait_for_maps(page: Any) -> None:
    """Wait until a photograph is read."""
    page.locator("#status").filter(has_text=re.compile("^Read ")).wait_for(timeout=FIRST_MAPS_MS)
