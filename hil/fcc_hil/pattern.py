"""The timed pattern: the set points at each time since engagement.

Hold the captured state for 20 s, then turn right by 90 degrees every 20 s, climbing 150 ft on every
odd leg and descending on every even one. Independent of the daemon's implementation, which must
give the same set points.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from .units import wrap_heading


@dataclass(frozen=True)
class SetPoints:
    """Set points."""

    heading_deg: float
    """0..360."""
    altitude_ft: float
    airspeed_kt: float


@dataclass(frozen=True)
class Leg:
    """A stretch of a flight with constant set points, with those before it.

    It covers start_s <= time < end_s.
    """

    start_s: float
    end_s: float
    heading_from_deg: float
    heading_deg: float
    altitude_from_ft: float
    altitude_ft: float
    airspeed_kt: float


@dataclass(frozen=True)
class TimedPattern:
    """Times, turn and climb of the pattern."""

    hold_s: float = 20.0
    """How long the captured state is held first."""
    leg_s: float = 20.0
    turn_deg: float = 90.0
    """Per leg, positive to the right; less than 180 either way."""
    climb_ft: float = 150.0
    """Climbed on odd legs, descended on even ones."""

    def duration_s(self, legs: int) -> float:
        """Return the time from engagement to the end of the last leg."""
        return self.hold_s + legs * self.leg_s

    def legs_begun(self, since_engaged_s: float) -> int:
        """Return how many legs have begun: 0 during the hold."""
        if since_engaged_s < self.hold_s:
            return 0
        return 1 + math.floor((since_engaged_s - self.hold_s) / self.leg_s)

    def set_points(self, since_engaged_s: float, captured: SetPoints) -> SetPoints:
        """Return the set points at a time since engagement, given those captured then."""
        return self._after(self.legs_begun(since_engaged_s), captured)

    def legs(self, count: int, engaged_at_s: float, captured: SetPoints) -> list[Leg]:
        """Return the first `count` legs of a flight engaged at `engaged_at_s`."""
        legs = []
        for index in range(count):
            before, after = self._after(index, captured), self._after(index + 1, captured)
            start_s = engaged_at_s + self.hold_s + index * self.leg_s
            legs.append(
                Leg(
                    start_s=start_s,
                    end_s=start_s + self.leg_s,
                    heading_from_deg=before.heading_deg,
                    heading_deg=after.heading_deg,
                    altitude_from_ft=before.altitude_ft,
                    altitude_ft=after.altitude_ft,
                    airspeed_kt=after.airspeed_kt,
                )
            )
        return legs

    def _after(self, legs_begun: int, captured: SetPoints) -> SetPoints:
        return SetPoints(
            heading_deg=wrap_heading(captured.heading_deg + legs_begun * self.turn_deg),
            altitude_ft=captured.altitude_ft + (self.climb_ft if legs_begun % 2 == 1 else 0.0),
            airspeed_kt=captured.airspeed_kt,
        )
