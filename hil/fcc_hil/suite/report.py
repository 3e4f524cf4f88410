"""The suite's outcomes as a table and as JSON."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from ..table import COLUMNS, TITLES, table
from .flying import Outcome
from .speed import Speed


def text(outcomes: Sequence[Outcome], speed: Speed | None = None) -> str:
    """Return the table, mean/worst over the legs, then every exceeded limit."""
    flown = [(_title(outcome), outcome.score) for outcome in outcomes]
    parts = [table([(title, figures) for title, figures in flown if figures is not None])]
    parts += [part for part in (_asked(outcomes), _further(outcomes)) if part]
    if speed is not None:
        parts.append(speed.words())
    bad = [outcome for outcome in outcomes if outcome.broken]
    for outcome in bad:
        parts.append("\n".join([f"{outcome.case.name}:", *(f"    {it}" for it in outcome.broken)]))
    if bad:
        parts.append(f"{len(bad)} of {len(outcomes)} cases exceed a limit")
    else:
        parts.append(f"all {len(outcomes)} cases are within their limits")
    return "\n\n".join(parts)


def document(outcomes: Iterable[Outcome], speed: Speed | None = None) -> dict[str, Any]:
    """Return it for JSON."""
    return {
        "cases": [outcome.document() for outcome in outcomes],
        "speed": speed.document() if speed else None,
    }


def _title(outcome: Outcome) -> str:
    return f"{outcome.case.name}{' (!)' if outcome.broken else ''}"


def _asked(outcomes: Sequence[Outcome]) -> str:
    """Return the limits of the table's columns, one row for each set of them."""
    rows: dict[tuple[float, ...], str] = {}
    for outcome in outcomes:
        asked = outcome.case.limits
        if all(column in asked for column in COLUMNS):
            rows.setdefault(tuple(asked[column] for column in COLUMNS), outcome.case.name)
    if not rows:
        return ""
    lines = [
        f"| {name} | {' | '.join(f'{most:.3g}' for most in mosts)} |"
        for mosts, name in rows.items()
    ]
    head = f"| limit of the worst leg, from here on | {' | '.join(TITLES)} |"
    return "\n".join([head, "|---" * (len(COLUMNS) + 1) + "|", *lines])


def _further(outcomes: Sequence[Outcome]) -> str:
    """Return the figures that are not in the table of legs, for the cases with limits on them."""
    rows = []
    for outcome in outcomes:
        figures = outcome.figures
        if not figures or "largest_bank_deg" not in outcome.case.limits:
            continue
        rows.append(
            f"| {outcome.case.name} | {1.0 - (figures['unsettled_share'] or 0.0):.0%} "
            f"| {figures['mean_altitude_rms_ft']:.2f} | {figures['largest_bank_deg']:.0f} "
            f"| {figures['turned_back_deg']:.1f} | {figures['hold_altitude_error_ft']:.2f} |"
        )
    if not rows:
        return ""
    head = (
        "| | legs settled | mean altitude RMS ft | largest bank ° | turned back ° "
        "| held before, RMS ft |\n|---|---|---|---|---|---|"
    )
    return "\n".join([head, *rows])
