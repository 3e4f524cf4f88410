"""The true state of the plant, one row per tick of a 40 Hz grid of simulated time."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from .pattern import SetPoints, TimedPattern
from .plant import STEPS_PER_SECOND
from .score import Score, Trace, score
from .state import Controls, State
from .units import FT_TO_M, KT_TO_MPS, STANDARD_GRAVITY_MPS2

TRUTH_HZ = 40
STEPS_PER_ROW = STEPS_PER_SECOND // TRUTH_HZ

COLUMNS = (
    "time_s",
    "heading_deg",
    "altitude_ft",
    "airspeed_kt",
    "lateral_g",
    "roll_deg",
    "pitch_deg",
    "climb_fpm",
    "elevator",
    "aileron",
    "rudder",
    "throttle",
    "load_g",
    "roll_rate_degps",
    "pitch_rate_degps",
    "yaw_rate_degps",
    "angle_of_attack_deg",
    "latitude_deg",
    "longitude_deg",
    "on_ground",
    "height_ft",
)

Row = tuple[float, ...]


def row(state: State, controls: Controls) -> Row:
    """Return one row in the order of COLUMNS, in the units of reports."""
    return (
        state.time_s,
        math.degrees(state.heading_rad),
        state.elevation_m / FT_TO_M,
        state.airspeed_mps / KT_TO_MPS,
        state.specific_force_y_mps2 / STANDARD_GRAVITY_MPS2,
        math.degrees(state.roll_rad),
        math.degrees(state.pitch_rad),
        -state.down_mps / FT_TO_M * 60.0,
        controls.elevator,
        controls.aileron,
        controls.rudder,
        controls.throttle,
        -state.specific_force_z_mps2 / STANDARD_GRAVITY_MPS2,
        math.degrees(state.roll_rate_radps),
        math.degrees(state.pitch_rate_radps),
        math.degrees(state.yaw_rate_radps),
        math.degrees(state.angle_of_attack_rad),
        math.degrees(state.latitude_rad),
        math.degrees(state.longitude_rad),
        float(state.on_ground),
        state.height_m / FT_TO_M,
    )


class Truth:
    """The rows of a flight by column."""

    def __init__(self, rows: Sequence[Row]) -> None:
        """Take rows made by `row`, at least one."""
        self._table: npt.NDArray[np.float64] = np.array(rows, dtype=np.float64)

    def __getitem__(self, column: str) -> npt.NDArray[np.float64]:
        """Return a column by its name in COLUMNS."""
        return self._table[:, COLUMNS.index(column)]

    def table(self) -> npt.NDArray[np.float64]:
        """Return all rows, their columns in the order of COLUMNS."""
        return self._table

    def since(self, time_s: float) -> Truth:
        """Return the rows from a time on, at least the last."""
        index = min(int(np.searchsorted(self["time_s"], time_s)), len(self._table) - 1)
        part = Truth(())
        part._table = self._table[index:]
        return part

    def trace(self) -> Trace:
        """Return the columns for the score."""
        return Trace(*(self[name] for name in COLUMNS[:5]))

    def score(self, pattern: TimedPattern, legs: int, engaged_at_s: float) -> Score:
        """Score a flight through the timed pattern. Raise ValueError as `score` does."""
        captured = self.captured_at(engaged_at_s)
        return score(self.trace(), pattern.legs(legs, engaged_at_s, captured))

    def captured_at(self, time_s: float) -> SetPoints:
        """Return the set points that an autopilot captures when it engages at `time_s`."""
        index = min(int(np.searchsorted(self["time_s"], time_s)), len(self._table) - 1)
        return SetPoints(
            heading_deg=float(self["heading_deg"][index]),
            altitude_ft=float(self["altitude_ft"][index]),
            airspeed_kt=float(self["airspeed_kt"][index]),
        )
