"""The battery of an aircraft, and the alternator that charges it while the engine turns.

A Cessna 172's: 28 V of the alternator on a lead-acid battery of 24 V (handbook, section 7) with
12.75 Ah. A cell without load has the specific gravity of its acid and 0.84 V (Linden and Reddy,
Handbook of Batteries, 2002, ch. 23), 1.28 when it is full and 1.12 when it is empty.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

CAPACITY_AH = 12.75
LOAD_A = 15.0
_ALTERNATOR_V = 28.0
_FEEDS_RADPS = 800.0 * math.tau / 60.0
_FULL_V, _EMPTY_V = 12.0 * (1.28 + 0.84), 12.0 * (1.12 + 0.84)
_RESISTANCE_OHM = 0.02
_HOUR_S = 3_600.0


@dataclass
class Battery:
    """What is left, and what takes it."""

    capacity_ah: float = CAPACITY_AH
    load_a: float = LOAD_A
    charge: float = 1.0
    """0 empty .. 1 full."""
    alternator_fails: bool = False
    is_fed: bool = True
    """Whether the alternator fed at last."""

    def step(self, seconds: float, engine_speed_radps: float) -> None:
        """Take the load for a time, or charge, which takes an hour from empty."""
        self.is_fed = not self.alternator_fails and engine_speed_radps >= _FEEDS_RADPS
        current_a = self.capacity_ah if self.is_fed else -self.load_a
        change = current_a * seconds / (_HOUR_S * self.capacity_ah)
        self.charge = min(1.0, max(0.0, self.charge + change))

    @property
    def voltage_v(self) -> float:
        """Return the voltage of what it feeds; an empty one has none."""
        if self.is_fed:
            return _ALTERNATOR_V
        if self.charge == 0.0:
            return 0.0
        cells_v = _EMPTY_V + (_FULL_V - _EMPTY_V) * self.charge
        return max(0.0, cells_v - _RESISTANCE_OHM * self.load_a)
