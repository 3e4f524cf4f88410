"""Frames at a constant rate: absolute deadlines on the monotonic clock, and their statistics."""

from __future__ import annotations

import time
from array import array
from typing import TypedDict

import numpy as np

# If further behind than this, frames are skipped instead of run one after another.
_GIVE_UP_S = 0.25


class Spread(TypedDict):
    """A distribution in microseconds."""

    p50: float
    p99: float
    max: float


class FrameReport(TypedDict):
    """Statistics of the frames."""

    frames: int
    rate_hz: float
    slipped: int
    """Frames begun more than one period late."""
    skipped: int
    """Frames never run, because the loop was too far behind."""
    lateness_us: Spread
    """From the deadline to the frame's begin."""
    work_us: Spread
    """From the frame's begin to its end."""


def _spread(values: array[float]) -> Spread:
    if not values:
        return {"p50": 0.0, "p99": 0.0, "max": 0.0}
    p50, p99, largest = (round(float(v) * 1e6, 1) for v in np.percentile(values, [50, 99, 100]))
    return {"p50": p50, "p99": p99, "max": largest}


class FrameClock:
    """Waits for each frame's deadline, and records the lateness and the work of each."""

    def __init__(self, rate_hz: float) -> None:
        """Start at `rate_hz`; the first frame is one period from now."""
        self.slipped = 0
        self.skipped = 0
        self._lateness_s = array("d")
        self._work_s = array("d")
        self._begun_s = 0.0
        self.set_rate(rate_hz)

    def set_rate(self, rate_hz: float) -> None:
        """Change the rate and restart from now."""
        if not 1.0 <= rate_hz <= 1000.0:
            raise ValueError(f"frame rate {rate_hz:g} Hz: give 1 to 1000")
        self.rate_hz = rate_hz
        self.period_s = 1.0 / rate_hz
        self._deadline_s = time.monotonic() + self.period_s

    def wait(self) -> None:
        """Sleep until the next frame is due."""
        now_s = time.monotonic()
        if now_s < self._deadline_s:
            time.sleep(self._deadline_s - now_s)
            now_s = time.monotonic()
        late_s = now_s - self._deadline_s
        self._begun_s = now_s
        self._lateness_s.append(late_s)
        if late_s > self.period_s:
            self.slipped += 1
        self._deadline_s += self.period_s
        if late_s > _GIVE_UP_S:
            missed = int(late_s / self.period_s)
            self.skipped += missed
            self._deadline_s += missed * self.period_s

    def done(self) -> None:
        """Mark the frame's work as done."""
        self._work_s.append(time.monotonic() - self._begun_s)

    def report(self) -> FrameReport:
        """Return the statistics of the frames since the start."""
        return {
            "frames": len(self._lateness_s),
            "rate_hz": self.rate_hz,
            "slipped": self.slipped,
            "skipped": self.skipped,
            "lateness_us": _spread(self._lateness_s),
            "work_us": _spread(self._work_s),
        }
