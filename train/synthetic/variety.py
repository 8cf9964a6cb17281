"""The kinds of synthetic faces, and of their captures."""

from typing import Literal

Variety = Literal["mild", "any"]
"""`mild`: one nearly upright face, as in a portrait. `any`: faces as people photograph them, at all
poses and sizes, covered, in groups, behind hands, and skin without a face."""

Captures = Literal["mild", "wide"]
"""`mild`: careful cameras in white light. `wide`: cameras, lights and processing as in photographs
by anybody."""
