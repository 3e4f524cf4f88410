"""The plant: trimmed flight stays, signs are the project's, seeds repeat."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from fcc_hil.aircraft import AIRCRAFT, by_name
from fcc_hil.plant import Plant, Weather
from fcc_hil.state import Controls
from fcc_hil.units import FT_TO_M, KT_TO_MPS


@pytest.mark.parametrize("name", list(AIRCRAFT))
def test_set_up_flight_stays_where_it_was_set_up(name: str) -> None:
    plant = Plant(name)
    aircraft = by_name(name)
    plant.step(10 * 120)
    state = plant.state()
    assert state.airspeed_mps / KT_TO_MPS == pytest.approx(aircraft.airspeed_kt, abs=5.0)
    assert state.elevation_m / FT_TO_M == pytest.approx(aircraft.altitude_ft, abs=60.0)
    assert math.degrees(state.roll_rad) == pytest.approx(0.0, abs=2.0)
    assert plant.trimmed_by_jsbsim == aircraft.trims


def test_trim_survives_the_first_write() -> None:
    # c172x needs 7 % aileron for level wings: wiped out, it rolls off in seconds.
    plant = Plant("c172x")
    plant.write(plant.trim)
    plant.step(20 * 120)
    assert math.degrees(plant.state().roll_rad) == pytest.approx(0.0, abs=0.5)


@pytest.mark.parametrize(
    ("surface", "rate"),
    [
        ("elevator", "pitch_rate_radps"),
        ("aileron", "roll_rate_radps"),
        ("rudder", "yaw_rate_radps"),
    ],
)
@pytest.mark.parametrize("deflection", [-0.1, 0.1])
def test_positive_deflection_turns_the_positive_way(
    surface: str, rate: str, deflection: float
) -> None:
    plant = Plant("c172p")
    controls = Controls(throttle=plant.trim.throttle)
    setattr(controls, surface, deflection)
    plant.write(controls)
    plant.step(60)
    assert math.copysign(1.0, deflection) * getattr(plant.state(), rate) > 0.02


def test_specific_force_is_one_g_in_level_flight() -> None:
    state = Plant("c172p").state()
    assert state.specific_force_z_mps2 == pytest.approx(-9.8, abs=0.05)
    assert state.specific_force_y_mps2 == pytest.approx(0.0, abs=0.05)


def test_atmosphere_is_the_standard_one() -> None:
    # ICAO Doc 7488: 3,000 ft is 90,812 Pa and 9.056 deg C.
    state = Plant("c172p").state()
    assert state.pressure_pa == pytest.approx(90_812, abs=30)
    assert state.temperature_k - 273.15 == pytest.approx(9.056, abs=0.05)


def test_wind_blows_from_its_direction() -> None:
    plant = Plant("c172p", heading_deg=30.0, weather=Weather(wind_from_deg=270.0, wind_kt=20.0))
    plant.step(5 * 120)
    state = plant.state()
    assert state.airspeed_mps / KT_TO_MPS == pytest.approx(100.0, abs=0.1)
    assert math.degrees(state.heading_rad) == pytest.approx(30.0, abs=0.1)
    assert math.degrees(state.sideslip_rad) == pytest.approx(0.0, abs=0.1)
    # The wind triangle.
    assert state.east_mps == pytest.approx(
        state.true_airspeed_mps * math.sin(state.heading_rad) + 20.0 * KT_TO_MPS, abs=0.1
    )
    assert state.wind_east_mps / KT_TO_MPS == pytest.approx(20.0, abs=0.01)
    assert state.wind_north_mps == pytest.approx(0.0, abs=0.01)


def _gusty_flight(seed: int) -> list[float]:
    plant = Plant("c172p", seed=seed, weather=Weather(turbulence_severity=3))
    trace = []
    for _ in range(200):
        plant.step(3)
        trace.append(plant.state().airspeed_mps)
    return trace


def test_a_seed_repeats_to_the_last_bit_and_another_differs() -> None:
    first = _gusty_flight(seed=7)
    assert first == _gusty_flight(seed=7)
    assert first != _gusty_flight(seed=8)


def test_unknown_aircraft_is_refused_with_the_names_there_are() -> None:
    with pytest.raises(ValueError, match=r"no aircraft 'c172q'.*c172p"):
        Plant("c172q")


def test_controls_are_clipped_to_their_range() -> None:
    plant = Plant("c172p")
    plant.write(Controls(elevator=2.0, aileron=-3.0, rudder=1.5, throttle=-0.5, elevator_trim=-1.5))
    limits = Controls(elevator=1.0, aileron=-1.0, rudder=1.0, throttle=0.0, elevator_trim=-1.0)
    assert plant.controls == limits


def test_a_gear_that_is_not_written_stays_where_it_is() -> None:
    plant = Plant("c172p")
    for written, commanded in ((None, 1.0), (0.0, 0.0), (None, 0.0), (1.0, 1.0)):
        plant.write(Controls(gear=written))
        assert plant.fdm["gear/gear-cmd-norm"] == commanded


def test_a_trim_that_is_not_written_stays_where_it_is() -> None:
    plant = Plant("c172p")
    trimmed = plant.controls.elevator_trim
    assert trimmed is not None
    plant.write(Controls(elevator=0.1))
    assert plant.controls.elevator_trim == trimmed


@pytest.mark.parametrize("name", ["c172x", "global5000"])
def test_no_log_files_are_left_behind(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # Both models come with a log file that JSBSim opens in the working folder.
    monkeypatch.chdir(tmp_path)
    Plant(name).step(120)
    assert list(tmp_path.iterdir()) == []
