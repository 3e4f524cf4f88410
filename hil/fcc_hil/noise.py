"""Sensor noise: white, one draw per sample, seeded."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from .state import State
from .units import (
    FT_TO_M,
    KT_TO_MPS,
    SEA_LEVEL_PRESSURE_PA,
    STANDARD_GRAVITY_MPS2,
    wrap_heading_rad,
)

# Standard atmosphere below 11 km (ISO 2533): temperature, lapse rate, and the
# exponent of pressure against temperature.
_SEA_LEVEL_TEMPERATURE_K = 288.15
_LAPSE_K_PER_M = 0.0065
_PRESSURE_EXPONENT = STANDARD_GRAVITY_MPS2 / (287.053 * _LAPSE_K_PER_M)

_SIGMAS = 12


def standard_pressure_pa(altitude_m: float) -> float:
    """Return the standard atmosphere's static pressure at a pressure altitude below 11 km."""
    ratio = 1.0 - _LAPSE_K_PER_M * altitude_m / _SEA_LEVEL_TEMPERATURE_K
    return SEA_LEVEL_PRESSURE_PA * math.pow(ratio, _PRESSURE_EXPONENT)


@dataclass(frozen=True)
class NoiseLevels:
    """One standard deviation per sample. The defaults are a phone-grade sensor set."""

    attitude_rad: float = math.radians(0.2)
    """Pitch and roll."""
    heading_rad: float = math.radians(0.4)
    rate_radps: float = math.radians(0.3)
    specific_force_mps2: float = 0.6 * FT_TO_M
    airspeed_mps: float = 0.7 * KT_TO_MPS
    altitude_m: float = 2.5 * FT_TO_M
    angle_of_attack_rad: float = math.radians(0.3)


class SensorNoise:
    """Adds seeded noise to a state; one call is one sample of every sensor."""

    def __init__(self, seed: int = 1, levels: NoiseLevels | None = None) -> None:
        """Start the random sequence of `seed`."""
        self._levels = levels or NoiseLevels()
        self._random = np.random.default_rng(seed)

    def apply(self, state: State) -> State:
        """Return the measurements of `state`. Position and velocity are unchanged."""
        levels = self._levels
        n = self._random.standard_normal(_SIGMAS).tolist()
        altitude_m = state.altitude_m + levels.altitude_m * n[10]
        return replace(
            state,
            pitch_rad=state.pitch_rad + levels.attitude_rad * n[0],
            roll_rad=state.roll_rad + levels.attitude_rad * n[1],
            heading_rad=wrap_heading_rad(state.heading_rad + levels.heading_rad * n[2]),
            roll_rate_radps=state.roll_rate_radps + levels.rate_radps * n[3],
            pitch_rate_radps=state.pitch_rate_radps + levels.rate_radps * n[4],
            yaw_rate_radps=state.yaw_rate_radps + levels.rate_radps * n[5],
            specific_force_x_mps2=state.specific_force_x_mps2 + levels.specific_force_mps2 * n[6],
            specific_force_y_mps2=state.specific_force_y_mps2 + levels.specific_force_mps2 * n[7],
            specific_force_z_mps2=state.specific_force_z_mps2 + levels.specific_force_mps2 * n[8],
            airspeed_mps=max(0.0, state.airspeed_mps + levels.airspeed_mps * n[9]),
            altitude_m=altitude_m,
            # The barometer is the same instrument: it has the same error.
            pressure_pa=state.pressure_pa
            * standard_pressure_pa(altitude_m)
            / standard_pressure_pa(state.altitude_m),
            angle_of_attack_rad=state.angle_of_attack_rad + levels.angle_of_attack_rad * n[11],
        )
