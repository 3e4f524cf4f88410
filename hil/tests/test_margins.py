"""Latency, servos and play between the commands and the surfaces, against JSBSim's truth."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace

import fcc
import numpy as np
import pytest
from first_of import first_of

from fcc_hil.actuation import Actuation, Servos
from fcc_hil.aircraft import by_name
from fcc_hil.campaign.draw import Bounds, draw
from fcc_hil.campaign.flying import fly
from fcc_hil.lockstep import measurements
from fcc_hil.margins import Condition, measure
from fcc_hil.margins.measure import margins_of
from fcc_hil.noise import SensorNoise
from fcc_hil.plant import STEPS_PER_SECOND, Plant
from fcc_hil.state import Controls

_SEED = 2012
_HOLD = '[guidance]\nmode = "hold"\n'
_LOST_AFTER_TICKS = 7 * 40


@dataclass
class _Flight:
    """What a flight in calm air was like, after its first part."""

    pitch_rate_degps: list[float] = field(default_factory=list)
    load_g: list[float] = field(default_factory=list)
    events: list[str] = field(default_factory=list)
    latency_ms: float = 0.0
    play: float = 0.0


def _fly(
    aircraft: str,
    airspeed_kt: float,
    *,
    delay_s: float = 0.0,
    servo_hz: float = 0.0,
    elevator_gain: float = 1.0,
    noise: bool = False,
    loses: tuple[str, ...] = (),
    seconds: float = 25.0,
    judged_after_s: float = 15.0,
) -> _Flight:
    plant = Plant(replace(by_name(aircraft), airspeed_kt=airspeed_kt), seed=_SEED)
    machine = fcc.Machine(f"{_HOLD}[autopilot.scale]\nelevator = {elevator_gain}\n")
    sensors = SensorNoise(_SEED) if noise else None
    latency_steps = round(delay_s * STEPS_PER_SECOND)
    servos = Servos(Actuation(latency_steps, servo_hz or None), plant.controls)
    flown = _Flight()
    for tick in range(round((2.0 + seconds) * 40)):
        state = plant.state()
        stand = plant.controls
        surfaces = machine.step(
            measurements(sensors.apply(state) if sensors else state),
            missing=loses if tick > _LOST_AFTER_TICKS else (),
            readback=(stand.throttle, stand.elevator, stand.aileron, stand.rudder),
            switch=tick > 80,
        )
        if surfaces is None:
            plant.step(3)
            continue
        command = Controls(
            elevator=surfaces.elevator,
            aileron=surfaces.aileron,
            rudder=surfaces.rudder,
            throttle=surfaces.throttle,
        )
        for _ in range(3):
            plant.write(servos.step(command))
            plant.step()
        if tick > (2.0 + judged_after_s) * 40:
            flown.pitch_rate_degps.append(math.degrees(state.pitch_rate_radps))
            flown.load_g.append(-state.specific_force_z_mps2 / 9.80665)
    flown.events = [event.text for event in machine.events()]
    flown.latency_ms = 1e3 * machine.estimate.output_latency_s
    flown.play = machine.estimate.elevator_play
    assert machine.holds_control
    return flown


@pytest.mark.parametrize(
    ("airspeed_kt", "delay_s", "servo_hz"), [(73, 0.075, 0), (100, 0.125, 0), (73, 0.025, 3)]
)
def test_late_commands_and_a_slow_servo_do_not_oscillate(
    airspeed_kt: float, delay_s: float, servo_hz: float
) -> None:
    """Standard deviations of 19, 43 and 11.7 degrees per second before."""
    flown = _fly("c172p", airspeed_kt, delay_s=delay_s, servo_hz=servo_hz)
    assert np.std(flown.pitch_rate_degps) <= 2.0


def test_three_times_the_gain_oscillates_until_the_monitor_takes_gain_out() -> None:
    """As in an aircraft whose elevator is three times as effective as configured."""
    flown = _fly(
        "c172p", 100, delay_s=0.025, servo_hz=3, elevator_gain=3, seconds=40, judged_after_s=25
    )
    assert "now: oscillation: gain is reduced" in flown.events
    assert np.std(flown.pitch_rate_degps) <= 2.0


@pytest.mark.parametrize("airspeed_kt", [73, 100])
def test_late_commands_without_a_gyroscope_do_not_oscillate(airspeed_kt: float) -> None:
    """40 and 50 degrees per second before: the derivative of the attitude is late, too."""
    flown = _fly("c172p", airspeed_kt, delay_s=0.075, servo_hz=3, noise=True, loses=("body_rates",))
    assert np.std(flown.pitch_rate_degps) <= 2.0


@pytest.mark.fault(
    "The aircraft",
    "elevator has play",
    "[explains it better than none](envelope.md#margins)",
    "3 s of oscillation",
    "inverse of play",
)
@pytest.mark.parametrize("airspeed_kt", [80, 100, 120])
def test_play_in_the_elevator_is_found_and_inverted(airspeed_kt: float) -> None:
    """JSBSim's c172x: hysteresis of 0.05 rad, of 0.40 to 0.49 rad of travel."""
    flown = _fly("c172x", airspeed_kt, seconds=30.0, judged_after_s=20.0)
    assert np.max(np.abs(np.array(flown.load_g) - 1.0)) <= 0.1
    assert 0.05 / 0.49 - 0.02 <= flown.play <= 0.05 / 0.40


@pytest.mark.parametrize(("seed", "number"), first_of((31, 291), (33, 81), (33, 196), (33, 226)))
def test_play_that_is_seldom_crossed_is_not_taken_for_latency(seed: int, number: int) -> None:
    """The c172x at 69 and 74 kt: 175 to 250 ms before, and an oscillation to the end."""
    flown, _ = fly(draw(number, seed, Bounds()))
    assert not flown.verdict.broken


@pytest.mark.fault(
    "The aircraft",
    "outputs act late",
    "[measured latency](envelope.md#margins) above 120 ms",
    "3 s, with noise or manoeuvre",
    "event; loops slower",
)
@pytest.mark.parametrize(("delay_s", "least_ms", "most_ms"), [(0.0, 0, 50), (0.15, 120, 230)])
def test_the_latency_is_measured_in_flight(delay_s: float, least_ms: float, most_ms: float) -> None:
    """The truth is the delay and a tick, 25 and 175 ms; the bank's models are 25 ms apart."""
    flown = _fly("c172p", 100, delay_s=delay_s, noise=True)
    assert least_ms <= flown.latency_ms <= most_ms
    late = "the outputs take effect too late for the gains"
    assert any(late in text for text in flown.events) == (delay_s > 0.12)
    assert flown.play == 0.0


@pytest.mark.parametrize("airspeed_kt", [70, 125])
@pytest.mark.parametrize("axis", ["elevator", "aileron", "rudder", "throttle"])
def test_6_db_and_45_degrees_with_25_ms_and_a_3_hz_servo(airspeed_kt: float, axis: str) -> None:
    margins = measure(Condition("c172p", airspeed_kt, axis))
    assert margins.gain_db >= 6.0
    assert margins.phase_deg >= 45.0


def test_margins_of_an_integrator_with_delay_are_the_textbooks() -> None:
    """L = w exp(-sT)/s crosses over at w with 90 degrees less w T, and -180 at pi/(2 T)."""
    frequency_hz = np.geomspace(0.1, 10.0, 200)
    s = 2j * np.pi * frequency_hz
    crossover, delay_s = 2.0 * np.pi, 0.1
    gain_db, phase_deg, crossover_hz = margins_of(
        frequency_hz, crossover * np.exp(-s * delay_s) / s
    )
    assert gain_db == pytest.approx(20.0 * math.log10(math.pi / 2.0 / (crossover * delay_s)), 0.02)
    assert phase_deg == pytest.approx(90.0 - math.degrees(crossover * delay_s), abs=0.5)
    assert crossover_hz == pytest.approx(1.0, 0.01)
