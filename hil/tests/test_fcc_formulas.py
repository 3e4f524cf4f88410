"""Blocks and formulas of the module `fcc`, against tables and textbooks."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import fcc
import numpy as np
import pytest

ISO_2533 = [
    # Geopotential altitude (m), pressure (Pa), density (kg/m³): ISO 2533:1975, table 1.
    (0.0, 101_325.0, 1.225),
    (1_000.0, 89_874.6, 1.111_64),
    (5_000.0, 54_019.9, 0.736_116),
    (10_000.0, 26_436.3, 0.412_706),
]


@pytest.mark.parametrize(("altitude_m", "pressure_pa", "density_kgpm3"), ISO_2533)
def test_the_standard_atmosphere(
    altitude_m: float, pressure_pa: float, density_kgpm3: float
) -> None:
    assert fcc.pressure_pa(altitude_m) == pytest.approx(pressure_pa, rel=1e-5)
    assert 1.225 * fcc.density_ratio(altitude_m) == pytest.approx(density_kgpm3, rel=1e-5)
    assert fcc.pressure_altitude_m(pressure_pa) == pytest.approx(altitude_m, abs=0.1)


@pytest.mark.parametrize(
    "formula",
    [
        fcc.pressure_pa,
        fcc.density_ratio,
        lambda angle_rad: fcc.pressure_altitude_m(angle_rad + 101_325.0),
        lambda mps: fcc.true_airspeed_mps(mps, 0.0),
        fcc.wrap_pi,
        fcc.wrap_two_pi,
    ],
)
def test_a_number_gives_a_number_and_an_array_an_array(formula: Callable[[Any], Any]) -> None:
    for number in (1.5, 2, np.float64(1.5), np.int32(2), np.array(1.5)):
        assert type(formula(number)) is float
    for array in ([1.5], np.array([1.5]), np.array([[2]]), []):
        result = formula(np.asarray(array))
        assert isinstance(result, np.ndarray)
        assert result.shape == np.shape(array)
    # What is not stored row by row keeps its places.
    columns = np.array([[1.0, 2.0, 3.0], [0.1, 0.2, 0.3]]).T
    assert formula(columns)[2, 1] == formula(0.3)


def test_a_formula_takes_arrays_of_any_shape() -> None:
    altitudes = np.array([[row[0] for row in ISO_2533]] * 2)
    pressures = fcc.pressure_pa(altitudes)
    assert pressures.shape == (2, 4)
    np.testing.assert_allclose(pressures[1], [row[1] for row in ISO_2533], rtol=1e-5)
    assert fcc.true_airspeed_mps([100.0], 5_000.0)[0] == pytest.approx(
        100.0 / math.sqrt(0.736_116 / 1.225), rel=1e-5
    )


def _axis_rotation(axis: int, angle_rad: float) -> np.ndarray:
    """Return the matrix of a right-handed turn of a vector about one axis."""
    cos, sin = math.cos(angle_rad), math.sin(angle_rad)
    others = [n for n in range(3) if n != axis]
    matrix = np.eye(3)
    matrix[np.ix_(others, others)] = [[cos, -sin], [sin, cos]]
    if axis == 1:
        matrix = matrix.T
    return matrix


@pytest.mark.parametrize("angles_deg", [(0, 0, 0), (20, -10, 135), (-170, 60, 359), (90, 0, 270)])
def test_orientation_is_the_product_of_three_turns(angles_deg: tuple[int, int, int]) -> None:
    """Earth from body is heading times pitch times roll (Stevens and Lewis, eq. 1.3-20)."""
    roll, pitch, heading = (math.radians(angle) for angle in angles_deg)
    quaternion = fcc.quaternion_from_euler(roll, pitch, heading)
    matrix = _axis_rotation(2, heading) @ _axis_rotation(1, pitch) @ _axis_rotation(0, roll)
    vectors = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.3, -2.0, 9.81]])
    earth = fcc.body_to_earth(quaternion, vectors)
    np.testing.assert_allclose(earth, vectors @ matrix.T, atol=1e-12)
    np.testing.assert_allclose(fcc.earth_to_body(quaternion, earth), vectors, atol=1e-12)
    assert fcc.euler_from_quaternion(2.0 * quaternion) == pytest.approx(
        (roll, pitch, heading % (2 * math.pi)), abs=1e-9
    )


def test_angles_wrap() -> None:
    assert fcc.wrap_pi(math.radians(350.0)) == pytest.approx(math.radians(-10.0))
    np.testing.assert_allclose(fcc.wrap_two_pi([-0.1, 7.0]), [2 * math.pi - 0.1, 7 - 2 * math.pi])


def test_a_low_pass_of_one_time_constant_and_the_thesis_high_pass() -> None:
    low = fcc.LowPass(0.5)
    low.reset(1.0)
    assert low.step(0.0, 0.5) == pytest.approx(math.exp(-1.0))
    # The thesis' high pass at 40 Hz: lp = 0.8 lp + 0.2 x; y = x - lp.
    high = fcc.HighPass(-0.025 / math.log(0.8))
    high.reset(0.0)
    inputs = np.sin(np.arange(400) * 0.05) * 3.0 + 9.81
    expected, lowered = [], 0.0
    for value in inputs:
        lowered = 0.8 * lowered + 0.2 * value
        expected.append(value - lowered)
    np.testing.assert_allclose(high.run(inputs, 0.025), expected, atol=1e-9)


def test_a_series_is_its_steps() -> None:
    inputs = np.linspace(-3.0, 5.0, 50)
    for block in (fcc.LowPass, fcc.HighPass, fcc.RateLimit):
        one, other = block(0.7), block(0.7)
        steps = [one.step(value, 0.01) for value in inputs]
        assert np.array_equal(other.run(inputs, 0.01), steps)


def test_a_pid_with_its_pole_cancelled_gives_the_textbook_step_response() -> None:
    """A plant of 1/(1 + 2 s) under kp = 4, ki = kp/2: 1 - exp(-2 t)."""
    pid, level, dt = fcc.Pid(4.0, 2.0), 0.0, 1e-3
    for n in range(1, 2_001):
        level += (pid.step(1.0, level, dt) - level) / 2.0 * dt
        assert level == pytest.approx(1.0 - math.exp(-2.0 * n * dt), abs=2e-3)


def test_a_biased_rate_settles_at_bias_times_time_constant() -> None:
    blended = fcc.Complementary(0.5)
    for _ in range(50_000):
        blended.predict(0.01, 1e-4)
        blended.correct(0.0, 1e-4)
    assert blended.value == pytest.approx(0.005, rel=1e-2)


def test_a_profile_brakes_as_planned() -> None:
    """Beyond the knee v² = 2 a s, from a point half the knee away."""
    profile = fcc.SquareRootProfile(0.5, 1.0)
    assert profile.speed(1.0) == pytest.approx(0.5)
    assert profile.speed(-102.0) == pytest.approx(-math.sqrt(2.0 * 100.0))
