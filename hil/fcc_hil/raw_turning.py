"""How a person turns sensors over by hand, to calibrate their gyroscope: the true motion."""

from __future__ import annotations

from collections.abc import Iterator

import fcc
import numpy as np
import numpy.typing as npt

from .units import STANDARD_GRAVITY_MPS2

Array = npt.NDArray[np.float64]

TURN_STEP_S = 0.005

_ALONE_S = 12.0
_TURNING_S = 2.0
_RESTING_S = 3.5
"""They are left alone, then turned, and laid down after each turn."""

_TURNS = (
    *((0, 2.0), (1, 2.0), (0, 1.0), (0, 2.0), (2, 2.0), (2, 1.0), (1, 2.0)),
    *((2, -2.0), (1, -1.0), (0, -2.0), (1, 2.0), (0, -1.0), (2, 2.0), (2, 1.0)),
)
"""The axis, x is 0, and the quarter turns about it."""

_UNTIDY_RAD = 0.08
"""A hand turns about no exact axis, and by no exact angle."""

_STILL = np.zeros(3)

__all__ = ["TURN_STEP_S", "true_motion", "turned_over"]


def turned_over(start_s: float) -> Iterator[fcc.RawTruth]:
    """Return the truth after each `TURN_STEP_S` from a time on."""
    time_s, attitude = start_s, np.eye(3)
    for _ in range(round(_ALONE_S / TURN_STEP_S)):
        time_s += TURN_STEP_S
        yield true_motion(time_s, attitude, _STILL)
    steps = round(_TURNING_S / TURN_STEP_S)
    for number, (axis, quarters) in enumerate(_TURNS, 1):
        turn = _UNTIDY_RAD * np.sin(1.7 * number + 2.1 * np.arange(3))
        turn[axis] += quarters * np.pi / 2
        for step in range(1, steps + 1):
            share = step / steps
            # Slowly at the begin and the end.
            angle, rate = share * share * (3.0 - 2.0 * share), 6.0 * share * (1.0 - share)
            time_s += TURN_STEP_S
            yield true_motion(time_s, attitude @ _rotation(angle * turn), rate / _TURNING_S * turn)
        attitude = attitude @ _rotation(turn)
        for _ in range(round(_RESTING_S / TURN_STEP_S)):
            time_s += TURN_STEP_S
            yield true_motion(time_s, attitude, _STILL)


def true_motion(time_s: float, attitude: Array, rates_radps: Array) -> fcc.RawTruth:
    """Return the truth on the ground with an attitude, from body to earth axes, and body rates."""
    [[forward_north, _, _], [forward_east, _, _], [x, y, z]] = attitude
    roll_radps, pitch_radps, yaw_radps = rates_radps
    return fcc.RawTruth(
        time_s=time_s,
        roll_rad=np.arctan2(y, z),
        pitch_rad=-np.arcsin(np.clip(x, -1.0, 1.0)),
        heading_rad=np.arctan2(forward_east, forward_north),
        roll_rate_radps=roll_radps,
        pitch_rate_radps=pitch_radps,
        yaw_rate_radps=yaw_radps,
        specific_force_x_mps2=-STANDARD_GRAVITY_MPS2 * x,
        specific_force_y_mps2=-STANDARD_GRAVITY_MPS2 * y,
        specific_force_z_mps2=-STANDARD_GRAVITY_MPS2 * z,
        static_pressure_pa=101_325.0,
        air_temperature_k=288.15,
    )


def _rotation(vector: Array) -> Array:
    """Return the rotation about a vector by its length (Rodrigues)."""
    angle = float(np.linalg.norm(vector))
    x, y, z = vector / angle if angle > 0.0 else _STILL
    across = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.asarray(np.eye(3) + np.sin(angle) * across + (1.0 - np.cos(angle)) * across @ across)
