"""The autopilot on JSBSim's flight model, compared with limits.

One set of gains, the daemon's defaults, flies both Cessnas. The seeds are not those
on which the gains were found.
"""

from __future__ import annotations

from dataclasses import replace

import fcc
import numpy as np
import pytest

from fcc_hil.lockstep import Scenario, fly, measurements
from fcc_hil.pattern import TimedPattern
from fcc_hil.plant import Plant, Weather
from fcc_hil.score import LegScore
from fcc_hil.suite.matrix import TUNING_SEEDS

SEED = 2012
AIRCRAFT = ("c172p", "c172x")


def test_the_seed_was_not_used_in_tuning() -> None:
    assert SEED not in TUNING_SEEDS


def _hold(worst: LegScore, **limits: float) -> None:
    """Assert that no figure is missing or beyond its limit."""
    figures = dict(worst)
    for name, limit in limits.items():
        value = figures[name]
        assert isinstance(value, float), f"{name}: some leg never settles"
        assert value <= limit, f"{name}: {value:.2f} is beyond {limit}"


@pytest.mark.parametrize("aircraft", AIRCRAFT)
def test_calm(aircraft: str) -> None:
    flown, _ = fly(Scenario(aircraft=aircraft, seed=SEED))
    _hold(
        flown["worst"],
        heading_settle_s=17.0,
        heading_overshoot_deg=1.5,
        altitude_settle_s=12.0,
        altitude_overshoot_ft=4.0,
        altitude_rms_ft=2.0,
        airspeed_error_kt=5.0,
        lateral_acceleration_g=0.05,
    )


@pytest.mark.parametrize("delay_ticks", [1, 4])
@pytest.mark.parametrize("aircraft", AIRCRAFT)
def test_noisy_and_late_sensors(aircraft: str, delay_ticks: int) -> None:
    flown, _ = fly(Scenario(aircraft=aircraft, seed=SEED, noise=True, delay_ticks=delay_ticks))
    _hold(
        flown["worst"],
        heading_settle_s=17.0,
        heading_overshoot_deg=1.5,
        altitude_settle_s=12.0,
        altitude_overshoot_ft=4.0,
        altitude_rms_ft=2.0,
        airspeed_error_kt=6.0,
    )


@pytest.mark.parametrize("aircraft", AIRCRAFT)
def test_turbulence(aircraft: str) -> None:
    weather = Weather(turbulence_severity=3)
    scenario = Scenario(aircraft=aircraft, seed=SEED, noise=True, delay_ticks=1, weather=weather)
    flown, truth = fly(scenario)
    settled = [leg for leg in flown["legs"] if leg["heading_settle_s"] is not None]
    assert len(settled) >= 0.75 * len(flown["legs"])
    assert np.mean([leg["altitude_rms_ft"] for leg in flown["legs"]]) <= 4.7
    assert np.max(np.abs(truth["roll_deg"])) < 45.0


@pytest.mark.parametrize("wind_from_deg", [0.0, 90.0, 180.0, 270.0])
def test_wind_has_no_effect_on_heading_and_airspeed(wind_from_deg: float) -> None:
    weather = Weather(wind_from_deg=wind_from_deg, wind_kt=10.0)
    flown, _ = fly(Scenario(seed=SEED, legs=2, weather=weather))
    _hold(flown["worst"], heading_settle_s=17.0, altitude_rms_ft=2.0, airspeed_error_kt=5.0)


def test_turns_that_accumulate_past_half_a_circle_are_not_reversed() -> None:
    """At 20 degrees of bank a 90-degree leg of 20 s cannot be finished."""
    config = "[autopilot.envelope]\nmax_bank_deg = 20.0\n"
    _, truth = fly(Scenario(seed=SEED, config=config))
    turned = np.unwrap(np.radians(truth["heading_deg"]))
    after_first_turn = turned[truth["time_s"] > truth["time_s"][0] + 25.0]
    assert np.min(np.diff(after_first_turn)) > -1e-3
    assert np.max(np.abs(truth["roll_deg"])) < 23.0


@pytest.mark.parametrize(("roll_deg", "climb_fpm"), [(25.0, 0.0), (-15.0, 0.0), (0.0, 600.0)])
def test_it_engages_in_a_turn_and_in_a_climb(roll_deg: float, climb_fpm: float) -> None:
    """It is flown into the manoeuvre by an autopilot of its own, then taken over by a second."""
    plant = Plant("c172p", seed=SEED)
    first = fcc.Autopilot('[guidance]\nmode = "hold"\n')
    for _ in range(200):
        first.observe(measurements(plant.state()))
        plant.step(3)
    first.engage(measurements(plant.state()), throttle=plant.controls.throttle)
    start = plant.state()
    if roll_deg:
        first.command(heading_rad=start.heading_rad + np.copysign(3.0, roll_deg))
    if climb_fpm:
        first.command(altitude_m=start.altitude_m + 300.0)
    second = fcc.Autopilot('[guidance]\nmode = "hold"\n')
    surfaces = None
    for _ in range(240):
        state = plant.state()
        second.observe(measurements(state))
        surfaces = first.step(measurements(state))
        plant.write(
            replace(
                plant.controls,
                elevator=surfaces.elevator,
                aileron=surfaces.aileron,
                rudder=surfaces.rudder,
                throttle=surfaces.throttle,
            )
        )
        plant.step(3)
    assert surfaces is not None
    before = plant.state()
    assert abs(before.roll_rad) > np.radians(14.0) or before.down_mps < -2.0

    taken = measurements(before)
    second.engage(
        taken,
        throttle=surfaces.throttle,
        elevator=surfaces.elevator,
        aileron=surfaces.aileron,
        rudder=surfaces.rudder,
    )
    out = second.step(measurements(before))
    assert abs(out.throttle - surfaces.throttle) < 0.05
    assert abs(out.elevator - surfaces.elevator) < 0.1
    for _ in range(1200):
        out = second.step(measurements(plant.state()))
        plant.write(
            replace(
                plant.controls,
                elevator=out.elevator,
                aileron=out.aileron,
                rudder=out.rudder,
                throttle=out.throttle,
            )
        )
        plant.step(3)
    after = plant.state()
    off = (after.heading_rad - before.heading_rad + np.pi) % (2 * np.pi) - np.pi
    assert abs(np.degrees(off)) < 1.0
    assert abs(after.altitude_m - before.altitude_m) < 1.0
    assert abs(after.airspeed_mps - before.airspeed_mps) < 1.0


def test_the_same_flight_twice_is_the_same_to_the_last_bit() -> None:
    scenario = Scenario(aircraft="c172x", seed=SEED, legs=1, noise=True, delay_ticks=1)
    (_, first), (_, second) = fly(scenario), fly(scenario)
    for column in ("heading_deg", "altitude_ft", "elevator", "throttle"):
        assert np.array_equal(first[column], second[column])


def test_wrong_arguments_are_refused_with_a_message() -> None:
    autopilot = fcc.Autopilot()
    state = Plant("c172p", seed=SEED).state()
    with pytest.raises(RuntimeError, match="engage"):
        autopilot.step(measurements(state))
    with pytest.raises(ValueError, match="dt is 0"):
        autopilot.observe(measurements(state), 0.0)
    with pytest.raises(ValueError, match=r"throttle is 1.2: choose 0 to 1"):
        autopilot.engage(measurements(state), throttle=1.2)
    slow = replace(state, airspeed_mps=10.0)
    with pytest.raises(RuntimeError, match="airspeed is below the floor"):
        fcc.Autopilot().engage(measurements(slow), throttle=0.5)
    with pytest.raises(ValueError, match=r"config:2: autopilot\.envelope\.max_bank_deg"):
        fcc.Autopilot("[autopilot.envelope]\nmax_bank_deg = 95.0\n")
    with pytest.raises(ValueError, match="there is no such key"):
        fcc.Autopilot("[autopilot]\nbank = 3\n")


def test_the_legs_are_those_of_the_pattern() -> None:
    pattern = TimedPattern(hold_s=5.0, leg_s=20.0, turn_deg=-45.0, climb_ft=-100.0)
    config = (
        '[guidance]\nmode = "timed-pattern"\n'
        "hold_s = 5.0\nleg_s = 20.0\nturn_deg = -45.0\nclimb_ft = -100.0\n"
    )
    flown, _ = fly(Scenario(seed=SEED, legs=3, pattern=pattern, config=config))
    _hold(flown["worst"], heading_settle_s=12.0, altitude_settle_s=12.0)


@pytest.mark.parametrize(
    ("aircraft", "rms_ft", "airspeed_kt", "settle_s", "loss_ft"),
    [("c172p", 0.9, 2.5, 16.6, 1.6), ("c172x", 1.4, 5.0, 16.4, 2.5)],
)
def test_better_than_a_first_controller_in_every_column(
    aircraft: str, rms_ft: float, airspeed_kt: float, settle_s: float, loss_ft: float
) -> None:
    """Noise and 25 ms delay; the limits are what a first controller reached."""
    flown, _ = fly(Scenario(aircraft=aircraft, seed=SEED, noise=True, delay_ticks=1))
    _hold(
        flown["worst"],
        heading_settle_s=settle_s,
        heading_overshoot_deg=0.5,
        heading_rms_deg=0.4,
        altitude_settle_s=10.5,
        altitude_rms_ft=rms_ft,
        turn_loss_ft=loss_ft,
        airspeed_error_kt=airspeed_kt,
        lateral_acceleration_g=0.05,
    )
