"""By which sensors the edges of flight are flown.

As they are, or with `FCC_RAW_SENSORS=board` or `phone` (`make test-raw-edges`) by raw sensors
alone: calibrated on the ground, and after 20 s of level flight in which navigation settles.
"""

from __future__ import annotations

import os
from dataclasses import replace

import fcc
import pytest

from fcc_hil.lockstep_rig import Conditions, LockstepRig
from fcc_hil.raw_calibration import calibrate
from fcc_hil.raw_flight import MEASURED, RAW_LATITUDE_DEG, RAW_STANDBY_S
from fcc_hil.raw_sensors import FIELD_UT
from fcc_hil.units import FT_TO_M

SENSORS = os.environ.get("FCC_RAW_SENSORS", "")
LATITUDE_DEG = RAW_LATITUDE_DEG if SENSORS else 0.0
_STANDBY_S = 2.0
STANDBY_S = RAW_STANDBY_S if SENSORS else _STANDBY_S
LATER_S = STANDBY_S - _STANDBY_S
"""How much later it is engaged by raw sensors."""
ALTIMETER_FT = 3.0 * 2.0 / FT_TO_M if SENSORS else 0.0
"""How far a barometer's slow bias of 2 m (one sigma) may take an altitude."""
MISSING = tuple(MEASURED) if SENSORS else ()

measured = pytest.mark.skipif(bool(SENSORS), reason="loses what raw sensors do not give")
"""Of a test with readings that there are not by raw sensors."""

beyond_a_phone = pytest.mark.xfail(
    SENSORS == "phone", reason="its accelerometer ends at 2 g (docs/navigation.md)", strict=True
)
"""Of a flight that a phone's sensors do not bring to its limits."""


def machine(config: str) -> fcc.Machine:
    """Return a loop with navigation by these sensors."""
    if not SENSORS:
        return fcc.Machine(config)
    north, east, down = FIELD_UT
    return fcc.Machine(
        f'{config}\n[navigation]\nmethod = "kalman"\n'
        f"magnetic_field_ut = [{north}, {east}, {down}]\n"
    )


def conditions(seed: int, others: Conditions | None = None) -> Conditions:
    """Return the conditions of a flight by these sensors."""
    others = others or Conditions()
    if not SENSORS:
        return others
    return replace(
        others,
        raw_sensors=SENSORS,
        calibration=calibrate(SENSORS, seed, FIELD_UT),
        without=MEASURED,
    )


def settle(rig: LockstepRig) -> None:
    """Let navigation settle while the trimmed aircraft flies."""
    rig.fly_to(rig.time_s + STANDBY_S)
