"""An aircraft of JSBSim whose autopilot has engaged by raw sensors, in lockstep."""

from __future__ import annotations

import tempfile
from pathlib import Path

import fcc

from fcc_hil.lockstep_rig import Conditions, LockstepRig
from fcc_hil.plan_flight import SENSORS, configuration
from fcc_hil.plant import Plant
from fcc_hil.raw_calibration import calibrate
from fcc_hil.raw_flight import MEASURED, RAW_STANDBY_S
from fcc_hil.raw_sensors import FIELD_UT
from fcc_hil.standin import Settings

ENGAGED_AFTER_S = RAW_STANDBY_S + 1.0
"""So long after it was set up the aircraft is engaged."""


def machine(plan: str, wind_kt: float, *, mode: str = "plan", config: str = "") -> fcc.Machine:
    """Return the loop with the text of a plan; raises fcc.ConfigError."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, "drawn.waypoints")
        file.write_text(plan, encoding="utf-8")
        return fcc.Machine(configuration(file, "kalman", wind_kt, mode=mode) + config)


def engage(plant: Plant, loop: fcc.Machine, seed: int) -> LockstepRig:
    """Let navigation settle in level flight, and engage; raises FlightError if it does not."""
    conditions = Conditions(
        raw_sensors=SENSORS, calibration=calibrate(SENSORS, seed, FIELD_UT), without=MEASURED
    )
    rig = LockstepRig(Settings(seed=seed), plant, loop, conditions)
    rig.engage(after_s=RAW_STANDBY_S)
    return rig


def last_events(rig: LockstepRig) -> str:
    """Return the last events, for the reason of an error."""
    return "; ".join(event.text for event in rig.events[-3:])
