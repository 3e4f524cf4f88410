"""Moves the air of a flight: gusts and columns of rising or sinking air."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

from ..plant import Plant
from .draw import Gust


def strength(gust: Gust, since_s: float) -> float:
    """Return the share of a gust's velocity, 0..1, at a time since its beginning.

    It comes as 1 - cos, as the discrete gust of MIL-F-8785C, stays, and goes the same way.
    """
    ends_s = 2.0 * gust.ramp_s + gust.steady_s
    if not 0.0 < since_s < ends_s:
        return 0.0
    ramp = min(1.0, since_s / gust.ramp_s, (ends_s - since_s) / gust.ramp_s)
    return 0.5 * (1.0 - math.cos(math.pi * ramp))


def mover(gusts: Sequence[Gust], now_s: Callable[[], float]) -> Callable[[Plant], None]:
    """Return what sets the gusts of a plant, given the time since engaging."""

    def move(plant: Plant) -> None:
        shares = [(gust, strength(gust, now_s() - gust.begins_s)) for gust in gusts]
        plant.set_gust(
            north_mps=sum(share * gust.north_mps for gust, share in shares),
            east_mps=sum(share * gust.east_mps for gust, share in shares),
            down_mps=sum(share * gust.down_mps for gust, share in shares),
        )

    return move
