"""Frames at a constant or a varying rate, by absolute deadlines on the monotonic clock."""

from __future__ import annotations

import math
import random
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


# A frame rate moves slowly with the scene, and differs a little from frame to frame. With these a
# nominal 60 is between 27 and 133 for 95 % of the time.
_SCENE_LASTS_S = 2.0
_SCENE_DEVIATION = 0.4
_FRAME_DEVIATION = 0.1


class VaryingRate:
    """A frame rate that varies at random about a nominal one, seeded."""

    def __init__(self, nominal_hz: float, least_hz: float, greatest_hz: float, seed: int) -> None:
        """Vary between the least and the greatest rate."""
        if not 0.0 < least_hz <= nominal_hz <= greatest_hz:
            raise ValueError(
                f"frame rates {least_hz:g} to {greatest_hz:g} Hz: give two with the nominal "
                f"{nominal_hz:g} Hz between them"
            )
        self._nominal_hz = nominal_hz
        self._range_hz = (least_hz, greatest_hz)
        self._random = random.Random(seed)
        self._scene = 0.0

    def draw_s(self) -> float:
        """Return the length of the next frame."""
        gauss = self._random.gauss
        exponent = self._scene + gauss(0.0, _FRAME_DEVIATION)
        least, greatest = self._range_hz
        period_s = 1.0 / min(greatest, max(least, self._nominal_hz * math.exp(exponent)))
        kept = math.exp(-period_s / _SCENE_LASTS_S)
        self._scene = kept * self._scene + gauss(0.0, _SCENE_DEVIATION * math.sqrt(1.0 - kept**2))
        return period_s


class FrameClock:
    """Waits for each frame's deadline, and records the lateness and the work of each."""

    def __init__(self, rate_hz: float, varying: VaryingRate | None = None) -> None:
        """Start at `rate_hz`, or at a varying one; the first frame is one period from now."""
        self.slipped = 0
        self.skipped = 0
        self._lateness_s = array("d")
        self._work_s = array("d")
        self._begun_s = 0.0
        self._varying: VaryingRate | None = None
        self.set_rate(rate_hz)
        self._varying = varying

    def set_rate(self, rate_hz: float) -> None:
        """Make frames of one length from now on."""
        if not 1.0 <= rate_hz <= 1000.0:
            raise ValueError(f"frame rate {rate_hz:g} Hz: give 1 to 1000")
        self._varying = None
        self.rate_hz = rate_hz
        self.next_period_s = 1.0 / rate_hz
        self.restart()

    def restart(self) -> None:
        """Let the next frame be due one period from now."""
        self._deadline_s = time.monotonic() + self.next_period_s

    def begin(self) -> float:
        """Begin a frame; return the time since the one before, as planned."""
        period_s = self.next_period_s
        if self._varying is not None:
            self.next_period_s = self._varying.draw_s()
        self._deadline_s += self.next_period_s
        return period_s

    def wait(self) -> None:
        """Sleep until the next frame is due."""
        now_s = time.monotonic()
        if now_s < self._deadline_s:
            time.sleep(self._deadline_s - now_s)
            now_s = time.monotonic()
        late_s = now_s - self._deadline_s
        self._begun_s = now_s
        self._lateness_s.append(late_s)
        if late_s > self.next_period_s:
            self.slipped += 1
        if late_s > _GIVE_UP_S:
            missed = int(late_s / self.next_period_s)
            self.skipped += missed
            self._deadline_s += missed * self.next_period_s

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
