"""An aircraft of JSBSim whose autopilot has engaged by raw sensors, in lockstep."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from pathlib import Path

import fcc

from .lockstep_rig import Conditions, LockstepRig
from .plan_flight import SENSORS, configuration
from .plant import Plant
from .raw_calibration import calibrate
from .raw_flight import MEASURED, RAW_STANDBY_S
from .raw_sensors import FIELD_UT
from .rig import FlightError
from .standin import Settings

ENGAGED_AFTER_S = RAW_STANDBY_S + 1.0
"""So long after it was set up the aircraft is engaged."""
RawFault = Callable[[fcc.Measurements, float], None]


def machine(plan: str, wind_kt: float, *, mode: str = "plan", config: str = "") -> fcc.Machine:
    """Return the loop with the text of a plan; raises fcc.ConfigError."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, "drawn.waypoints")
        file.write_text(plan, encoding="utf-8")
        return fcc.Machine(configuration(file, "kalman", "npfg", wind_kt, mode=mode) + config)


def engage(
    plant: Plant,
    loop: fcc.Machine,
    seed: int,
    *,
    sensors: str = SENSORS,
    raw_fault: RawFault | None = None,
) -> LockstepRig:
    """Let navigation settle in level flight, and engage; raises FlightError if it does not."""
    conditions = Conditions(
        raw_sensors=sensors,
        calibration=calibrate(sensors, seed, FIELD_UT),
        without=MEASURED,
        raw_fault=raw_fault,
    )
    rig = LockstepRig(Settings(seed=seed), plant, loop, conditions)
    rig.fly_to(rig.time_s + RAW_STANDBY_S)
    rig.set_switch(on=True)
    rig.fly_to(rig.time_s + ENGAGED_AFTER_S - RAW_STANDBY_S)
    if not rig.holds_control:
        raise FlightError(f"not engaged: {', '.join(loop.engage_inhibits)}")
    return rig


def last_events(rig: LockstepRig) -> str:
    """Return the last events, for the reason of an error."""
    return "; ".join(event.text for event in rig.events[-3:])
