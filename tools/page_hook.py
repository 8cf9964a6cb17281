"""Puts the web page into wheels; an editable install reads it from the checkout."""

from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface


class PageHook(BuildHookInterface):  # type: ignore[misc]  # hatchling is there in builds alone
    """The hook of hatchling that `pyproject.toml` names."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Include the folder `web`, with its runtime if `tools/web_runtime.py` has fetched it.

        Args:
            version: "standard", or "editable".
            build_data: What is added to the build; `force_include` maps paths to places in it.
        """
        if version == "standard":
            build_data["force_include"]["web"] = "skinnet/inference/_web/page"
