"""Position and velocity that are lost on the way to a landing, and on the runway."""

from __future__ import annotations

import functools
from collections.abc import Sequence
from pathlib import Path

import fcc
import numpy as np
import pytest

from fcc_hil import plan_file, plan_start
from fcc_hil.flight import Flight
from fcc_hil.lockstep_rig import Conditions, LockstepRig
from fcc_hil.marks import aircraft_mark, autopilot_mark
from fcc_hil.pattern import TimedPattern
from fcc_hil.plant import Plant

CIRCUIT = Path(__file__).parents[2] / "config/plans/circuit.waypoints"
LANDS_BY_S = 900.0
HALF_RUNWAY_M = 15.24
"""Of a runway of 100 ft."""
SINK_FPM = 600.0
"""What a landing gear has to withstand at least: 10 ft/s (14 CFR 23.473)."""
GNSS = ("position", "velocity")


def _flight() -> Flight:
    settings = aircraft_mark("c172p", wind=(270, 8))
    plan = plan_file.read(CIRCUIT)
    plant = plan_start.plant(plan, settings.aircraft, seed=1, weather=settings.weather)
    machine = fcc.Machine(autopilot_mark("plan", plan=CIRCUIT).toml())
    rig = LockstepRig(settings, plant, machine, Conditions(position=True))
    flight = Flight(rig, None, 1, plan)
    flight.engages(by=3)
    return flight


@pytest.mark.parametrize("sensor", GNSS)
def test_what_is_not_measured_cannot_fail(sensor: str) -> None:
    plant = Plant("c172p", seed=1)
    rig = LockstepRig(aircraft_mark("c172p"), plant, fcc.Machine())
    flight = Flight(rig, TimedPattern(), 1)
    with pytest.raises(ValueError, match=f"measures no {sensor}"):
        flight.faults.loss(sensor)


def _lands(flight: Flight) -> None:
    flight.lands(by=LANDS_BY_S, centre_line=HALF_RUNWAY_M, sink=SINK_FPM)


@functools.cache
def _touches_s() -> float:
    """Return when it touches down with everything, since engagement."""
    flight = _flight()
    flight.flies(to=650)
    _lands(flight)
    truth = flight.truth().since(flight.engaged_at_s)
    in_air = np.flatnonzero(truth["on_ground"] == 0.0)
    return float(truth["time_s"][in_air[-1]]) - flight.engaged_at_s


def _loses(sensors: Sequence[str], before_s: float) -> Flight:
    """Lose sensors for good so long before the touch-down."""
    flight = _flight()
    for sensor in sensors:
        flight.faults.loss(sensor, after=_touches_s() - before_s)
    flight.flies(to=_touches_s() - 1.0)
    return flight


def _told(flight: Flight) -> list[str]:
    return [event.text for event in flight.rig.events]


@pytest.mark.parametrize(("sensors", "before_s"), [(GNSS, 60.0), (GNSS[:1], 20.0)])
def test_a_short_final_is_landed_without_a_position(
    sensors: Sequence[str], before_s: float
) -> None:
    flight = _loses(sensors, before_s)
    _lands(flight)
    told = _told(flight)
    assert any("position is by dead reckoning" in text for text in told), told
    flight.flies(60)
    told = _told(flight)
    assert not any("going around" in text for text in told), told
    assert not any("brakes" in text for text in told), told


@pytest.mark.fault(
    "Sensors",
    "GNSS velocity lost",
    "age",
    "1 s",
    "by the positions, between them by airspeed, heading, last wind",
)
def test_a_landing_without_a_velocity_is_flown_on() -> None:
    flight = _loses(GNSS[1:], 149.0)
    _lands(flight)
    told = _told(flight)
    assert not any("dead reckoning" in text or "going around" in text for text in told), told


@pytest.mark.fault(
    "Sensors",
    "GNSS position lost, or position and velocity",
    "age",
    "3 s; `contingency.position_lost_after_s` ({contingency.position_lost_after_s} s)",
    "`position is by dead reckoning`; then [`position_lost`](plan.md#contingencies)",
)
def test_a_position_lost_for_long_gives_a_landing_up_for_that_reason() -> None:
    """It is lost for 120 s (the default) 29 s before the touch-down, and comes back later."""
    flight = _loses(GNSS, 149.0)
    flight.flies(60)
    told = _told(flight)
    given_up = [text for text in told if "given up" in text or "going around" in text]
    assert given_up == ["given up: no position for longer than position_lost_after_s"], told
    returns = "there is no position for too long: returning"
    flight.flies(120)
    assert returns in _told(flight), _told(flight)
    flight.faults.end()
    flight.flies(600)
    flight.lands(by=2_400, centre_line=HALF_RUNWAY_M, sink=SINK_FPM)
    flight.flies(60)
    told = _told(flight)
    assert not any("brakes" in text for text in told), told
