"""A simple pilot that flies an aircraft to a steady state if JSBSim's trim fails.

Cascaded loops with low gains, sufficient to hold speed, height and wings level in calm air for any
aircraft in the table. It is not the autopilot under test: its mean controls become the trim, and it
is not used afterwards.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from .state import Controls, State
from .units import STANDARD_GRAVITY_MPS2, wrap_degrees

# Gains are for the trimmed airspeed; the surfaces' gains decrease with dynamic pressure, as the
# forces increase.
_CLIMB_PER_ALTITUDE = 0.15  # 1/s
_CLIMB_LIMIT_MPS = 4.0
_PITCH_PER_CLIMB = 0.9  # flight-path angle to pitch, rad/rad
_PITCH_INTEGRAL = 0.25  # 1/s
_PITCH_LIMIT_RAD = math.radians(15.0)
_ELEVATOR_PER_PITCH = 1.6  # 1/rad
_ELEVATOR_INTEGRAL = 0.8  # 1/(rad s)
_ELEVATOR_PER_RATE = 0.5  # s/rad
_BANK_PER_HEADING = 0.8
_BANK_LIMIT_RAD = math.radians(15.0)
_AILERON_PER_BANK = 0.9  # 1/rad
_AILERON_INTEGRAL = 0.15  # 1/(rad s)
_AILERON_PER_RATE = 0.25  # s/rad
_THROTTLE_PER_SPEED = 0.03  # s/m
_THROTTLE_INTEGRAL = 0.006  # 1/m
_REFERENCE_AIRSPEED_MPS = 55.0


def _clamp(value: float, low: float, high: float) -> float:
    return min(high, max(low, value))


@dataclass
class SettlingPilot:
    """Holds a given airspeed (m/s, calibrated), altitude (m) and heading (rad)."""

    airspeed_mps: float
    altitude_m: float
    heading_rad: float
    throttle: float = 0.6
    """0..1, the integrator's start."""
    pitch_rad: float = 0.0
    """The pitch integrator's start."""
    elevator: float = 0.0
    aileron: float = 0.0

    def step(self, state: State, dt_s: float) -> Controls:
        """Return the controls for the next `dt_s` seconds."""
        speed_mps = max(state.true_airspeed_mps, 20.0)
        scale = min(1.0, (_REFERENCE_AIRSPEED_MPS / max(state.airspeed_mps, 20.0)) ** 2)

        climb_mps = _clamp(
            _CLIMB_PER_ALTITUDE * (self.altitude_m - state.elevation_m),
            -_CLIMB_LIMIT_MPS,
            _CLIMB_LIMIT_MPS,
        )
        path_error_rad = (climb_mps + state.down_mps) / speed_mps
        self.pitch_rad = _clamp(
            self.pitch_rad + _PITCH_INTEGRAL * path_error_rad * dt_s,
            -_PITCH_LIMIT_RAD,
            _PITCH_LIMIT_RAD,
        )
        pitch_error_rad = (
            _clamp(
                self.pitch_rad + _PITCH_PER_CLIMB * path_error_rad,
                -_PITCH_LIMIT_RAD,
                _PITCH_LIMIT_RAD,
            )
            - state.pitch_rad
        )
        self.elevator = _clamp(
            self.elevator + scale * _ELEVATOR_INTEGRAL * pitch_error_rad * dt_s, -1.0, 1.0
        )

        heading_error_rad = math.radians(
            wrap_degrees(math.degrees(self.heading_rad - state.heading_rad))
        )
        turn_bank_rad = math.atan(
            _BANK_PER_HEADING * heading_error_rad * speed_mps / STANDARD_GRAVITY_MPS2 / 5.0
        )
        bank_error_rad = _clamp(turn_bank_rad, -_BANK_LIMIT_RAD, _BANK_LIMIT_RAD) - state.roll_rad
        self.aileron = _clamp(
            self.aileron + scale * _AILERON_INTEGRAL * bank_error_rad * dt_s, -1.0, 1.0
        )

        speed_error_mps = self.airspeed_mps - state.airspeed_mps
        self.throttle = _clamp(
            self.throttle + _THROTTLE_INTEGRAL * speed_error_mps * dt_s, 0.0, 1.0
        )
        return Controls(
            elevator=_clamp(
                self.elevator
                + scale
                * (
                    _ELEVATOR_PER_PITCH * pitch_error_rad
                    - _ELEVATOR_PER_RATE * state.pitch_rate_radps
                ),
                -1.0,
                1.0,
            ),
            aileron=_clamp(
                self.aileron
                + scale
                * (_AILERON_PER_BANK * bank_error_rad - _AILERON_PER_RATE * state.roll_rate_radps),
                -1.0,
                1.0,
            ),
            throttle=_clamp(self.throttle + _THROTTLE_PER_SPEED * speed_error_mps, 0.0, 1.0),
        )
