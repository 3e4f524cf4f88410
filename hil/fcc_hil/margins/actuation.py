"""What is between the autopilot's commands and the surfaces: latency and servos."""

from __future__ import annotations

import math
from collections import deque
from dataclasses import astuple

from ..plant import STEPS_PER_SECOND, Plant
from ..state import Controls


class Actuation:
    """Writes commands late, and through servos of the first order."""

    def __init__(self, plant: Plant, delay_s: float = 0.0, servo_hz: float = 0.0) -> None:
        """Begin with the present controls; a servo of 0 Hz is ideal, the throttle has none.

        Raises ValueError for a negative delay or frequency.
        """
        if delay_s < 0.0 or servo_hz < 0.0:
            raise ValueError(f"delay {delay_s} s, servo {servo_hz} Hz: give 0 or more")
        self._plant = plant
        self._steps = round(delay_s * STEPS_PER_SECOND)
        self._waiting = deque([plant.controls] * self._steps)
        self._stands = plant.controls
        lag = math.exp(-2.0 * math.pi * servo_hz / STEPS_PER_SECOND)
        self._moved = 1.0 - lag if servo_hz > 0.0 else 1.0

    def fly(self, command: Controls, steps: int) -> None:
        """Fly steps of the plant while this is commanded."""
        for _ in range(steps):
            self._waiting.append(command)
            wanted = self._waiting.popleft()
            stands = (
                stand + self._moved * (want - stand)
                for want, stand in zip(astuple(wanted)[:3], astuple(self._stands)[:3], strict=True)
            )
            elevator, aileron, rudder = stands
            self._stands = Controls(
                elevator=elevator, aileron=aileron, rudder=rudder, throttle=wanted.throttle
            )
            self._plant.write(self._stands)
            self._plant.step(1)
