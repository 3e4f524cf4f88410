"""The rows of the table of degraded flight (docs/faults.md), with what is held in each.

Flown in lockstep (`test_degraded`), and some by the running daemon (`test_daemon_degraded`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from fcc_hil.truth import Truth

LEVEL_AFTER_S = 8.0
"""From a bank of 30 degrees."""


@dataclass(frozen=True)
class Limits:
    """What is held: the bank and the airspeed from `LEVEL_AFTER_S` after a loss on."""

    bank_deg: float
    altitude_ft: float
    airspeed_kt: float


ROWS = {
    "heading": (["heading"], Limits(1.0, 15.0, 3.0)),
    "acceleration": (["specific_force"], Limits(1.5, 60.0, 5.0)),
    "airspeed": (["airspeed"], Limits(1.0, 30.0, 8.0)),
    "airspeed and acceleration": (["airspeed", "specific_force"], Limits(1.5, 60.0, 15.0)),
    "altitude": (["altitude"], Limits(1.0, 100.0, 15.0)),
    "body rates": (["body_rates"], Limits(2.0, 15.0, 3.0)),
    "body rates and heading": (["body_rates", "heading"], Limits(2.0, 15.0, 3.0)),
    "attitude": (["attitude"], Limits(3.0, 20.0, 3.0)),
    "attitude and heading": (["attitude", "heading"], Limits(3.0, 20.0, 3.0)),
    "attitude and acceleration": (["attitude", "specific_force"], Limits(3.0, 100.0, 15.0)),
    "airspeed and altitude": (["airspeed", "altitude"], Limits(1.0, 150.0, 15.0)),
}
PITCH_AND_POWER = ("airspeed and acceleration", "attitude and acceleration")
"""Flown with a constant throttle."""


@dataclass(frozen=True)
class SinceLoss:
    """The truth of a flight, by times since a loss."""

    truth: Truth
    engaged_s: float
    """Simulated times."""
    lost_s: float

    def between(self, column: str, begin_s: float, end_s: float) -> npt.NDArray[np.float64]:
        """Return a column of the truth."""
        since_s = self.truth["time_s"] - self.lost_s
        return self.truth[column][(since_s >= begin_s) & (since_s < end_s)]

    def climbed_ft(self, end_s: float) -> float:
        """Return the largest change of the altitude until then."""
        altitude_ft = self.between("altitude_ft", 0.0, end_s)
        return float(np.max(np.abs(altitude_ft - altitude_ft[0])))

    def assert_held(self, limits: Limits, end_s: float) -> None:
        """Assert that it is held until then."""
        level = (LEVEL_AFTER_S, end_s)
        assert np.max(np.abs(self.between("roll_deg", *level))) < limits.bank_deg
        assert self.climbed_ft(end_s) < limits.altitude_ft
        captured_kt = self.truth.captured_at(self.engaged_s).airspeed_kt
        off_kt = np.abs(self.between("airspeed_kt", *level) - captured_kt)
        assert np.max(off_kt) < limits.airspeed_kt
