"""Raw sensors that fail while the pattern is flown by them alone."""

from __future__ import annotations

import math
from collections.abc import Callable

import fcc
import numpy as np
import pytest
from first_of import first_of

from fcc_hil.lockstep_rig import Conditions, LockstepRig
from fcc_hil.plant import Plant, Weather
from fcc_hil.raw_calibration import calibrate
from fcc_hil.raw_faults import Fault, lost, repeated
from fcc_hil.raw_sensors import FIELD_UT, READINGS
from fcc_hil.standin import Settings

SEED = 33
TICK_S = 0.025
ENGAGED_S = 20.0
FAILS_S = 60.0
END_S = 150.0
EARTH_M = 6_371_009.0
MEASURED = frozenset(
    {"attitude", "heading", "body_rates", "specific_force", "airspeed", "altitude"}
)


def compass_turned(by_deg: float) -> Fault:
    sine, cosine = math.sin(math.radians(by_deg)), math.cos(math.radians(by_deg))

    def fault(values: fcc.Measurements) -> None:
        x, y = values.magnetic_field_x_ut, values.magnetic_field_y_ut
        values.magnetic_field_x_ut = cosine * x - sine * y
        values.magnetic_field_y_ut = sine * x + cosine * y

    return fault


def place_off(north_m: float) -> Fault:
    def fault(values: fcc.Measurements) -> None:
        values.gnss_latitude_rad += north_m / EARTH_M

    return fault


def climbs_more(mps: float) -> Fault:
    """Return a receiver whose altitude and vertical velocity drift together."""
    drifted_m = 0.0

    def fault(values: fcc.Measurements) -> None:
        nonlocal drifted_m
        drifted_m += mps * TICK_S
        values.gnss_position_altitude_m += drifted_m
        values.gnss_down_mps -= mps

    return fault


def velocity_repeated() -> Fault:
    """Return a receiver that repeats its velocity, and not its position."""
    names = ("gnss_north_mps", "gnss_east_mps", "gnss_down_mps")
    kept: dict[str, float] = {}

    def fault(values: fcc.Measurements) -> None:
        for name in names:
            value = getattr(values, name)
            if not math.isnan(value):
                setattr(values, name, kept.setdefault(name, value))

    return fault


def velocity_swapped(values: fcc.Measurements) -> None:
    values.gnss_north_mps, values.gnss_east_mps = values.gnss_east_mps, values.gnss_north_mps


Axes = list[float]


def gyroscope(wrong: Callable[[Axes], Axes]) -> Fault:
    names = READINGS["raw_body_rates"]

    def fault(values: fcc.Measurements) -> None:
        for name, value in zip(names, wrong([getattr(values, n) for n in names]), strict=True):
            setattr(values, name, value)

    return fault


def clipped_at(degps: float) -> Callable[[Axes], Axes]:
    most = math.radians(degps)
    return lambda rates: [max(-most, min(most, rate)) for rate in rates]


def frozen_with_noise(**sigmas: float) -> Fault:
    """Return readings that stay where they are, but for white noise of these sigmas."""
    noise = np.random.default_rng(SEED)
    repeat = {reading: repeated(reading) for reading in sigmas}

    def fault(values: fcc.Measurements) -> None:
        for reading, sigma in sigmas.items():
            repeat[reading](values)
            for name in READINGS[reading]:
                setattr(values, name, getattr(values, name) + noise.normal(0.0, sigma))

    return fault


def hit(name: str, value: float) -> Fault:
    """Return one value as a bus under interference gives it."""
    return lambda values: setattr(values, name, value)


def bits_flipped(share: float) -> Fault:
    """Return random values of the sensors' ranges in the place of some, as of flipped bits."""
    noise = np.random.default_rng(SEED)
    ranges = {"raw_body_rates": math.radians(2000.0), "raw_specific_force": 16.0 * 9.81}

    def fault(values: fcc.Measurements) -> None:
        for reading, most in ranges.items():
            for name in READINGS[reading]:
                if noise.random() < share:
                    setattr(values, name, noise.uniform(-most, most))

    return fault


def fly(
    fault: Fault, for_s: float, seed: int = SEED
) -> tuple[fcc.Machine, LockstepRig, dict[str, float]]:
    """Fly by the sensors of a board; return the largest errors, in deg, and the extremes.

    `held` is the largest bank while control is held, `altitude` by how much more its error, in
    m, is than before the fault.
    """
    weather = Weather(wind_from_deg=230.0, wind_kt=20.0, turbulence_severity=3)
    plant = Plant("c172p", seed=seed, weather=weather, latitude_deg=45.0)
    north, east, down = FIELD_UT
    machine = fcc.Machine(
        '[guidance]\nmode = "timed-pattern"\n[navigation]\nmethod = "kalman"\n'
        f"magnetic_field_ut = [{north}, {east}, {down}]\n"
    )

    def falsify(values: fcc.Measurements, time_s: float) -> None:
        if FAILS_S <= time_s < FAILS_S + for_s:
            fault(values)

    conditions = Conditions(
        raw_sensors="board",
        calibration=calibrate("board", seed, FIELD_UT),
        raw_fault=falsify,
        without=MEASURED,
    )
    rig = LockstepRig(Settings(aircraft="c172p", seed=seed), plant, machine, conditions)
    rows: list[tuple[float, ...]] = []

    def keep() -> bool:
        state, found = plant.state(), machine.estimate
        errors = (
            found.roll_rad - state.roll_rad,
            found.pitch_rad - state.pitch_rad,
            found.heading_rad - state.heading_rad,
        )
        wrapped = (abs(math.degrees(math.remainder(error, math.tau))) for error in errors)
        bank_deg = abs(math.degrees(state.roll_rad))
        held_deg = bank_deg if machine.holds_control else 0.0
        shown_m = found.altitude_m - state.altitude_m
        rows.append((plant.time_s, *wrapped, bank_deg, held_deg, shown_m, state.height_m))
        return False

    rig.fly_to(ENGAGED_S)
    rig.set_switch(on=True)
    rig.fly_to(END_S, keep)
    table = np.array(rows)
    failing = table[table[:, 0] >= FAILS_S]
    names = ("roll", "pitch", "heading", "bank", "held")
    most = dict(zip(names, failing[:, 1:6].max(axis=0), strict=True))
    shown_m = failing[:, 6] - failing[0, 6]
    off_m = float(np.abs(shown_m).max())
    return machine, rig, {**most, "altitude": off_m, "height": float(failing[:, 7].min())}


@pytest.mark.parametrize(
    ("fault", "for_s"),
    [
        (lost("gnss"), 60.0),
        (repeated("gnss"), 60.0),
        (velocity_repeated(), 90.0),
        (place_off(600.0), 0.5),
        (lost("magnetic_field"), 90.0),
        (repeated("magnetic_field"), 60.0),
        (frozen_with_noise(magnetic_field=0.3), 90.0),
    ],
    ids=[
        "no receiver",
        "receiver repeats",
        "receiver repeats its velocity",
        "receiver 600 m off",
        "no compass",
        "compass repeats",
        "compass frozen with noise",
    ],
)
def test_it_is_flown_on(fault: Fault, for_s: float) -> None:
    machine, _, most = fly(fault, for_s)
    assert machine.state == "engaged"
    assert most["heading"] <= 5.0
    assert most["roll"] <= 3.0
    assert most["pitch"] <= 3.0
    assert most["bank"] <= 45.0


@pytest.mark.fault(
    "Sensors",
    "raw inertial sensor: one bad reading, 0.3 % random",
    "[outliers](raw-sensors.md#flown-by); two in a row at most",
    "",
    "ignored",
)
@pytest.mark.parametrize(
    ("fault", "for_s"),
    [
        (hit("raw_roll_rate_radps", 10.0), TICK_S),
        (hit("raw_pitch_rate_radps", 10.0), TICK_S),
        (bits_flipped(0.003), 60.0),
    ],
    ids=["roll", "pitch", "0.3 %"],
)
def test_readings_that_no_aircraft_makes_are_flown_through(fault: Fault, for_s: float) -> None:
    machine, rig, most = fly(fault, for_s)
    assert machine.state == "engaged"
    assert not [event.text for event in rig.events if event.time_s > FAILS_S]
    assert most["roll"] <= 3.0
    assert most["pitch"] <= 3.0
    assert most["bank"] <= 45.0


@pytest.mark.parametrize("seed", first_of(31, 33, 34, 36))
def test_a_compass_that_is_turned_is_no_evidence_against_gyroscopes(seed: int) -> None:
    """With a receiver it is flown on: a turned field errs by no more than the aircraft turns."""
    machine, rig, most = fly(compass_turned(30.0), 90.0, seed)
    assert machine.state == "engaged"
    assert not any("gyroscope" in event.text for event in rig.events)
    assert most["heading"] <= 5.0
    assert most["bank"] <= 45.0


@pytest.mark.parametrize("mps", [3.0, 1.0, -2.0])
def test_a_receiver_that_drifts_in_height_costs_no_altitude(mps: float) -> None:
    """An altimeter that were excluded for it would be flown 90 m off at least."""
    machine, rig, most = fly(climbs_more(mps), 90.0)
    texts = [event.text for event in rig.events]
    assert machine.state == "engaged"
    assert not any("altitude contradicts the other sensors" in text for text in texts)
    assert most["altitude"] <= 10.0


def test_a_receiver_without_a_vertical_velocity_costs_no_altitude() -> None:
    """It gave always 0; the altimeter was doubted for it, and 300 to 900 m were lost."""

    def no_vertical(values: fcc.Measurements) -> None:
        if not math.isnan(values.gnss_down_mps):
            values.gnss_down_mps = 0.0

    machine, rig, most = fly(no_vertical, 90.0)
    assert machine.state == "engaged"
    assert not [event.text for event in rig.events if event.time_s > FAILS_S]
    assert most["altitude"] <= 10.0


@pytest.mark.parametrize("seed", first_of(33, 35))
def test_zeros_of_a_bus_that_does_not_answer_are_no_samples(seed: int) -> None:
    def zeros(values: fcc.Measurements) -> None:
        for name in READINGS["raw_body_rates"] + READINGS["raw_specific_force"]:
            setattr(values, name, 0.0)
        for name in READINGS["magnetic_field"]:
            setattr(values, name, 0.0)
        values.static_pressure_pa = values.differential_pressure_pa = 0.0

    machine, _, most = fly(zeros, 2.0, seed)
    assert machine.state == "engaged"
    assert most["bank"] <= 50.0


def test_a_velocity_that_is_not_that_of_its_positions_is_not_used() -> None:
    machine, rig, most = fly(velocity_swapped, 60.0)
    said = [event for event in rig.events if "satellite receiver's velocity" in event.text]
    assert machine.state == "engaged"
    assert [event.text.endswith("is not used") for event in said] == [True, False]
    assert FAILS_S < said[0].time_s <= FAILS_S + 10.0
    assert most["roll"] <= 3.0
    assert most["pitch"] <= 3.0
    assert most["heading"] <= 5.0
    assert most["bank"] <= 45.0


@pytest.mark.parametrize(
    ("fault", "named"),
    [
        (repeated("gnss"), "satellite navigation repeats its position in motion and is not used"),
        (repeated("magnetic_field"), "magnetometer repeats its field in motion and is not used"),
    ],
    ids=["receiver", "compass"],
)
def test_what_repeats_itself_is_named(fault: Fault, named: str) -> None:
    """Though it is flown on; and not any more once it measures again."""
    _, rig, _ = fly(fault, 30.0)
    begins, *_, ends = (event for event in rig.events if named in event.text)
    assert begins.text.startswith("now: ")
    assert FAILS_S < begins.time_s <= FAILS_S + 3.0
    assert ends.text.startswith("no longer: ")
    assert FAILS_S + 30.0 <= ends.time_s <= FAILS_S + 31.0


@pytest.mark.parametrize(
    ("fault", "for_s"),
    [
        (lost(*READINGS), 0.5),
        (lost("raw_body_rates"), 1.0),
        (lost("raw_body_rates", "raw_specific_force"), 2.0),
        (lost("raw_specific_force"), 10.0),
        (repeated("raw_specific_force"), 20.0),
        (lost("static_pressure"), 5.0),
        (repeated("differential_pressure"), 30.0),
    ],
    ids=[
        "nothing",
        "no gyroscope",
        "no inertial unit",
        "no accelerometer",
        "accelerometer repeats",
        "no barometer",
        "pitot tube repeats",
    ],
)
def test_what_returns_is_flown_with_again(fault: Fault, for_s: float) -> None:
    machine, rig, most = fly(fault, for_s)
    assert machine.state == "engaged"
    assert any("failsafe cleared" in event.text for event in rig.events)
    assert most["bank"] <= 60.0
    assert most["height"] >= 500.0


@pytest.mark.parametrize("fault", [lost("raw_body_rates"), repeated("raw_body_rates")])
def test_without_its_only_gyroscope_control_is_given_back(fault: Fault) -> None:
    """Before the aircraft is lost: a gyroscope that repeats itself is noticed."""
    machine, rig, most = fly(fault, 90.0)
    assert machine.state == "standby"
    (released,) = (event for event in rig.events if event.text == "failsafe -> standby")
    assert released.time_s == pytest.approx(FAILS_S + 5.5, abs=1.0)
    assert most["height"] >= 500.0


@pytest.mark.fault(
    "Sensors",
    "raw gyroscope inverted, stuck, clipped, swapped, late, frozen with noise",
    "[magnetic field](navigation.md#gyroscopes-against-the-magnetic-field)",
    "mostly 0.4 to 2 s",
    "failsafe, then given back",
)
@pytest.mark.parametrize(
    "fault",
    [
        gyroscope(lambda rates: [-rates[0], *rates[1:]]),
        gyroscope(lambda rates: [0.0, *rates[1:]]),
        gyroscope(clipped_at(4.0)),
        frozen_with_noise(raw_body_rates=0.003, raw_specific_force=0.05),
    ],
    ids=["inverted roll", "roll stuck", "clipped", "inertial unit frozen with noise"],
)
def test_a_gyroscope_that_is_wrong_is_found_by_the_magnetic_field(fault: Fault) -> None:
    """Wings level when control is given back: the field takes its place."""
    machine, rig, most = fly(fault, 90.0)
    assert machine.state == "standby"
    named = "gyroscope contradicts the magnetic field and is not used"
    found = next(event for event in rig.events if named in event.text)
    (released,) = (event for event in rig.events if event.text == "failsafe -> standby")
    assert found.time_s - FAILS_S <= 20.0
    assert released.time_s - found.time_s == pytest.approx(5.0, abs=0.1)
    assert most["held"] <= 60.0
    assert most["height"] >= 500.0
