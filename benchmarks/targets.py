"""Targets of the encoder, and the table of its figures beside them."""

from collections.abc import Iterator, Mapping
from typing import Any

ROWS = ("constant", "lookup", "ica", "stage1", "stage2")

ASKED: dict[str, Any] = {
    "melanin": {
        "rmse_ratio": "<= 0.25",
        "r_pixel": ">= 0.93",
        "r_image": ">= 0.98",
        "grid_rmse": "<= 0.30",
    },
    "hemoglobin": {
        "rmse_ratio": "<= 0.5",
        "r_pixel": ">= 0.80",
        "r_image": ">= 0.90",
        "grid_rmse": "<= 0.25",
    },
    "reconstruction": "<= 0.03",
    "mask_iou": ">= 0.93",
    "leak": "|.| <= 0.15",
    "group_ratio": "<= 1.6",
    "wide": {
        "melanin": {"r_image": ">= 0.97"},
        "hemoglobin": {"r_image": ">= 0.70"},
        "mask_iou": ">= 0.96",
        "leak": "|.| <= 0.1",
        "group_ratio": "<= 1.4",
    },
    "known": {"melanin": {"r_image": ">= 0.98"}, "hemoglobin": {"r_image": ">= 0.92"}},
    "portraits": {
        "reconstruction": "<= 0.04",
        "stability": {"melanin": "<= 0.10", "hemoglobin": "<= 0.20"},
        "ita_rank": "|.| >= 0.9",
    },
}
"""Targets of stage 2 on mild captures, where it shall also be better than every baseline in every
column, and those of wide captures."""

CAPTURES = ("wide", "known", "mild", "mild.blind", "any", "fourth.wide", "fourth.mild")
"""Rows of the shipped model and of the fourth in several captures."""

HIGHER = ("r_pixel", "r_image", "mask_iou")
"""Columns in which more is better; in the others, nearer to zero is better."""


def flatten(results: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    """Yield figures by their path."""
    for name, value in results.items():
        if isinstance(value, Mapping):
            yield from flatten(value, f"{prefix}{name}.")
        else:
            yield prefix + name, value


def list_not_beaten(results: Mapping[str, Any]) -> list[str] | None:
    """List ROW.COLUMN wherever a baseline is as good as stage 2 or better; None without stage 2."""
    if results["stage2"] is None:
        return None
    best = dict(flatten(results["stage2"]))
    return [
        f"{row}.{column}"
        for row in ROWS[:3]
        for column, value in flatten(results[row])
        if value is not None and best.get(column) is not None
        if _rank(column, value) >= _rank(column, best[column])
    ]


def _rank(column: str, value: float) -> float:
    return value if column.endswith(HIGHER) else -abs(value)


def format_table(results: Mapping[str, Any]) -> str:
    """Write the rows as columns of text with their targets, then all else line by line."""
    table = {row: dict(flatten(results[row] or {})) for row in ROWS}
    asked = dict(flatten(results["asked"]))
    names = list(dict.fromkeys(name for row in table.values() for name in row))
    lines = [_format_line("", [*ROWS, "asked"])]
    for name in names:
        cells = [_format_cell(table[row].get(name)) for row in ROWS]
        lines.append(_format_line(name, [*cells, asked.get(name, "")]))
    lines += ["", *_format_groups(results["groups"]), "", *_format_captures(results), ""]
    rest = {name: results[name] for name in ("portraits", "explained", "not_beaten", "settings")}
    for name, value in flatten(rest):
        wanted = asked.get(name, asked.get(_drop_disturbance(name), ""))
        lines.append(f"{name:44}{_format_cell(value):>9}  {wanted}".rstrip())
    return "\n".join(lines)


def _format_captures(results: Mapping[str, Any]) -> list[str]:
    """Format a table of the rows in several captures, with the targets of the first two."""
    figures = dict(flatten(results))
    names = [name.removeprefix("wide.") for name in figures if name.startswith("wide.")]
    asked = dict(flatten(ASKED))
    lines = [_format_line("", [*CAPTURES, "wide asked", "known asked"], 44)]
    for name in names:
        cells = [_format_cell(figures.get(f"{row}.{name}")) for row in CAPTURES]
        targets = [asked.get(f"{row}.{name}", "") for row in CAPTURES[:2]]
        lines.append(_format_line(name, [*cells, *targets], 44))
    return lines


def _format_groups(groups: Mapping[str, Any]) -> list[str]:
    """Format lines of the RMSE of melanin relative to its mean, by skin tone."""
    tones = next(iter(groups.values()))
    lines = [_format_line("melanin, relative rmse", ["pictures", "mean", *groups])]
    for tone, one in tones.items():
        cells = [_format_cell(row[tone]["relative_rmse"]) for row in groups.values()]
        lines.append(
            _format_line(tone, [_format_cell(one["pictures"]), _format_cell(one["mean"]), *cells])
        )
    return lines


def _drop_disturbance(name: str) -> str:
    """Turn portraits.stability.mirror.melanin into portraits.stability.melanin."""
    parts = name.split(".")
    return ".".join(parts[:2] + parts[3:]) if len(parts) > 3 else name


def _format_line(name: str, cells: list[str], width: int = 22) -> str:
    return f"{name:{width}}" + "".join(f"{cell:>13}" for cell in cells).rstrip()


def _format_cell(value: Any) -> str:
    if value is None:
        return "-"
    return f"{value:.4f}" if isinstance(value, float) else str(value)
