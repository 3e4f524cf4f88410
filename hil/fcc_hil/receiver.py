"""A satellite receiver's velocity over the ground: late, noisy, and only some times a second."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

import numpy as np

from .state import State
from .truth import TRUTH_HZ

Velocity = tuple[float, float, float]
"""Towards north, towards east and down, m/s."""


@dataclass(frozen=True)
class Receiver:
    """What a receiver is like."""

    period_ticks: int = 4
    """Between two velocities."""
    delay_ticks: int = 4
    """The age of a velocity when it comes."""
    sigma_mps: float = 0.1
    """Of the noise of each component, one standard deviation."""

    @property
    def rate_hz(self) -> float:
        """Velocities in a second."""
        return TRUTH_HZ / self.period_ticks


class ReceiverReadings:
    """The readings of a receiver along a flight."""

    def __init__(self, receiver: Receiver, seed: int) -> None:
        """Start the random sequence of `seed`."""
        self._receiver = receiver
        self._random = np.random.default_rng([seed, 1])
        self._late: deque[Velocity] = deque(maxlen=receiver.delay_ticks + 1)
        self._ticks = 0

    def read(self, state: State) -> Velocity | None:
        """Return the velocity that comes in this tick, which has this state."""
        self._late.append((state.north_mps, state.east_mps, state.down_mps))
        self._ticks += 1
        if self._ticks % self._receiver.period_ticks:
            return None
        noise = self._receiver.sigma_mps * self._random.standard_normal(3)
        north_mps, east_mps, down_mps = np.array(self._late[0]) + noise
        return float(north_mps), float(east_mps), float(down_mps)
