"""The timed pattern with raw sensors, in lockstep: flown by them, or recorded beside others.

    python -m fcc_hil raw --sensors phone --navigation kalman
    python -m fcc_hil raw --sensors phone --out target/raw-phone.npz

Flown by them, they are calibrated on the ground before (`raw_calibration`), and there are no
others. The arrays are for navigation to be judged on.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import fcc
import numpy as np
import numpy.typing as npt

from . import replacement
from .configurations import value_of, with_values
from .lockstep_board import BoardedLockstepRig, BoardLine
from .lockstep_rig import Conditions, LockstepRig
from .pattern import TimedPattern
from .plant import Plant, Weather
from .raw_calibration import calibrate
from .raw_sensors import DELAYS_S, FIELD_UT
from .rig import FlightError
from .score import Score
from .standin import Settings
from .units import FT_TO_M, KT_TO_MPS

RAW_LATITUDE_DEG = 45.0
"""Where navigation has a horizontal field and a convergence of meridians."""

_WIND = Weather(wind_from_deg=230.0, wind_kt=12.0)

LIGHT_TURBULENCE = 3

RAW_STANDBY_S = 20.0
"""Level flight in which navigation settles."""

MEASURED = frozenset(
    {"attitude", "heading", "body_rates", "specific_force", "airspeed", "altitude"}
)
"""Readings of sensors that measure what control needs."""

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

LEARNED = ("axial_offset", "full_thrust_ratio", "zero_lift_angle_deg", "one_g_angle_deg")
"""What is learned of an aircraft: the keys of `[autopilot.airframe]`."""

_ESTIMATE = ("roll_rad", "pitch_rad", "heading_rad", "altitude_m", "airspeed_mps")
"""The values of navigation's estimate that are kept."""

__all__ = [
    "MEASURED",
    "RAW_LATITUDE_DEG",
    "RAW_STANDBY_S",
    "BoardLine",
    "RawFlight",
    "fly",
    "read_learned",
    "save",
    "write_learned",
]

Arrays = dict[str, npt.NDArray[np.float64]]


@dataclass(frozen=True)
class RawFlight:
    """A flight of the timed pattern."""

    arrays: Arrays
    score: Score
    learned: dict[str, float] | None
    """What was learned of the aircraft: the keys of `[autopilot.airframe]`."""

    def errors(self) -> dict[str, float]:
        """Return the RMS errors of navigation while the pattern was flown."""
        arrays = self.arrays
        flown = arrays["truth_time_s"] >= arrays["engaged_s"]

        def rms(name: str, unit: float) -> float:
            error = (arrays[f"estimate_{name}"] - arrays[f"truth_{name}"])[flown]
            if unit == _DEGREE:
                error = np.arctan2(np.sin(error), np.cos(error))
            return float(np.sqrt(np.mean(error**2)) / unit)

        return {
            "roll_deg": rms("roll_rad", _DEGREE),
            "pitch_deg": rms("pitch_rad", _DEGREE),
            "heading_deg": rms("heading_rad", _DEGREE),
            "altitude_ft": rms("altitude_m", FT_TO_M),
            "airspeed_kt": rms("airspeed_mps", KT_TO_MPS),
        }


_DEGREE = float(np.radians(1.0))


def fly(
    sensors: str,
    *,
    navigation: str = "measured",
    aircraft: str = "c172p",
    legs: int = 8,
    seed: int = 1,
    turbulence: int = LIGHT_TURBULENCE,
    board: BoardLine | None = None,
    airframe: Mapping[str, float] | None = None,
) -> RawFlight:
    """Fly the timed pattern; return the raw readings, the truth and the estimate.

    `navigation` is `measured` for ideal sensors, or how attitude is computed from the raw ones:
    `kalman`. It is flown in 12 kt of wind, and turbulence of JSBSim's severity, 0 to 7.
    With `airframe`, what another flight has learned (`RawFlight.learned`), there is no pitot tube.
    With `board` the pitot tube, the switch and the surfaces are a servo board's, at the other end
    of this line.
    Of each sensor there are `NAME_t_s`, when its readings arrived, `NAME_UNIT`, (n,) or (n, m),
    and `NAME_delay_s`, what is known of its delay; `truth_NAME` and `estimate_NAME`, a row per
    tick; `engaged_s`; `field_ut`, the earth's magnetic field, north,
    east and down. Raises FlightError.
    """
    pattern = TimedPattern()
    weather = replace(_WIND, turbulence_severity=turbulence)
    plant = Plant(aircraft, seed=seed, weather=weather, latitude_deg=RAW_LATITUDE_DEG)
    north, east, down = FIELD_UT
    config = (
        '[guidance]\nmode = "timed-pattern"\n'
        f'[navigation]\nmethod = "{navigation}"\nmagnetic_field_ut = [{north}, {east}, {down}]\n'
    )
    machine = fcc.Machine(with_values(config, _learned_keys(airframe or {})))
    by_raw = navigation != "measured"
    without = MEASURED if by_raw else frozenset()
    if airframe is not None:
        without |= {"airspeed", "differential_pressure"}
    conditions = Conditions(
        raw_sensors=sensors,
        calibration=calibrate(sensors, seed, FIELD_UT) if by_raw else None,
        without=without,
    )
    settings = Settings(aircraft=aircraft, seed=seed)
    rig = (
        LockstepRig(settings, plant, machine, conditions)
        if board is None
        else BoardedLockstepRig(settings, plant, machine, conditions, board)
    )
    truth: list[tuple[float, ...]] = []
    estimate: list[tuple[float, ...]] = []

    def keep() -> bool:
        state, found = plant.state(), machine.estimate
        truth.append(tuple(getattr(state, name) for name in _TRUTH))
        estimate.append(tuple(getattr(found, name) for name in _ESTIMATE))
        return False

    engaged_s = rig.time_s + RAW_STANDBY_S
    rig.engage(after_s=RAW_STANDBY_S, until=keep)
    rig.fly_to(engaged_s + pattern.duration_s(legs), keep)
    if rig.raw is None or not rig.holds_control:
        raise FlightError("the flight did not last to the end of the pattern")

    arrays: Arrays = {"field_ut": np.array(FIELD_UT), "engaged_s": np.array(engaged_s)}
    for reading, rows in rig.raw.readings.items():
        name, unit = _NAMES[reading]
        if rows:
            table = np.array(rows)
            arrays[f"{name}_t_s"] = table[:, 0]
            arrays[f"{name}_{unit}"] = table[:, 1] if table.shape[1] == 2 else table[:, 1:]
    for name, delay_s in DELAYS_S[sensors].items():
        arrays[f"{name}_delay_s"] = np.array(delay_s)
    for kind, names, kept in (("truth", _TRUTH, truth), ("estimate", _ESTIMATE, estimate)):
        table = np.array(kept)
        for column, name in enumerate(names):
            arrays[f"{kind}_{name}"] = table[:, column]
    return RawFlight(arrays, rig.truth().score(pattern, legs, engaged_s), machine.learned_airframe)


def write_learned(path: Path, learned: Mapping[str, float]) -> None:
    """Write what was learned, as it stands in a configuration file."""
    replacement.write(path, with_values("", _learned_keys(learned)))


def read_learned(path: Path) -> dict[str, float]:
    """Read what `write_learned` wrote. Raises OSError, and ValueError if it is something else."""
    try:
        text = path.read_text(encoding="utf-8")
    except UnicodeDecodeError as error:
        raise ValueError(f"{path} is no text: give a file that --learned has written") from error
    keys = _learned_keys(dict.fromkeys(LEARNED, 0.0))
    found = {key: value_of(text, key, math.nan) for key in keys}
    missing = [key for key, value in found.items() if math.isnan(value)]
    if missing:
        raise ValueError(f"{path}: {missing[0]} is missing: give a file that --learned has written")
    return dict(zip(LEARNED, found.values(), strict=True))


def _learned_keys(learned: Mapping[str, float]) -> dict[str, float]:
    return {f"autopilot.airframe.{name}": value for name, value in learned.items()}


def save(path: Path, arrays: Arrays) -> None:
    """Write the arrays as `.npz`."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with replacement.replacing(path) as file:
        np.savez_compressed(file, **arrays)  # type: ignore[arg-type]
