"""Tables in Markdown, and scores as one: a row for each flight, mean and worst over its legs."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from .score import LegScore, Score

_COLUMNS: tuple[tuple[str, str, int], ...] = (
    ("heading_settle_s", "≤2° s", 1),
    ("heading_overshoot_deg", "overshoot °", 1),
    ("heading_rms_deg", "hdg RMS °", 2),
    ("altitude_settle_s", "≤10 ft s", 1),
    ("altitude_overshoot_ft", "alt overshoot ft", 1),
    ("altitude_rms_ft", "alt RMS ft", 2),
    ("turn_loss_ft", "height lost ft", 1),
    ("airspeed_error_kt", "dV kt", 1),
    ("lateral_acceleration_g", "lateral g", 3),
)

COLUMNS = tuple(name for name, _, _ in _COLUMNS)
TITLES = tuple(title for _, title, _ in _COLUMNS)


def _cell(legs: Sequence[LegScore], name: str, digits: int) -> str:
    values = [dict(leg)[name] for leg in legs]
    known = [value for value in values if isinstance(value, float)]
    if len(known) < len(values):
        return f"{len(known)} of {len(values)} legs"
    return f"{sum(known) / len(known):.{digits}f}/{max(known):.{digits}f}"


_ABREAST = 2
"""So many flights are columns, in 80 columns of a terminal; more are rows."""


def table(flights: Sequence[tuple[str, Score]]) -> str:
    """Return the flights as a Markdown table; each cell is mean/worst over the legs.

    If some leg has no time to settle, the number of legs that have one is given.
    """
    rows = [
        ["mean/worst", *TITLES],
        *(
            [name, *(_cell(flight["legs"], column, digits) for column, _, digits in _COLUMNS)]
            for name, flight in flights
        ),
    ]
    if len(flights) <= _ABREAST:
        rows = [list(column) for column in zip(*rows, strict=True)]
    return markdown(rows[0], rows[1:])


def markdown(head: Sequence[str], rows: Iterable[Iterable[object]]) -> str:
    """Return a Markdown table whose columns are aligned."""
    cells = [list(map(str, row)) for row in (head, *rows)]
    widths = [max(len(row[i]) for row in cells) for i in range(len(head))]
    lines = [
        "| " + " | ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)) + " |"
        for row in cells
    ]
    lines.insert(1, "|" + "|".join("-" * (width + 2) for width in widths) + "|")
    return "\n".join(lines)
