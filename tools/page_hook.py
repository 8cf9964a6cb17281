"""Puts the web page and the bill of materials into wheels.

An editable install reads the page from the checkout.
"""

from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface


class PageHook(BuildHookInterface):  # type: ignore[misc]  # hatchling is there in builds alone
    """The hook of hatchling that `pyproject.toml` names."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Include the folder `web`, with its runtime if `tools/web_runtime.py` has fetched it.

        Args:
            version: "standard", or "editable".
            build_data: What is added to the build; `force_include` maps paths to places in it, and
                `sbom_files` go where PEP 770 has them.
        """
        if version == "standard":
            build_data["force_include"]["web"] = "skinnet/inference/_web/page"
            bills = Path(self.root, "build", "bill").glob("*.cdx.json")
            build_data.setdefault("sbom_files", []).extend(map(str, bills))
