"""Limits of a flight: the largest permitted value of each figure.

The two Cessnas with noise and a delay of 25 ms must be better than an earlier controller in every
column. The limits of the others are the values measured on the seeds flown here plus a margin of
about a third: exceeding one shows that something changed.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

from .. import motion

Limits = Mapping[str, float]

UNITS = MappingProxyType(
    {
        "heading_settle_s": "s",
        "heading_overshoot_deg": "deg",
        "heading_rms_deg": "deg",
        "altitude_settle_s": "s",
        "altitude_overshoot_ft": "ft",
        "altitude_rms_ft": "ft",
        "turn_loss_ft": "ft",
        "airspeed_error_kt": "kt",
        "lateral_acceleration_g": "g",
        "unsettled_share": "of the legs",
        "mean_altitude_rms_ft": "ft",
        "turned_back_deg": "deg",
        "hold_heading_error_deg": "deg",
        "hold_altitude_error_ft": "ft",
    }
    | {name: unit for name, unit in motion.UNITS.items() if name not in motion.LEAST}
)
"""Every figure that can have a limit. The first nine are the worst over the legs."""


def limits(**figures: float) -> Limits:
    """Return limits; raise ValueError for an unknown figure."""
    for name in figures:
        if name not in UNITS:
            raise ValueError(f"no figure '{name}'; there are: {', '.join(UNITS)}")
    # A plain dictionary, because it is sent to the flying processes.
    return figures


def broken(figures: Mapping[str, Any], asked: Limits) -> list[str]:
    """Describe each exceeded limit; a figure that is None exceeds its limit."""
    words = []
    for name, most in asked.items():
        value = figures[name]
        if value is None:
            words.append(f"{name}: some leg never settles; the limit is {most:g} {UNITS[name]}")
        elif not value <= most:  # NaN exceeds every limit
            words.append(f"{name}: {value:.3g} exceeds {most:g} {UNITS[name]}")
    return words
