"""The figures of `benchmarks.constancy` as a table, and all others line by line."""

from collections.abc import Iterator, Mapping
from typing import Any

from benchmarks.targets import flatten

VALUES = ("melanin", "hemoglobin", "angle", "log_rg", "log_bg")
COLUMNS = ("icc", "icc_interval", "within_sd", "between_sd", "coverage", "stated_sd")

ASKED = {
    "pairs.melanin.icc": ">= 0.70",
    "pairs.hemoglobin.icc": ">= 0.58",
    "synthetic.pairs.melanin.icc": ">= 0.95",
    "synthetic.pairs.hemoglobin.icc": ">= 0.80",
    "synthetic.fused5.melanin.r": ">= 0.985",
    "synthetic.fused5.hemoglobin.r": ">= 0.92",
    "london.blind.rank": "|.| >= 0.90",
    "london.white.rank": "|.| >= 0.97",
    "guards.slope.known.melanin": ">= 0.8",
    "guards.slope.known.hemoglobin": ">= 0.6",
    "guards.slope_synthetic.known.melanin": ">= 0.8",
    "guards.slope_synthetic.known.hemoglobin": ">= 0.6",
}
"""Targets of the shipped model. The angle's spread within a person shall be at most half of that of
uncorrected pixels, and intervals of 90 % shall hold 86 to 94 % of the differences."""

_PARTS = ("regions", "captures", "guards", "london", "synthetic", "second_source")


def format_table(results: Mapping[str, Any]) -> str:
    """Write a line for each row and value of the pairs, then all else beside the fourth model's."""
    baselines = results["baselines"]
    rows = {"shipped": results["pairs"], **baselines}
    lines = [f"{'':34}" + "".join(f"{name:>20}" for name in COLUMNS).rstrip()]
    for row, scores in rows.items():
        lines += _format_row(row, scores or {})
    fourth = dict(flatten({part: baselines["fourth"].get(part, {}) for part in _PARTS}))
    lines += ["", f"{'':56}{'shipped':>10}{'fourth':>10}  asked"]
    for name, value in flatten({part: results[part] for part in _PARTS}):
        if name.endswith(("icc_interval", "people", "portraits")):
            continue
        cells = f"{_format(value):>10}{_format(fourth.get(name)):>10}"
        lines.append(f"{name:56}{cells}  {ASKED.get(name, '')}".rstrip())
    return "\n".join(lines)


def _format_row(row: str, scores: Mapping[str, Any]) -> Iterator[str]:
    if "missing" in scores:
        yield f"{row}: {scores['missing']}"
    for value in VALUES:
        if scores.get(value) is not None:
            cells = [_format(scores[value].get(name)) for name in COLUMNS]
            yield f"{row + '.' + value:34}" + "".join(f"{cell:>20}" for cell in cells)
    for name in ("rank_other", "validity"):
        if name in scores:
            yield f"{row + '.' + name:34}{_format(scores[name]):>20}"


def _format(value: Any) -> str:
    if value is None:
        return "-"
    if isinstance(value, list):
        return " to ".join(_format(one) for one in value)
    return f"{value:.3f}" if isinstance(value, float) else str(value)
