"""The calibration of simulated raw sensors on the ground, as a user does it.

The same seed gives sensors with the same errors: what is found here is true of a flight with it.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import Any

import fcc
import numpy as np
import numpy.typing as npt

from .raw_sensors import READINGS
from .raw_turning import TURN_STEP_S, turned_over
from .units import STANDARD_GRAVITY_MPS2

Array = npt.NDArray[np.float64]

_STEP_S = 0.025
_STEPS = 80
"""For as many steps each attitude is held: 2 s."""

_SETTLING_STEPS = 10

_CALIBRATED = ("raw_specific_force", "raw_body_rates", "magnetic_field", "differential_pressure")


@dataclass(frozen=True)
class AxesCalibration:
    """From what a sensor of three axes gives to what is measured."""

    bias: Array
    shape: Array
    """Scale and misalignment."""

    @classmethod
    def of(cls, found: dict[str, Any]) -> AxesCalibration:
        """Return what `fcc.calibrate` found."""
        return cls(np.array(found["bias"]), np.array(found["matrix"]))

    def turned(self, rotation: list[list[float]]) -> AxesCalibration:
        """Return this calibration, whose axes are turned by a rotation matrix."""
        return AxesCalibration(self.bias, np.array(rotation) @ self.shape)

    def applied(self, given: npt.ArrayLike) -> Array:
        """Return the calibrated values of (3,) or (n, 3)."""
        return np.asarray((np.asarray(given) - self.bias) @ self.shape.T)


@dataclass(frozen=True)
class Calibration:
    """What was found of the sensors of three axes, and of the pitot tube."""

    accelerometer: AxesCalibration
    gyroscope: AxesCalibration
    magnetometer: AxesCalibration
    differential_pressure_pa: float
    """What it shows without wind."""

    def apply(self, to: fcc.Measurements) -> None:
        """Calibrate the raw readings of measurements; NaN stays NaN."""
        for name, axes in (
            ("raw_specific_force", self.accelerometer),
            ("raw_body_rates", self.gyroscope),
            ("magnetic_field", self.magnetometer),
        ):
            for value, calibrated in zip(
                READINGS[name], axes.applied(_read(to, name)), strict=True
            ):
                setattr(to, value, calibrated)
        to.differential_pressure_pa -= self.differential_pressure_pa


def calibrate(sensors: str, seed: int, field_ut: tuple[float, float, float]) -> Calibration:
    """Hold the sensors still in many attitudes, turn them, and fit their calibrations."""
    attitudes = list(
        itertools.product(
            np.radians([-135.0, -90.0, -45.0, 0.0, 45.0, 90.0, 135.0, 180.0]),
            np.radians([-80.0, -40.0, 0.0, 40.0, 80.0]),
            np.radians([0.0, 120.0]),
        )
    )
    raw = fcc.RawSensors(sensors, _at_rest(0.0, *attitudes[0]), seed=seed, field_ut=field_ut)
    still = {name: np.empty((0, len(READINGS[name]))) for name in _CALIBRATED}
    for number, attitude in enumerate(attitudes):
        given: dict[str, list[tuple[float, ...]]] = {name: [] for name in _CALIBRATED}
        for step in range(_STEPS):
            raw.step(_at_rest((number * _STEPS + step + 1) * _STEP_S, *attitude))
            read = fcc.Measurements()
            raw.read(read)
            # Before that, samples of the last attitude arrive.
            if step >= _SETTLING_STEPS:
                for name in _CALIBRATED:
                    given[name].append(_read(read, name))
        for name in _CALIBRATED:
            still[name] = np.vstack((still[name], np.nanmean(given[name], axis=0)))
    force, field = still["raw_specific_force"], still["magnetic_field"]
    accelerometer = AxesCalibration.of(fcc.calibrate(force, STANDARD_GRAVITY_MPS2))
    gyroscope = _turned(raw, len(attitudes) * _STEPS * _STEP_S, accelerometer)
    level, nose_up = (
        accelerometer.applied(force[attitudes.index((0.0, pitch_rad, 0.0))])
        for pitch_rad in (0.0, np.radians(40.0))
    )
    mounting = fcc.level_and_nose_up(level, nose_up)
    accelerometer = accelerometer.turned(mounting)
    strength_ut = float(np.linalg.norm(field_ut))
    magnetometer = AxesCalibration.of(fcc.calibrate(field, strength_ut))
    down = -accelerometer.applied(force)
    magnetometer = magnetometer.turned(fcc.constant_dip(down, magnetometer.applied(field)))
    return Calibration(
        accelerometer=accelerometer,
        gyroscope=gyroscope.turned(mounting),
        magnetometer=magnetometer,
        differential_pressure_pa=float(still["differential_pressure"].mean()),
    )


def _turned(raw: fcc.RawSensors, start_s: float, accelerometer: AxesCalibration) -> AxesCalibration:
    """Turn the sensors over by hand, and fit the gyroscope's calibration."""
    given: dict[str, list[tuple[float, ...]]] = {"raw_body_rates": [], "raw_specific_force": []}
    steps_of_a_reading = round(_STEP_S / TURN_STEP_S)
    for number, truth in enumerate(turned_over(start_s), 1):
        raw.step(truth)
        if number % steps_of_a_reading == 0:
            read = fcc.Measurements()
            for name, arrived_s in raw.read(read).items():
                if name in given:
                    given[name].append((arrived_s, *_read(read, name)))
    rates, force = (np.array(rows) for rows in given.values())
    found = fcc.calibrate_gyroscope(
        gyroscope=(rates[:, 0], rates[:, 1:]),
        accelerometer=(force[:, 0], accelerometer.applied(force[:, 1:])),
    )
    return AxesCalibration.of(found)


def _read(of: fcc.Measurements, name: str) -> tuple[float, ...]:
    return tuple(getattr(of, value) for value in READINGS[name])


def _at_rest(time_s: float, roll_rad: float, pitch_rad: float, heading_rad: float) -> fcc.RawTruth:
    g = STANDARD_GRAVITY_MPS2
    return fcc.RawTruth(
        time_s=time_s,
        roll_rad=roll_rad,
        pitch_rad=pitch_rad,
        heading_rad=heading_rad,
        specific_force_x_mps2=g * np.sin(pitch_rad),
        specific_force_y_mps2=-g * np.cos(pitch_rad) * np.sin(roll_rad),
        specific_force_z_mps2=-g * np.cos(pitch_rad) * np.cos(roll_rad),
        static_pressure_pa=101_325.0,
        air_temperature_k=288.15,
    )
