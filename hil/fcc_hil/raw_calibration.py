"""The calibration of simulated raw sensors on the ground, as a user does it.

The same seed gives sensors with the same errors: what is found here is true of a flight with it.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import fcc
import numpy as np
import numpy.typing as npt

from .raw_sensors import READINGS
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
    def of(cls, found: dict[str, list[float]]) -> AxesCalibration:
        """Return what `fcc.calibrate` found."""
        xy, xz, yx, yz, zx, zy = found["misalignment"]
        ratios = np.array([[1.0, xy, xz], [yx, 1.0, yz], [zx, zy, 1.0]])
        return cls(np.array(found["bias"]), ratios * np.array(found["scale"]))

    def turned(self, rotation: Array) -> AxesCalibration:
        """Return this calibration, whose axes are turned by a rotation matrix."""
        return AxesCalibration(self.bias, rotation @ self.shape)

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
    """Hold the sensors still in many attitudes, and fit their calibrations."""
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
    level = attitudes.index((0.0, 0.0, 0.0))
    accelerometer = accelerometer.turned(_levelling(accelerometer.applied(force[level])))
    strength_ut = float(np.linalg.norm(field_ut))
    magnetometer = AxesCalibration.of(fcc.calibrate(field, strength_ut))
    down = -accelerometer.applied(force)
    magnetometer = magnetometer.turned(_constant_dip(down, magnetometer.applied(field)))
    return Calibration(
        accelerometer=accelerometer,
        gyroscope=AxesCalibration(still["raw_body_rates"].mean(axis=0), np.eye(3)),
        magnetometer=magnetometer,
        differential_pressure_pa=float(still["differential_pressure"].mean()),
    )


def _levelling(force: Array) -> Array:
    """Return the rotation after which the force of a level aircraft points up."""
    up = np.array([0.0, 0.0, -1.0])
    axis = np.cross(force / np.linalg.norm(force), up)
    return _rotation(
        axis / max(float(np.linalg.norm(axis)), 1e-12) * np.arcsin(np.linalg.norm(axis))
    )


def _constant_dip(down: Array, field: Array) -> Array:
    """Return the rotation of a small angle after which the dip is the same in all attitudes."""
    # down . (m + turn x m) = constant.
    rows = np.column_stack((np.cross(field, down), -np.ones(len(down))))
    found = np.linalg.lstsq(rows, -np.sum(down * field, axis=1), rcond=None)[0]
    return _rotation(found[:3])


def _rotation(vector: Array) -> Array:
    """Return the matrix of a rotation vector (Rodrigues)."""
    angle = float(np.linalg.norm(vector))
    x, y, z = vector / max(angle, 1e-12)
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.asarray(np.eye(3) + np.sin(angle) * cross + (1.0 - np.cos(angle)) * cross @ cross)


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
