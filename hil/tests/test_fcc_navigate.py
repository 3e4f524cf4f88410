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


def test_at_rest_the_orientation_is_that_of_gravity_and_field() -> None:
    found = fcc.navigate(
        gyroscope=GYROSCOPE,
        accelerometer=ACCELEROMETER,
        magnetometer=still(FIELD_UT),
        static_pressure=(TIMES_S, np.full(len(TIMES_S), 89_874.6)),
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


def test_what_is_masked_is_left_out() -> None:
    """Values that a mask hides are of another roll, more than half of them."""
    hidden = np.arange(len(TIMES_S)) % 5 > 1
    force = np.ma.array(ACCELEROMETER[1].copy(), mask=np.repeat(hidden[:, None], 3, axis=1))
    force.data[hidden] *= [1.0, -1.0, 1.0]
    found = fcc.navigate(gyroscope=GYROSCOPE, accelerometer=(TIMES_S, force))
    assert len(found["t_s"]) == len(TIMES_S)
    assert found["roll_rad"][-1] == pytest.approx(ROLL, abs=math.radians(1.0))
    columns = (TIMES_S, *(force[:, axis] for axis in range(3)))
    np.testing.assert_array_equal(
        fcc.navigate(gyroscope=GYROSCOPE, accelerometer=columns)["roll_rad"], found["roll_rad"]
    )
    untimed = (np.ma.array(TIMES_S, mask=hidden), force.data)
    found = fcc.navigate(gyroscope=GYROSCOPE, accelerometer=untimed)
    assert found["roll_rad"][-1] == pytest.approx(ROLL, abs=math.radians(1.0))


def moving(velocity: list[float], unit: float = 1.0) -> dict[str, Any]:
    """Return 60 s of a straight flight north-west, 30 and 10 m/s, at 1 m/s down.

    The velocity is given as so many of a unit for each m/s.
    """
    times_s = np.arange(60 * RATE_HZ) / RATE_HZ
    fixes_s = np.arange(0.0, 60.0, 0.2)
    place = [math.radians(47.0), math.radians(8.0), 1_000.0]
    # The radius of the earth, to a third of a percent.
    rates = [30.0 / 6.371e6, -10.0 / (6.371e6 * math.cos(place[0])), -1.0]
    return {
        "gyroscope": (times_s, np.zeros((len(times_s), 3))),
        "accelerometer": (times_s, np.tile([0.0, 0.0, -9.81], (len(times_s), 1))),
        "gnss_position": (fixes_s, np.array(place) + np.outer(fixes_s, rates)),
        "gnss_velocity": (fixes_s, np.tile(np.multiply(velocity, unit), (len(fixes_s), 1))),
    }


FLIGHT = moving([30.0, -10.0, 1.0])
FIXES_S, PLACES = FLIGHT["gnss_position"]


@pytest.mark.filterwarnings("error")
def test_of_a_flight_nothing_is_said() -> None:
    fcc.navigate(**FLIGHT)


UNLIKELY: list[tuple[dict[str, Any], str]] = [
    ({"gyroscope": (TIMES_S * 12.5, GYROSCOPE[1])}, "0.25 s apart.*times are in s"),
    (
        FLIGHT | {"gnss_velocity": (FIXES_S * 3.0, FLIGHT["gnss_velocity"][1])},
        r"gnss_velocity: 102 of its 300 .* covers 0 to 179",
    ),
]


LATE_S = 0.6
"""More than `delays_s` may say."""


SPEED_MPS, GRAVITY_MPS2 = 30.0, 9.80665
TURNS_S = np.arange(0.0, 120.0, 0.02)
TURN_RATE = 0.15 * np.sin(TURNS_S / 6.0)
"""Coordinated turns at 30 m/s, in which the force points out of the floor."""
OTHER_RATE = 0.1 * np.sin(TURNS_S / 6.0) + 0.08 * np.sin(TURNS_S / 2.3)
"""Turns that do not repeat."""


def turns(late_s: float = 0.0, rate: Any = TURN_RATE) -> dict[str, Any]:
    heading = np.cumsum(rate) * 0.02
    roll = np.arctan(SPEED_MPS * rate / GRAVITY_MPS2)
    rates = np.array([np.gradient(roll, 0.02), rate * np.sin(roll), rate * np.cos(roll)])
    force = np.array([0.0 * roll, 0.0 * roll, -GRAVITY_MPS2 / np.cos(roll)])
    velocity = SPEED_MPS * np.array([np.cos(heading), np.sin(heading), 0.0 * heading])
    metres = np.cumsum(velocity, axis=1) * 0.02
    place = np.array([metres[0] / 6_367_000.0 + 0.8, metres[1] / 4_445_000.0 + 0.1, 0.0 * roll])
    fixes = slice(None, None, 10)
    return {
        "gyroscope": (TURNS_S, rates.T),
        "accelerometer": (TURNS_S, force.T),
        "gnss_position": (TURNS_S[fixes] + late_s, place.T[fixes]),
        "gnss_velocity": (TURNS_S[fixes] + late_s, velocity.T[fixes]),
    }


def test_it_is_found_by_how_much_fixes_are_late() -> None:
    found = fcc.navigate(**turns(LATE_S))
    assert found["gnss_late_s"][-1] == pytest.approx(LATE_S, abs=0.1)
    assert found["gnss_late_s_sigma"][-1] < 0.1
    roll = np.arctan(SPEED_MPS * TURN_RATE / GRAVITY_MPS2)
    error = (found["roll_rad"] - roll)[TURNS_S > 60.0]
    assert np.degrees(np.sqrt(np.mean(error**2))) < 1.0


GPS_LESS_UTC_S = 18.0
"""Since 2017."""


@pytest.mark.parametrize("source", ["gnss_position", "gnss_velocity"])
@pytest.mark.parametrize("late_s", [GPS_LESS_UTC_S, -GPS_LESS_UTC_S])
def test_a_receiver_of_another_clock_does_not_agree(source: str, late_s: float) -> None:
    sources = turns(0.0, OTHER_RATE)
    times_s, values = sources[source]
    found = fcc.navigate(**sources | {source: (times_s + late_s, values)})
    assert found["normalised_innovations"][source]["accepted"] < 0.5


def test_a_source_that_does_not_agree_shows_by_its_innovations() -> None:
    sources = turns()
    fixes_s, velocities = sources["gnss_velocity"]
    found = fcc.navigate(**sources | {"gnss_velocity": (fixes_s, velocities * [-1.0, 1.0, 1.0])})
    assert found["normalised_innovations"]["gnss_position"]["accepted"] < 0.5
    kmh = (TURNS_S, np.full_like(TURNS_S, 3.6 * SPEED_MPS))
    found = fcc.navigate(**sources, airspeed=kmh)
    assert found["normalised_innovations"]["airspeed"]["accepted"] < 0.5


def test_normalised_innovations_are_those_over_their_deviations() -> None:
    found = fcc.navigate(**turns())
    assert set(found["normalised_innovations"]) == {"gnss_position", "gnss_velocity"}
    for source, normalised in found["normalised_innovations"].items():
        of = found["innovations"][source]
        rms = np.sqrt(np.mean((of["difference"] / of["sigma"]) ** 2, axis=0))
        np.testing.assert_allclose(normalised["rms"], rms)
        assert normalised["accepted"] == pytest.approx(np.mean(of["accepted"]))


@pytest.mark.parametrize("shown", ["the last fix", "zeros"])
def test_what_a_receiver_shows_without_a_fix_is_left_out(shown: str) -> None:
    """5 s of it each 30 s cost the attitude, by 12 and 9 degrees RMS."""
    sources = turns()
    times_s = sources["gnss_position"][0]
    lost = (times_s % 30.0) > 25.0
    kept, spoilt = dict(sources), dict(sources)
    for name in ("gnss_position", "gnss_velocity"):
        values = sources[name][1]
        kept[name] = (times_s[~lost], values[~lost])
        last = np.maximum.accumulate(np.where(lost, 0, np.arange(len(times_s))))
        wrong = values[last] if shown == "the last fix" else np.where(lost[:, None], 0.0, values)
        spoilt[name] = (times_s, wrong)
    expected, found = fcc.navigate(**kept), fcc.navigate(**spoilt)
    np.testing.assert_array_equal(found["quaternion"], expected["quaternion"])


@pytest.mark.parametrize(("arguments", "words"), UNLIKELY)
def test_of_what_is_unlikely_it_warns(arguments: dict[str, Any], words: str) -> None:
    with pytest.warns(UserWarning, match=words):
        fcc.navigate(**arguments)


def later(by_s: float) -> dict[str, Any]:
    return {"gyroscope": GYROSCOPE, "magnetometer": (TIMES_S + by_s, still(FIELD_UT)[1])}


WRONG: list[tuple[dict[str, Any], str]] = [
    ({}, "neither gyroscope nor accelerometer"),
    ({"gyroscope": 3.0}, "gyroscope: it is no tuple"),
    ({"gyroscope": (TIMES_S, np.zeros((3, 3)))}, r"gyroscope: it has 400 times.*\(3, 3\)"),
    ({"gyroscope": (TIMES_S, GYROSCOPE[1].T)}, r"\(3, 400\) \(are they transposed"),
    ({"gyroscope": (TIMES_S * 1e3, GYROSCOPE[1])}, "20.* s apart.*times are in s"),
    (later(1000.0), r"1100 to 1107.98 s, the gyroscope 100 to 107.98 s"),
    (later(-1000.0), r"magnetometer: 0 of its 400 .* one clock"),
    ({"gyroscope": (np.ma.array(TIMES_S, mask=True), GYROSCOPE[1])}, "all its samples are masked"),
    ({"gyroscope": (TIMES_S[::-1], GYROSCOPE[1])}, "must not decrease"),
    (
        {"gyroscope": (np.float32(1.7e9 + TIMES_S), GYROSCOPE[1])},
        "gyroscope: most of its times are equal.*float64",
    ),
    (
        {"gyroscope": (np.append(TIMES_S, 1e300), np.vstack([GYROSCOPE[1], [np.nan] * 3]))},
        "gyroscope: times are from 100 s to 1e300 s",
    ),
    ({"gyroscope": (TIMES_S, GYROSCOPE[1] + 400.0)}, "in rad/s"),
    ({"gyroscope": GYROSCOPE, "gnss_position": still([47.0, 8.0, 1.0])}, "in rad"),
    ({"gyroscope": GYROSCOPE, "static_pressure": (TIMES_S, TIMES_S)}, "in Pa"),
    ({"gyroscope": GYROSCOPE, "static_pressure": (TIMES_S, 0 * TIMES_S + 1013.25)}, "in Pa"),
    ({"gyroscope": GYROSCOPE, "delays_s": {"radar": 0.1}}, "radar"),
    ({"gyroscope": GYROSCOPE, "delays_s": {"airspeed": 210.0}}, "0 to 0.5"),
    ({"gyroscope": GYROSCOPE, "mounting": np.eye(3) * 2}, "no rotation"),
    ({"gyroscope": GYROSCOPE, "year": 2013.0}, "2020"),
]


@pytest.mark.parametrize(("arguments", "words"), WRONG)
def test_a_wrong_argument_is_named(arguments: dict[str, Any], words: str) -> None:
    with pytest.raises((ValueError, TypeError), match=words):
        fcc.navigate(**arguments)
