"""What X-Plane's own autopilot and artificial stability add to the yoke.

Wings level and the pitch that it began with, by gains that hold a light aircraft; rate damping for
the artificial stability. A client that flies at the same time flies against them.
"""

from __future__ import annotations

import math

from .cockpit import (
    ARTIFICIAL_STABILITY_ON,
    ARTSTAB_HEADING,
    ARTSTAB_PITCH,
    ARTSTAB_ROLL,
    OVERRIDE_ARTSTAB,
    OVERRIDE_AUTOPILOT,
    SERVO_HEADING,
    SERVO_PITCH,
    SERVO_ROLL,
    SERVOS_ON,
    YAW_DAMPER_ON,
    Cockpit,
)
from .state import State

_SERVO_MOST = 0.3
_PER_ROLL_RAD = 0.6
_PER_ROLL_RATE = 0.2
_PER_PITCH_RAD = 1.5
_PER_PITCH_RATE = 0.5
_DAMPING = 0.2
"""Of full deflection for 1 rad/s."""


class SimulatorAutopilot:
    """Sets the servos and the artificial stability of each frame."""

    def __init__(self) -> None:
        """Begin switched off."""
        self._pitch_rad: float | None = None

    def step(self, state: State, cockpit: Cockpit) -> None:
        """Set them for a frame, or to 0 while they are off; nothing while a client sets them."""
        if not cockpit.is_on(OVERRIDE_AUTOPILOT):
            self._move_servos(state, cockpit)
        if not cockpit.is_on(OVERRIDE_ARTSTAB):
            damps = cockpit.is_on(ARTIFICIAL_STABILITY_ON)
            damps_yaw = damps or cockpit.is_on(YAW_DAMPER_ON)
            cockpit.set(ARTSTAB_ROLL, -_DAMPING * state.roll_rate_radps if damps else 0.0)
            cockpit.set(ARTSTAB_PITCH, -_DAMPING * state.pitch_rate_radps if damps else 0.0)
            cockpit.set(ARTSTAB_HEADING, -_DAMPING * state.yaw_rate_radps if damps_yaw else 0.0)

    def _move_servos(self, state: State, cockpit: Cockpit) -> None:
        roll = pitch = 0.0
        if not cockpit.is_on(SERVOS_ON):
            self._pitch_rad = None
        else:
            if self._pitch_rad is None:
                self._pitch_rad = state.pitch_rad
            roll = (
                -_PER_ROLL_RAD * math.sin(state.roll_rad) - _PER_ROLL_RATE * state.roll_rate_radps
            )
            pitch = (
                _PER_PITCH_RAD * (self._pitch_rad - state.pitch_rad)
                - _PER_PITCH_RATE * state.pitch_rate_radps
            )
        cockpit.set(SERVO_ROLL, min(_SERVO_MOST, max(-_SERVO_MOST, roll)))
        cockpit.set(SERVO_PITCH, min(_SERVO_MOST, max(-_SERVO_MOST, pitch)))
        cockpit.set(SERVO_HEADING, 0.0)
