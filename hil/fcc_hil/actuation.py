"""What lies between a command and its effect: latency and servos."""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass, replace

from .plant import STEP_S
from .state import Controls


@dataclass(frozen=True)
class Actuation:
    """The properties of the path from the autopilot to the surfaces."""

    latency_steps: int = 0
    """How late a command arrives, in steps of 1/120 s."""
    servo_hz: float | None = None
    """Bandwidth of the surfaces' servos, of first order; None if they follow at once."""


class Servos:
    """Latency and servos of one aircraft, advanced once for each step of the plant."""

    def __init__(self, actuation: Actuation, trim: Controls) -> None:
        """Start with all controls at the trim."""
        self._waiting: deque[Controls] = deque(
            [trim] * (actuation.latency_steps + 1), maxlen=actuation.latency_steps + 1
        )
        hz = actuation.servo_hz
        self._share = 1.0 if hz is None else 1.0 - math.exp(-2.0 * math.pi * hz * STEP_S)
        self._now = trim

    def step(self, command: Controls) -> Controls:
        """Return the positions one step later; the throttle is late, but has no servo."""
        self._waiting.append(command)
        to, now, share = self._waiting[0], self._now, self._share
        self._now = replace(
            to,
            elevator=now.elevator + share * (to.elevator - now.elevator),
            aileron=now.aileron + share * (to.aileron - now.aileron),
            rudder=now.rudder + share * (to.rudder - now.rudder),
        )
        return self._now
