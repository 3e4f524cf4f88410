"""`fcc.navigate`: arrays of raw samples in, estimates with their sigmas out."""

from __future__ import annotations

import math
from typing import Any

import fcc
import numpy as np
import pytest

SECONDS, RATE_HZ = 8, 50
TIMES_S = 100.0 + np.arange(SECONDS * RATE_HZ) / RATE_HZ
ROLL, PITCH, HEADING = (math.radians(angle) for angle in (20.0, -5.0, 250.0))
BODY = fcc.quaternion_from_euler(ROLL, PITCH, HEADING)
FORCE = fcc.earth_to_body(BODY, [0.0, 0.0, -9.80665])
FIELD_UT = fcc.earth_to_body(BODY, [20.0, 0.0, 40.0])


def still(vector: Any) -> tuple[np.ndarray, np.ndarray]:
    """Return a source that shows the same all the time."""
    return TIMES_S, np.tile(vector, (len(TIMES_S), 1))


GYROSCOPE, ACCELEROMETER = still([0.01, 0.0, -0.01]), still(FORCE)


@pytest.mark.parametrize("method", ["kalman", "thesis"])
def test_at_rest_the_orientation_is_that_of_gravity_and_field(method: str) -> None:
    found = fcc.navigate(
        gyroscope=GYROSCOPE,
        accelerometer=ACCELEROMETER,
        magnetometer=still(FIELD_UT),
        static_pressure=(TIMES_S, np.full(len(TIMES_S), 89_874.6)),
        method=method,
    )
    assert found["heading_reference"] == "magnetic"
    np.testing.assert_allclose(found["t_s"], TIMES_S, atol=1e-6)
    for name, expected in (("roll", ROLL), ("pitch", PITCH), ("heading", HEADING)):
        assert found[f"{name}_rad"][-1] == pytest.approx(expected, abs=math.radians(1.0))
    assert found["quaternion"].shape == (len(TIMES_S), 4)
    # ISO 2533: 898.746 hPa at 1,000 m.
    assert found["altitude_m"][-1] == pytest.approx(1_000.0, abs=0.5)


def test_at_rest_the_gyroscopes_show_their_bias() -> None:
    found = fcc.navigate(gyroscope=GYROSCOPE, accelerometer=ACCELEROMETER)
    bias, sigma = found["gyroscope_bias_radps"][-1], found["gyroscope_bias_radps_sigma"][-1]
    np.testing.assert_allclose(bias, [0.01, 0.0, -0.01], atol=1e-3)
    assert (sigma < 5e-3).all()
    assert found["heading_reference"] == "none"


WMM_2025 = [
    # Latitude, longitude (°), horizontal and downward field (µT), declination (°) in 2025.
    (80.0, 0.0, 6.5232, 54.7915, 1.28),
    (0.0, 120.0, 39.6779, -10.5802, -0.16),
    (-80.0, -120.0, 16.8981, -52.0225, 68.78),
]
"""The report of the World Magnetic Model 2025, table 6, at sea level."""


@pytest.mark.parametrize(
    ("latitude_deg", "longitude_deg", "horizontal_ut", "down_ut", "declination_deg"), WMM_2025
)
def test_a_position_gives_the_declination(
    latitude_deg: float,
    longitude_deg: float,
    horizontal_ut: float,
    down_ut: float,
    declination_deg: float,
) -> None:
    at = [[math.radians(latitude_deg)], [math.radians(longitude_deg)], [0.0]]
    found = fcc.navigate(
        gyroscope=still([0.0, 0.0, 0.0]),
        accelerometer=still([0.0, 0.0, -9.81]),
        magnetometer=still([horizontal_ut, 0.0, down_ut]),
        gnss_position=(TIMES_S, *np.tile(at, len(TIMES_S))),
        year=2025.0,
    )
    assert found["heading_reference"] == "true"
    field_ut = found["earth_field_ut"][-1]
    declination = math.degrees(math.atan2(field_ut[1], field_ut[0]))
    assert declination == pytest.approx(declination_deg, abs=0.1)
    heading = fcc.wrap_pi(found["heading_rad"][-1])
    assert math.degrees(heading) == pytest.approx(declination_deg, abs=1.0)


def test_vectors_are_n_by_3_or_three_arrays() -> None:
    one = fcc.navigate(gyroscope=GYROSCOPE, accelerometer=ACCELEROMETER)
    columns = (TIMES_S, *ACCELEROMETER[1].T)
    other = fcc.navigate(gyroscope=GYROSCOPE, accelerometer=columns)
    np.testing.assert_array_equal(one["quaternion"], other["quaternion"])


def test_a_mounting_turns_the_sensors_axes() -> None:
    """A sensor that looks backwards: half a turn about down."""
    turned: dict[str, Any] = {name: [0.0, 0.0, 0.0, 1.0] for name in ("gyroscope", "accelerometer")}
    backwards = still(FORCE * [-1.0, -1.0, 1.0])
    found = fcc.navigate(gyroscope=GYROSCOPE, accelerometer=backwards, mounting=turned)
    assert found["roll_rad"][-1] == pytest.approx(ROLL, abs=math.radians(1.0))


def test_what_is_not_finite_is_ignored() -> None:
    spoilt = ACCELEROMETER[1].copy()
    spoilt[50:60, 1] = math.nan
    found = fcc.navigate(gyroscope=GYROSCOPE, accelerometer=(TIMES_S, spoilt))
    assert found["roll_rad"][-1] == pytest.approx(ROLL, abs=math.radians(1.0))


WRONG: list[tuple[dict[str, Any], str]] = [
    ({}, "neither gyroscope nor accelerometer"),
    ({"gyroscope": 3.0}, "gyroscope: it is no tuple"),
    ({"gyroscope": (TIMES_S, np.zeros((3, 3)))}, r"gyroscope: it has 400 times.*\(3, 3\)"),
    ({"gyroscope": (TIMES_S[::-1], GYROSCOPE[1])}, "must not decrease"),
    ({"gyroscope": (TIMES_S, GYROSCOPE[1] + 400.0)}, "in rad/s"),
    ({"gyroscope": GYROSCOPE, "gnss_position": still([47.0, 8.0, 1.0])}, "degrees"),
    ({"gyroscope": GYROSCOPE, "static_pressure": (TIMES_S, TIMES_S)}, "in Pa"),
    ({"gyroscope": GYROSCOPE, "static_pressure": (TIMES_S, 0 * TIMES_S + 1013.25)}, "in Pa"),
    ({"accelerometer": (TIMES_S, ACCELEROMETER[1] / 9.80665)}, "is it in g"),
    ({"gyroscope": GYROSCOPE, "delays_s": {"radar": 0.1}}, "radar"),
    ({"gyroscope": GYROSCOPE, "delays_s": {"airspeed": 210.0}}, "0 to 0.5"),
    ({"gyroscope": GYROSCOPE, "mounting": np.eye(3) * 2}, "no rotation"),
    ({"gyroscope": GYROSCOPE, "method": "magic"}, "kalman"),
    ({"gyroscope": GYROSCOPE, "year": 2013.0}, "2020"),
]


@pytest.mark.parametrize(("arguments", "words"), WRONG)
def test_a_wrong_argument_is_named(arguments: dict[str, Any], words: str) -> None:
    with pytest.raises((ValueError, TypeError), match=words):
        fcc.navigate(**arguments)
