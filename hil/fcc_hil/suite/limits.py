"""What is asked of a flight: the largest that each of its figures may be.

The two Cessnas with noise and a delay of 25 ms are held to the figures of a first
controller, which they have to beat in every column. The others are held to what was
measured on the seeds flown here and a margin of about a third: a figure beyond it says
that something changed.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

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
        "largest_bank_deg": "deg",
        "turned_back_deg": "deg",
        "hold_heading_error_deg": "deg",
        "hold_altitude_error_ft": "ft",
    }
)
"""Every figure that can be limited. The first nine are the worst over the legs."""


def limits(**figures: float) -> Limits:
    """Return limits; raises ValueError for a figure that there is not."""
    for name in figures:
        if name not in UNITS:
            raise ValueError(f"no figure '{name}'; there are: {', '.join(UNITS)}")
    # A plain dictionary: it travels to the processes that fly.
    return figures


def broken(figures: Mapping[str, Any], asked: Limits) -> list[str]:
    """Return in words each limit that the figures break; a figure that is None breaks its own."""
    words = []
    for name, most in asked.items():
        value = figures[name]
        if value is None:
            words.append(f"{name}: some leg never settles; the limit is {most:g} {UNITS[name]}")
        elif not value <= most:  # NaN is beyond every limit
            words.append(f"{name}: {value:.3g} is beyond {most:g} {UNITS[name]}")
    return words
