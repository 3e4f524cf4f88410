"""How near a flight came to the ground, by the truth."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from .flown_plan import FlownPlan

_MEANT = ["", "none", "take-off", "land"]
"""Modes in which the ground is to be near."""


@dataclass(frozen=True)
class TerrainScore:
    """How near the flight came to the ground, other than in a take-off and a landing."""

    lowest_m: float
    latitude_deg: float
    longitude_deg: float
    """Where it was lowest over the ground."""
    collides: bool
    """Whether it touched the ground there."""


def score(flown: FlownPlan, modes: Sequence[str]) -> TerrainScore:
    """Return it, by the mode of each row."""
    watched = np.flatnonzero(~np.isin(modes, _MEANT))
    if not len(watched):
        return TerrainScore(math.inf, math.nan, math.nan, collides=False)
    height_m = flown.height_m[watched]
    lowest = watched[np.argmin(height_m)]
    return TerrainScore(
        float(flown.height_m[lowest]),
        math.degrees(flown.latitude_rad[lowest]),
        math.degrees(flown.longitude_rad[lowest]),
        collides=bool(((height_m <= 0.0) | (flown.on_ground[watched] > 0.0)).any()),
    )
