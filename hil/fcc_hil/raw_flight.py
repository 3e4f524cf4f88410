"""The timed pattern with raw sensors, as arrays: for navigation to be judged on.

    python -m fcc_hil raw --sensors phone --out target/raw-phone.npz

The autopilot flies by ideal sensors; the raw ones are read beside them, in lockstep.
"""

from __future__ import annotations

from pathlib import Path

import fcc
import numpy as np
import numpy.typing as npt

from .lockstep_rig import Conditions, LockstepRig
from .pattern import TimedPattern
from .plant import Plant, Weather
from .raw_sensors import DELAYS_S, FIELD_UT
from .rig import FlightError
from .standin import Settings

_LATITUDE_DEG = 45.0
"""Where navigation has a horizontal field and a convergence of meridians."""

_WEATHER = Weather(wind_from_deg=230.0, wind_kt=12.0, turbulence_severity=3)
"""A steady wind and light turbulence."""

_STANDBY_S = 5.0
"""Level flight in which navigation settles."""

_NAMES = {
    "raw_body_rates": ("gyroscope", "radps"),
    "raw_specific_force": ("accelerometer", "mps2"),
    "magnetic_field": ("magnetometer", "ut"),
    "static_pressure": ("static_pressure", "pa"),
    "differential_pressure": ("differential_pressure", "pa"),
    "air_temperature": ("air_temperature", "k"),
    "gnss": ("gnss", "rad_m_mps"),
    "range": ("range", "m"),
}
"""Of each reading the name of its sensor, and its unit."""

_TRUTH = (
    "time_s",
    "roll_rad",
    "pitch_rad",
    "heading_rad",
    "roll_rate_radps",
    "pitch_rate_radps",
    "yaw_rate_radps",
    "latitude_rad",
    "longitude_rad",
    "elevation_m",
    "altitude_m",
    "pressure_pa",
    "north_mps",
    "east_mps",
    "down_mps",
    "wind_north_mps",
    "wind_east_mps",
    "wind_down_mps",
    "airspeed_mps",
    "true_airspeed_mps",
)
"""The values of the state that are kept; the heading is true."""

Arrays = dict[str, npt.NDArray[np.float64]]


def fly(sensors: str, *, aircraft: str = "c172p", legs: int = 8, seed: int = 1) -> Arrays:
    """Fly the timed pattern; return the raw readings and the truth.

    Of each sensor `NAME_t_s`, when its readings arrived, `NAME_UNIT`, (n,) or (n, m), and
    `NAME_delay_s`, what is known of its delay; `truth_NAME`, a row per tick; `field_ut`, the
    earth's magnetic field, north, east and down. Raises FlightError.
    """
    pattern = TimedPattern()
    plant = Plant(aircraft, seed=seed, weather=_WEATHER, latitude_deg=_LATITUDE_DEG)
    machine = fcc.Machine('[guidance]\nmode = "timed-pattern"\n')
    conditions = Conditions(raw_sensors=sensors)
    rig = LockstepRig(Settings(aircraft=aircraft, seed=seed), plant, machine, conditions)
    truth: list[tuple[float, ...]] = []

    def keep() -> bool:
        state = plant.state()
        truth.append(tuple(getattr(state, name) for name in _TRUTH))
        return False

    rig.fly_to(rig.time_s + _STANDBY_S, keep)
    rig.set_switch(on=True)
    rig.fly_to(rig.time_s + 1.0, keep)
    if not rig.holds_control:
        raise FlightError(f"not engaged: {', '.join(machine.engage_inhibits)}")
    rig.fly_to(rig.time_s + pattern.duration_s(legs), keep)
    if rig.raw is None or not rig.holds_control:
        raise FlightError("the flight did not last to the end of the pattern")

    arrays: Arrays = {"field_ut": np.array(FIELD_UT)}
    for reading, rows in rig.raw.readings.items():
        name, unit = _NAMES[reading]
        if rows:
            table = np.array(rows)
            arrays[f"{name}_t_s"] = table[:, 0]
            arrays[f"{name}_{unit}"] = table[:, 1] if table.shape[1] == 2 else table[:, 1:]
    for name, delay_s in DELAYS_S[sensors].items():
        arrays[f"{name}_delay_s"] = np.array(delay_s)
    table = np.array(truth)
    for column, name in enumerate(_TRUTH):
        arrays[f"truth_{name}"] = table[:, column]
    return arrays


def save(path: Path, arrays: Arrays) -> None:
    """Write the arrays as `.npz`."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("wb") as file:
        np.savez_compressed(file, **arrays)  # type: ignore[arg-type]
