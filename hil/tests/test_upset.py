"""Recovery from upsets: JSBSim's Cessna in lockstep, its controls taken and given back."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import edge_sensors
import fcc
import pytest
from upset_flights import (
    HOLD,
    ROUGH,
    Conditions,
    Recovery,
    Script,
    fly,
    full_aileron,
    full_aileron_by_a_pilot,
    stall_with_full_rudder,
    to_attitude,
    wake_vortex,
)

from fcc_hil.lockstep import measurements
from fcc_hil.plant import Plant
from fcc_hil.units import FT_TO_M, KT_TO_MPS

NEVER_EXCEED_KT = 158.0
"""Cessna 172P, pilot's operating handbook, section 2."""
LIMIT_LOAD = 3.8
"""The same, flaps up."""
SEED = 1
"""Of the errors of the sensors in a spin, which are calibrated as a user does it."""


def _flown_on(flown: Recovery) -> None:
    """Assert that it is on its heading, and at its altitude or climbing to it, and said so."""
    assert flown.state == "engaged"
    assert flown.end is not None
    off_deg = (math.degrees(flown.end.heading_rad) - 90.0 + 180.0) % 360.0 - 180.0
    assert abs(off_deg) < 5.0
    assert abs(math.degrees(flown.end.roll_rad)) < 10.0
    off_ft = flown.end.altitude_m / FT_TO_M - flown.before_ft
    assert abs(off_ft) < 60.0 or (off_ft < 0.0 and flown.end.down_mps < -2.0)
    told = [event.split(" ", 1)[1] for event in flown.events]
    assert told.count("now: recovering from an upset") == 1
    assert told.count("no longer: recovering from an upset") == 1


def _within_limits(flown: Recovery, most_lost_ft: float) -> None:
    assert flown.lost_ft < most_lost_ft
    assert flown.before_ft - flown.least_ft < most_lost_ft + 400.0, "with what the script lost"
    assert flown.greatest_kt < NEVER_EXCEED_KT
    assert flown.least_load > 0.0
    assert flown.greatest_load < LIMIT_LOAD


@pytest.mark.parametrize("conditions", [Conditions(), ROUGH], ids=["exact", "rough"])
@pytest.mark.parametrize("for_s", [2.5, 2.75, 3.0, 3.25, 3.5])
@pytest.mark.parametrize("script", [full_aileron, full_aileron_by_a_pilot])
def test_full_aileron_for_seconds(
    script: Callable[[float], Script], for_s: float, conditions: Conditions
) -> None:
    flown = fly(script(for_s), conditions)
    assert abs(math.degrees(flown.begin.roll_rad)) > 70.0
    assert flown.before_ft - flown.least_ft < 600.0
    _within_limits(flown, 600.0)
    _flown_on(flown)


@pytest.mark.fault(
    "The aircraft",
    "upset, spin",
    "[limits](envelope.md#upset-recovery)",
    "immediately; stall 0.6 s, spin 0.1 s",
    "recovery; events at begin and end",
)
@pytest.mark.parametrize(
    ("script", "most_lost_ft"),
    [
        pytest.param(to_attitude(179.0, None, throttle=0.65), 450.0, id="inverted"),
        pytest.param(to_attitude(90.0, None, throttle=0.65), 100.0, id="knife edge"),
        pytest.param(to_attitude(70.0, -25.0, throttle=0.8), 200.0, id="spiral"),
        pytest.param(to_attitude(0.0, 70.0, 50.0, throttle=1.0), 450.0, id="nose up at 50 kt"),
        pytest.param(to_attitude(0.0, -60.0, throttle=0.0), 500.0, id="nose down at 120 kt"),
        pytest.param(stall_with_full_rudder(3.0), 500.0, id="stalled, full rudder for 3 s"),
    ],
)
def test_upsets_are_recovered_from(script: Script, most_lost_ft: float) -> None:
    flown = fly(script, ROUGH)
    _within_limits(flown, most_lost_ft)
    _flown_on(flown)


@pytest.mark.parametrize(
    "aircraft", [pytest.param("c172x", marks=edge_sensors.beyond_a_phone), "c182", "c172r"]
)
def test_other_aircraft_stay_within_the_limit_load(aircraft: str) -> None:
    """The limit load is the airworthiness rules'; the script pushes at up to -1 g."""
    dive = to_attitude(0.0, -60.0, throttle=0.0)
    flown = fly(dive, replace(ROUGH, aircraft=aircraft), 10.0)
    assert flown.greatest_load < LIMIT_LOAD
    assert flown.lost_ft < 500.0
    assert flown.greatest_kt < NEVER_EXCEED_KT


@edge_sensors.measured
@pytest.mark.parametrize("missing", ["heading", "airspeed", "altitude", "attitude", "body_rates"])
def test_a_failsafe_recovers_as_well(missing: str) -> None:
    """Of attitude and body rates one takes the other's place; before, the wings were levelled."""
    flown = fly(full_aileron(3.0), replace(ROUGH, missing=(missing,)))
    assert flown.state.startswith("failsafe")
    _within_limits(flown, 900.0)
    assert flown.end is not None
    assert abs(math.degrees(flown.end.roll_rad)) < 10.0
    said = [event.split(" ", 1)[1] for event in flown.events]
    assert "now: recovering from an upset" in said
    assert "no longer: recovering from an upset" in said


@pytest.mark.parametrize(("turns", "rudder"), [(1.0, 1.0), (3.0, -1.0), (6.0, 1.0)])
def test_a_spin_is_recovered_from(turns: float, rudder: float) -> None:
    """The built-in aircraft, with noisy sensors, is engaged in a spin that was held for a while.

    14 CFR 23.221 (before 2017) allows one more turn; Cessna gives up to 1,000 ft for a spin of one
    turn and its recovery. The height counts to the end of the flight, when it is back at its
    altitude.
    """
    begin = f"[built-in]\naltitude_ft = 8000.0\nairspeed_kt = 75.0\nseed = {SEED}\n"
    if edge_sensors.SENSORS:
        begin += f'raw_sensors = "{edge_sensors.SENSORS}"\n'
    aircraft = fcc.BuiltInAircraft(begin)
    calibration = edge_sensors.conditions(SEED).calibration
    machine = edge_sensors.machine(HOLD + "[engage]\npermit_upset = true\n")
    level_ticks = round((edge_sensors.STANDBY_S + 1.0) / machine.period_s)
    controls, measured = aircraft.controls, aircraft.step(None)
    turned = held_turns = recovered_turns = 0.0
    stalled, low_m, begin_m = False, math.inf, 0.0
    loads: list[float] = []
    heading = aircraft.truth.heading_rad
    for tick in range(4_000 + level_ticks):
        truth = aircraft.truth
        turned += math.remainder(truth.heading_rad - heading, math.tau) / math.tau
        heading = truth.heading_rad
        if not held_turns and stalled and abs(turned) >= turns:
            held_turns, begin_m = abs(turned), truth.altitude_m
        stand = aircraft.controls
        surfaces = machine.step(
            measured,
            readback=(stand.throttle, stand.elevator, stand.aileron, stand.rudder),
            switch=held_turns > 0.0,
        )
        if surfaces is not None:
            controls = surfaces
        elif stalled:
            controls = fcc.Surfaces(elevator=1.0, rudder=rudder)
        elif tick > level_ticks:
            level = -0.8 * truth.roll_rad - 0.4 * truth.roll_rate_radps
            up = min(1.0, 0.00175 * (tick - level_ticks))
            controls = fcc.Surfaces(elevator=up, aileron=max(-1.0, min(1.0, level)))
            stalled = truth.angle_of_attack_rad > math.radians(17.0)
        if held_turns:
            loads.append(-truth.specific_force_z_mps2 / 9.80665)
            low_m = min(low_m, truth.altitude_m)
            if abs(truth.yaw_rate_radps) > math.radians(20.0):
                recovered_turns = abs(turned) - held_turns
        measured = aircraft.step(controls)
        if calibration is not None:
            calibration.apply(measured)
    assert held_turns
    assert recovered_turns < 1.0
    assert (begin_m - low_m) / FT_TO_M < 700.0
    assert max(loads) < LIMIT_LOAD
    assert min(loads) > 0.0
    assert machine.state == "engaged"
    assert abs(math.degrees(aircraft.truth.roll_rad)) < 10.0
    assert abs(aircraft.truth.altitude_m - begin_m) / FT_TO_M < 60.0, "it has climbed back"
    said = [event.text for event in machine.events()]
    assert "now: recovering from an upset" in said


def test_a_wake_vortex() -> None:
    flown = fly(wake_vortex, ROUGH, 15.0)
    assert abs(math.degrees(flown.begin.roll_rad)) > 45.0
    assert flown.lost_ft < 30.0
    assert flown.least_load > 0.0
    assert flown.greatest_load < 2.0
    assert flown.state == "engaged"


@pytest.mark.parametrize("permitted", [False, True])
def test_it_engages_in_an_upset_only_if_permitted(permitted: bool) -> None:
    plant = Plant("c172p")
    machine = fcc.Machine(HOLD + f"[engage]\npermit_upset = {str(permitted).lower()}\n")
    script = to_attitude(90.0, None, throttle=0.65)
    for _ in range(80):
        machine.step(measurements(plant.state()), switch=False)
        plant.step(3)
    began_s = plant.time_s
    while (taken := script(plant.time_s - began_s, plant.state(), plant.trim)) is not None:
        plant.write(taken)
        plant.step(3)
        machine.step(measurements(plant.state()), switch=False)
    for _ in range(2):  # two readings agree
        surfaces = machine.step(measurements(plant.state()), switch=True)
    assert machine.state == ("engaged" if permitted else "standby")
    if surfaces is None:
        assert machine.engage_inhibits == ["bank or pitch is beyond 60 degrees, or it spins"]
        return
    assert surfaces.aileron < -0.5, "the shorter way"
    for _ in range(400):
        surfaces = machine.step(measurements(plant.state()), switch=True)
        assert surfaces is not None
        plant.write(
            replace(
                plant.trim,
                elevator=surfaces.elevator,
                aileron=surfaces.aileron,
                rudder=surfaces.rudder,
                throttle=surfaces.throttle,
            )
        )
        plant.step(3)
    state = plant.state()
    assert abs(math.degrees(state.roll_rad)) < 5.0
    assert 90.0 < state.airspeed_mps / KT_TO_MPS < 115.0
