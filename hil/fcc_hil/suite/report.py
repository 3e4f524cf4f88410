"""The suite's outcomes as a table and as JSON."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from ..table import COLUMNS, TITLES, markdown, table
from .flying import Outcome

_MOTION = (
    ("least_load_g", "least load g", 2),
    ("largest_load_g", "load g", 2),
    ("largest_roll_rate_degps", "roll °/s", 1),
    ("largest_pitch_rate_degps", "pitch °/s", 1),
    ("pitch_rate_sd_degps", "pitch sd °/s", 2),
    ("movement_per_s", "movement /s", 3),
    ("largest_angle_of_attack_deg", "attack °", 1),
    ("least_airspeed_kt", "least kt", 1),
    ("height_lost_ft", "height lost ft", 1),
)
"""Figure, title and digits."""


def text(outcomes: Sequence[Outcome]) -> str:
    """Return the table, mean/worst over the legs, then every exceeded limit."""
    flown = [(_title(outcome), outcome.score) for outcome in outcomes]
    parts = [table([(title, figures) for title, figures in flown if figures is not None])]
    parts += [part for part in (_asked(outcomes), _further(outcomes), _motion(outcomes)) if part]
    flown_s, cpu_s = (
        sum(getattr(outcome, name) for outcome in outcomes) for name in ("simulated_s", "cpu_s")
    )
    parts.append(f"{flown_s:.0f} s flown, {flown_s / cpu_s:.0f} times real time on one processor")
    bad = [outcome for outcome in outcomes if outcome.broken]
    for outcome in bad:
        parts.append("\n".join([f"{outcome.case.name}:", *(f"    {it}" for it in outcome.broken)]))
    if bad:
        parts.append(f"{len(bad)} of {len(outcomes)} cases exceed a limit")
    else:
        parts.append(f"all {len(outcomes)} cases are within their limits")
    return "\n\n".join(parts)


def document(outcomes: Iterable[Outcome]) -> dict[str, Any]:
    """Return it for JSON."""
    return {"cases": [outcome.document() for outcome in outcomes]}


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
    return markdown(
        ["limit of the worst leg, from here on", *TITLES],
        [[name, *(f"{most:.3g}" for most in mosts)] for mosts, name in rows.items()],
    )


def _motion(outcomes: Sequence[Outcome]) -> str:
    """Return how each aircraft moved."""
    rows = [
        [it.case.name, *(f"{it.figures[name] or 0.0:.{digits}f}" for name, _, digits in _MOTION)]
        for it in outcomes
        if it.figures
    ]
    return markdown(["how it moved", *(title for _, title, _ in _MOTION)], rows) if rows else ""


def _further(outcomes: Sequence[Outcome]) -> str:
    """Return the figures that are not in the table of legs, for the cases with limits on them."""
    rows = []
    for outcome in outcomes:
        figures = outcome.figures
        if not figures or "largest_bank_deg" not in outcome.case.limits:
            continue
        rows.append(
            [
                outcome.case.name,
                f"{1.0 - (figures['unsettled_share'] or 0.0):.0%}",
                f"{figures['mean_altitude_rms_ft']:.2f}",
                f"{figures['largest_bank_deg']:.0f}",
                f"{figures['turned_back_deg']:.1f}",
                f"{figures['hold_altitude_error_ft']:.2f}",
            ]
        )
    head = ["", "legs settled", "mean altitude RMS ft", "largest bank °", "turned back °"]
    return markdown([*head, "held before, RMS ft"], rows) if rows else ""
