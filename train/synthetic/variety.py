"""The two kinds of synthetic faces."""

from typing import Literal

Variety = Literal["mild", "any"]
"""`mild`: one nearly upright face, as in a portrait. `any`: faces as people photograph them, at all
poses and sizes, covered, in groups, behind hands, and skin without a face."""
