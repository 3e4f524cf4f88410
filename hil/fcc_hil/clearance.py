"""How near a flight came to the ground, by the truth."""

from __future__ import annotations

import math
from dataclasses import dataclass

from .state import State

_MEANT = frozenset({"", "none", "take-off", "land"})
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


class Clearance:
    """The least height over the ground so far."""

    def __init__(self) -> None:
        """Begin with nothing flown."""
        self._lowest_m = math.inf
        self._at_deg = (math.nan, math.nan)
        self._collides = False

    def note(self, state: State, mode: str) -> None:
        """Take the truth of a tick, flown in this mode."""
        if mode in _MEANT:
            return
        self._collides |= state.on_ground or state.height_m <= 0.0
        if state.height_m < self._lowest_m:
            self._lowest_m = state.height_m
            self._at_deg = math.degrees(state.latitude_rad), math.degrees(state.longitude_rad)

    def score(self) -> TerrainScore:
        """Return it."""
        return TerrainScore(self._lowest_m, *self._at_deg, self._collides)
