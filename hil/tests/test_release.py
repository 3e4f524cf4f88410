"""A release that is ours to time: hands off, the aircraft goes on by itself (JSBSim's truth)."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Literal

import edge_sensors
import numpy as np
import pytest

from fcc_hil.aircraft import by_name
from fcc_hil.faulty_sensors import Kind, SensorFault
from fcc_hil.lockstep_rig import LockstepRig
from fcc_hil.plant import Plant
from fcc_hil.quantities import SENSORS
from fcc_hil.standin import Settings
from fcc_hil.state import Controls
from fcc_hil.units import FT_TO_M, KT_TO_MPS

SEED = 12
FPM = FT_TO_M / 60.0
HANDS_OFF_S = 20.0


class FaultyTrim(Plant):
    """An aircraft whose trim runs 0.1 a second, and runs away or is stuck if it is told to."""

    fault: Literal["none", "runs up", "stuck"] = "none"
    commanded = 0.0

    def write(self, controls: Controls, throttles: Sequence[float] | None = None) -> None:
        """Write, the trim as far as it comes in a tick."""
        now = self.controls.elevator_trim or 0.0
        to = now if controls.elevator_trim is None else controls.elevator_trim
        self.commanded = to
        wanted = {"none": to, "runs up": 1.0, "stuck": now}[self.fault]
        trim = now + min(0.0025, max(-0.0025, wanted - now))
        super().write(replace(controls, elevator_trim=trim), throttles)


class Flight:
    """A flight in level flight, engaged."""

    def __init__(
        self,
        airspeed_kt: float,
        *,
        aircraft: str = "c172p",
        config: str = "",
        noise: bool = True,
        plant: type[Plant] = Plant,
    ) -> None:
        trimmed = replace(by_name(aircraft), airspeed_kt=airspeed_kt)
        self.plant = plant(trimmed, seed=SEED, latitude_deg=edge_sensors.LATITUDE_DEG)
        settings = Settings(port=0, aircraft=aircraft, seed=SEED, noise=noise)
        hold = '[guidance]\nmode = "hold"\n'
        self.machine = edge_sensors.machine(hold + config)
        between = edge_sensors.conditions(SEED)
        self.rig = LockstepRig(settings, self.plant, self.machine, between)
        edge_sensors.settle(self.rig)
        self.rig.set_switch(on=True)
        self.fly(0.2)
        assert self.machine.state == "engaged"

    def fly(self, seconds: float) -> None:
        """Fly on."""
        self.rig.fly_to(self.rig.time_s + seconds)

    def stop(self) -> float:
        """Command the stop; return how long it takes until the release."""
        self.machine.stop()
        return self.fly_until("stopped")

    def fly_until(self, state: str) -> float:
        """Fly until the loop is in that state; return how long it takes."""
        begin_s = self.rig.time_s
        while self.machine.state != state and self.rig.time_s < begin_s + 20.0:
            # The throttle's lever stands where the autopilot left the throttle.
            self.plant.trim = Controls(throttle=self.plant.controls.throttle)
            self.fly(0.025)
        assert self.machine.state == state
        return self.rig.time_s - begin_s

    def lose(self, sensor: str) -> None:
        """Lose a sensor for good."""
        now_s = self.rig.time_s
        self.rig.set_faults(
            [SensorFault(Kind.LOSS, sensor, SENSORS[sensor], now_s, now_s + 1000.0)]
        )

    def hands_off(self) -> tuple[float, float]:
        """Fly with centred surfaces; return the changes of airspeed, kt, and height rate, fpm."""
        released = self.plant.state()
        for _ in range(round(HANDS_OFF_S * 40)):
            self.plant.write(Controls(throttle=self.plant.controls.throttle))
            self.plant.step(3)
        after = self.plant.state()
        return (after.airspeed_mps - released.airspeed_mps) / KT_TO_MPS, -after.down_mps / FPM


def level(_: Flight) -> None:
    """Leave it in level flight."""


def turning(flight: Flight) -> None:
    """Bring it into a turn of 30 degrees of bank."""
    flight.machine.command(heading_rad=math.radians(170.0))
    flight.fly(6.0)
    assert math.degrees(flight.plant.state().roll_rad) > 25.0


def climbing(flight: Flight) -> None:
    """Bring it into a climb."""
    flight.machine.command(altitude_m=flight.plant.state().altitude_m + 300.0)
    flight.fly(6.0)
    assert flight.plant.state().down_mps < -2.0


@pytest.mark.parametrize("airspeed_kt", [73.0, 100.0])
@pytest.mark.parametrize("manoeuvre", [level, turning, climbing])
def test_a_commanded_stop_hands_over_a_trimmed_aircraft(
    airspeed_kt: float, manoeuvre: Callable[[Flight], None]
) -> None:
    flight = Flight(100.0)
    flight.machine.command(airspeed_mps=airspeed_kt * KT_TO_MPS)
    flight.fly(20.0)
    manoeuvre(flight)
    assert flight.stop() < 10.1
    changed_kt, climb_fpm = flight.hands_off()
    assert abs(changed_kt) < 10.0
    assert abs(climb_fpm) < 500.0


def test_a_second_stop_releases_at_once() -> None:
    flight = Flight(100.0)
    turning(flight)
    flight.machine.stop()
    flight.fly(1.0)
    assert flight.machine.state == "engaged"
    assert flight.stop() < 0.06


def test_level_and_trim_can_be_switched_off() -> None:
    flight = Flight(100.0, config="[release]\nlevel_and_trim_s = 0\n")
    turning(flight)
    assert flight.stop() < 0.06


def test_the_trim_takes_over_what_the_elevator_holds_without_a_bump() -> None:
    flight = Flight(100.0, noise=False)
    flight.machine.command(airspeed_mps=73.0 * KT_TO_MPS)
    flight.fly(40.0)
    assert abs(flight.plant.controls.elevator) < 0.05
    truth = flight.rig.truth()
    assert np.abs(truth["altitude_ft"] - truth["altitude_ft"][0]).max() < 3.0


def test_without_the_trim_the_elevator_holds() -> None:
    flight = Flight(100.0, config="[autopilot]\ntrim = false\n")
    before = flight.plant.controls.elevator_trim
    flight.machine.command(airspeed_mps=73.0 * KT_TO_MPS)
    flight.fly(30.0)
    assert flight.plant.controls.elevator_trim == before
    assert flight.plant.controls.elevator > 0.1


@edge_sensors.measured
def test_degraded_flight_ends_with_a_trimmed_aircraft() -> None:
    flight = Flight(100.0, config="[failsafe]\ndegraded_s = 1.0\n")
    flight.machine.command(airspeed_mps=80.0 * KT_TO_MPS)
    flight.fly(10.0)
    turning(flight)
    flight.lose("heading")
    # 0.25 s until it is lost, 1 s of degraded flight and 5 s of hold.
    assert 6.0 < flight.fly_until("standby") < 6.5
    assert any("levelling and trimming" in event.text for event in flight.rig.events)
    changed_kt, climb_fpm = flight.hands_off()
    assert abs(changed_kt) < 10.0
    assert abs(climb_fpm) < 500.0


@pytest.mark.fault(
    "The aircraft",
    "elevator trim stuck, runaway or held",
    "0.04 from its command",
    "3 s",
    "`the elevator trim does not follow`; [elevator holds](envelope.md#trim-and-release)",
)
@pytest.mark.parametrize("aircraft", ["c172p", "c182"])
def test_a_trim_that_runs_away_and_is_stuck_is_reported_and_harmless_when_free(
    aircraft: str,
) -> None:
    flight = Flight(100.0, aircraft=aircraft, plant=FaultyTrim)
    plant = flight.plant
    assert isinstance(plant, FaultyTrim)
    flight.fly(2.0)
    plant.fault = "runs up"
    flight.fly(4.0)
    plant.fault = "stuck"
    flight.fly(15.0)
    texts = [event.text for event in flight.rig.events]
    assert any("now: the elevator trim does not follow" in text for text in texts)
    # What is commanded stays near what is measured, so that little happens later.
    assert abs(plant.commanded - (plant.controls.elevator_trim or 0.0)) < 0.06
    plant.fault = "none"
    flight.fly(25.0)
    texts = [event.text for event in flight.rig.events]
    assert any("no longer: the elevator trim does not follow" in text for text in texts)
    assert abs(plant.controls.elevator) < 0.06
    truth = flight.rig.truth()
    assert np.abs(truth["altitude_ft"] - truth["altitude_ft"][0]).max() < 20.0


def test_a_release_that_cannot_trim_says_so() -> None:
    flight = Flight(100.0, plant=FaultyTrim)
    plant = flight.plant
    assert isinstance(plant, FaultyTrim)
    plant.fault = "runs up"
    flight.fly(3.0)
    plant.fault = "stuck"
    assert 9.9 < flight.stop() < 10.1
    assert any("the release cannot trim" in event.text for event in flight.rig.events)


@edge_sensors.measured
def test_a_stop_in_failsafe_levels_before_it_releases() -> None:
    flight = Flight(100.0)
    turning(flight)
    flight.lose("heading")
    flight.fly_until("failsafe")
    assert flight.stop() > 2.0
    assert abs(math.degrees(flight.plant.state().roll_rad)) < 3.0
