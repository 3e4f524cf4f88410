"""Sensor noise has the levels it claims, and repeats with its seed."""

from __future__ import annotations

import math

import numpy as np
import pytest

from fcc_hil.noise import SensorNoise, standard_pressure_pa
from fcc_hil.plant import Plant
from fcc_hil.units import FT_TO_M, KT_TO_MPS

# One sigma of each sensor, in the units of the reference table.
SIGMAS = [
    ("pitch_rad", math.radians(0.2)),
    ("roll_rad", math.radians(0.2)),
    ("roll_rate_radps", math.radians(0.3)),
    ("pitch_rate_radps", math.radians(0.3)),
    ("yaw_rate_radps", math.radians(0.3)),
    ("specific_force_x_mps2", 0.6 * FT_TO_M),
    ("specific_force_y_mps2", 0.6 * FT_TO_M),
    ("specific_force_z_mps2", 0.6 * FT_TO_M),
    ("airspeed_mps", 0.7 * KT_TO_MPS),
    ("altitude_m", 2.5 * FT_TO_M),
    ("angle_of_attack_rad", math.radians(0.3)),
]


def test_levels_are_those_of_the_table() -> None:
    truth = Plant("c172p").state()
    noise = SensorNoise(seed=5)
    samples = [noise.apply(truth) for _ in range(4000)]
    for name, sigma in SIGMAS:
        errors = np.array([getattr(s, name) for s in samples]) - getattr(truth, name)
        assert np.std(errors) == pytest.approx(sigma, rel=0.06), name
        assert abs(np.mean(errors)) < 4.0 * sigma / math.sqrt(len(samples)), name
    headings = np.array([s.heading_rad for s in samples]) - truth.heading_rad
    wrapped = (headings + math.pi) % math.tau - math.pi
    assert np.std(wrapped) == pytest.approx(math.radians(0.4), rel=0.06)


def test_the_barometer_has_the_altitudes_error() -> None:
    # Near 3,000 ft pressure falls 11.0 Pa a metre (standard atmosphere).
    truth = Plant("c172p").state()
    noise = SensorNoise(seed=2)
    for _ in range(50):
        sample = noise.apply(truth)
        climbed_m = sample.altitude_m - truth.altitude_m
        assert truth.pressure_pa - sample.pressure_pa == pytest.approx(11.0 * climbed_m, rel=0.02)


@pytest.mark.parametrize(
    ("altitude_m", "pressure_pa"),
    # ISO 2533 / US Standard Atmosphere 1976.
    [(0.0, 101_325.0), (1_000.0, 89_874.6), (5_000.0, 54_019.9), (10_000.0, 26_436.3)],
)
def test_standard_pressure(altitude_m: float, pressure_pa: float) -> None:
    assert standard_pressure_pa(altitude_m) == pytest.approx(pressure_pa, rel=1e-4)


def test_a_seed_repeats() -> None:
    truth = Plant("c172p").state()
    assert SensorNoise(9).apply(truth) == SensorNoise(9).apply(truth)
    assert SensorNoise(9).apply(truth) != SensorNoise(10).apply(truth)
