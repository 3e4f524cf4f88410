"""Sensors that contradict each other are not engaged; right ones always are. Truth is JSBSim's."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache

import fcc
import numpy as np
import pytest

from fcc_hil.aircraft import by_name
from fcc_hil.lockstep import measurements
from fcc_hil.noise import NoiseLevels, SensorNoise
from fcc_hil.plant import Plant, Weather
from fcc_hil.state import Controls, State
from fcc_hil.units import STANDARD_GRAVITY_MPS2

Wrong = Callable[[fcc.Measurements], None]

HOLD = '[guidance]\nmode = "hold"\n'
READBACK = (0.6, 0.0, 0.0, 0.0)
TICKS = 240
"""6 s at 40 Hz."""
STEPS = 3

RATES = "body rates contradict attitude or heading"
LOAD = "vertical acceleration contradicts gravity"
PITCH = "forward acceleration contradicts pitch and airspeed"
OURS = (RATES, LOAD, PITCH)


@cache
def _flight(aircraft: str, turbulence: int, seed: int, *, moved: bool) -> Sequence[State]:
    """Return the states of a flight by hand: hands off, or the controls moved each half second."""
    weather = Weather(wind_kt=15.0, turbulence_severity=turbulence) if turbulence else Weather()
    plant = Plant(aircraft, seed=seed, weather=weather)
    random = np.random.default_rng(seed)
    states = []
    for tick in range(TICKS):
        if moved and tick % 20 == 0:
            elevator, aileron, rudder = (0.06, 0.15, 0.2) * random.uniform(-1.0, 1.0, 3)
            plant.write(Controls(elevator, aileron, rudder, plant.trim.throttle))
        plant.step(STEPS)
        states.append(plant.state())
    return states


def _noisy(states: Sequence[State], seed: int) -> list[State]:
    """Add 1.5 times the usual noise, and the largest biases of a campaign."""
    levels = NoiseLevels()
    most = replace(levels, **{name: 1.5 * value for name, value in vars(levels).items()})
    noise = SensorNoise(seed, most)
    side = 1.0 if seed % 2 else -1.0
    return [
        replace(
            state,
            pitch_rad=state.pitch_rad + side * math.radians(1.0),
            roll_rad=state.roll_rad + side * math.radians(1.0),
            roll_rate_radps=state.roll_rate_radps - side * math.radians(0.2),
            pitch_rate_radps=state.pitch_rate_radps + side * math.radians(0.2),
            yaw_rate_radps=state.yaw_rate_radps + side * math.radians(0.2),
            airspeed_mps=state.airspeed_mps - side * 1.54,
        )
        for state in map(noise.apply, states)
    ]


def _coarse(states: Sequence[State]) -> list[State]:
    """Attitude and heading to 1 degree at 10 Hz, the airspeed to 1 kt."""

    def whole(value: float, step: float) -> float:
        return round(value / step) * step

    degree = math.radians(1.0)
    return [
        replace(
            state,
            pitch_rad=whole(states[tick // 4 * 4].pitch_rad, degree),
            roll_rad=whole(states[tick // 4 * 4].roll_rad, degree),
            heading_rad=whole(states[tick // 4 * 4].heading_rad, degree) % math.tau,
            airspeed_mps=whole(state.airspeed_mps, 0.514444),
        )
        for tick, state in enumerate(states)
    ]


def _late(states: Sequence[State]) -> list[State]:
    """Attitude and heading 0.2 s late."""
    return [
        replace(now, pitch_rad=late.pitch_rad, roll_rad=late.roll_rad, heading_rad=late.heading_rad)
        for now, late in zip(states[8:], states, strict=False)
    ]


def _watch(machine: fcc.Machine, states: Sequence[State], wrong: Wrong | None = None) -> list[str]:
    """Return which contradictions were ever reported."""
    told: list[str] = []
    for state in states:
        measured = measurements(state)
        if wrong:
            wrong(measured)
        machine.step(measured, switch=False, readback=READBACK)
        told += [
            text
            for text in OURS
            if text not in told
            and any(inhibit.startswith(text) for inhibit in machine.engage_inhibits)
        ]
    return told


def _times(factor: float, *names: str) -> Wrong:
    def wrong(measured: fcc.Measurements) -> None:
        for name in names:
            setattr(measured, name, factor * getattr(measured, name))

    return wrong


def _pitch_off(degrees: float) -> Wrong:
    def wrong(measured: fcc.Measurements) -> None:
        measured.pitch_rad += math.radians(degrees)

    return wrong


def _heading_reversed(measured: fcc.Measurements) -> None:
    measured.heading_rad = -measured.heading_rad % math.tau


ALL_RATES = ("roll_rate_radps", "pitch_rate_radps", "yaw_rate_radps")
ALL_FORCES = ("specific_force_x_mps2", "specific_force_y_mps2", "specific_force_z_mps2")


@pytest.mark.parametrize("aircraft", ["c172p", "J3Cub", "T37"])
@pytest.mark.parametrize("turbulence", [0, 3, 5])
@pytest.mark.parametrize("moved", [False, True], ids=["hands off", "moved"])
def test_right_sensors_are_never_refused(aircraft: str, turbulence: int, *, moved: bool) -> None:
    states = _flight(aircraft, turbulence, 1, moved=moved)
    for sensed in (states, _noisy(states, 1), _noisy(states, 2), _coarse(states), _late(states)):
        assert _watch(fcc.Machine(HOLD), sensed) == []


@pytest.mark.parametrize("seed", [1, 11, 26])
def test_severe_gusts_are_no_contradiction(seed: int) -> None:
    """Gusts that change the airspeed by 12 m/s in 4 s."""
    aircraft = fcc.BuiltInAircraft(f'[built-in]\ngusts = "severe"\nseed = {seed}\n')
    machine = fcc.Machine(HOLD)
    for _ in range(2 * TICKS):
        machine.step(aircraft.step(None, machine.period_s), switch=False, readback=READBACK)
        assert not any(inhibit.startswith(OURS) for inhibit in machine.engage_inhibits)


def test_right_sensors_are_engaged_when_navigation_has_settled() -> None:
    """After 1, 2 and 4 s in severe turbulence, as without these comparisons."""
    for seed in range(1, 6):
        states = _noisy(_flight("c172p", 5, seed, moved=False), seed)
        for after in (41, 80, 160):
            machine = fcc.Machine(HOLD)
            assert _watch(machine, states[:after]) == []
            for state in states[after : after + 2]:
                machine.step(measurements(state), switch=True, readback=READBACK)
            assert machine.holds_control, "with the second reading of the switch"


@pytest.mark.fault(
    "Sensors",
    "before engaging: wrong sign or unit of attitude, heading, rates, acceleration; pitch off "
    "by 5°",
    "[mutual contradiction](envelope.md#sensors-against-each-other)",
    "1 to 5 s, partly only with motion",
    "engaging refused",
)
@pytest.mark.parametrize("noisy", [False, True], ids=["exact", "noisy"])
@pytest.mark.parametrize(
    ("wrong", "text"),
    [
        pytest.param(_times(-1.0, "roll_rad"), RATES, id="roll's sign"),
        pytest.param(_times(-1.0, "pitch_rad"), RATES, id="pitch's sign"),
        pytest.param(_heading_reversed, RATES, id="heading's sign"),
        pytest.param(_times(-1.0, "roll_rate_radps"), RATES, id="roll rate's sign"),
        pytest.param(_times(-1.0, "pitch_rate_radps"), RATES, id="pitch rate's sign"),
        pytest.param(_times(-1.0, "yaw_rate_radps"), RATES, id="yaw rate's sign"),
        pytest.param(_times(-1.0, *ALL_RATES), RATES, id="all rates' signs"),
        pytest.param(_times(math.radians(1.0), *ALL_RATES), RATES, id="rates too small"),
        pytest.param(_times(-1.0, "specific_force_z_mps2"), LOAD, id="z's sign"),
        pytest.param(_times(1 / STANDARD_GRAVITY_MPS2, *ALL_FORCES), LOAD, id="in g"),
        pytest.param(_times(1 / 0.3048, *ALL_FORCES), LOAD, id="in ft/s2"),
    ],
)
def test_wrong_sensors_are_not_engaged(wrong: Wrong, text: str, *, noisy: bool) -> None:
    """The pilot moves the controls; the first reason is the right one."""
    states = _flight("c172p", 0, 3, moved=True)
    machine = fcc.Machine(HOLD)
    assert _watch(machine, _noisy(states, 3) if noisy else states, wrong)[:1] == [text]


@pytest.mark.parametrize(
    ("wrong", "noisy"),
    [
        pytest.param(_pitch_off(5.0), False, id="5 degrees"),
        pytest.param(_pitch_off(-5.0), False, id="-5 degrees"),
        pytest.param(_pitch_off(5.0), True, id="5 degrees, noisy"),
        pytest.param(_pitch_off(-7.0), True, id="-7 degrees, noisy"),
        pytest.param(_times(-1.0, "pitch_rad"), False, id="pitch's sign"),
        pytest.param(_times(-1.0, "specific_force_x_mps2"), False, id="x's sign"),
    ],
)
def test_a_pitch_that_is_off_is_not_engaged(wrong: Wrong, *, noisy: bool) -> None:
    """Without motion; slowly, so that the pitch is several degrees."""
    states = _slow()
    machine = fcc.Machine(HOLD)
    assert _watch(machine, _noisy(states, 3) if noisy else states, wrong) == [PITCH]


@cache
def _slow() -> Sequence[State]:
    plant = Plant(replace(by_name("c172p"), airspeed_kt=75.0))
    states = []
    for _ in range(TICKS):
        plant.step(STEPS)
        states.append(plant.state())
    return states


@pytest.mark.parametrize("noisy", [False, True], ids=["exact", "noisy"])
@pytest.mark.parametrize("names", [("pitch_rad", "roll_rad"), ALL_RATES], ids=["angles", "rates"])
def test_degrees_are_not_engaged(names: Sequence[str], *, noisy: bool) -> None:
    """Beside what contradicts, they are out of range, implausible or beyond 60 degrees."""
    machine, in_degrees = fcc.Machine(HOLD), _times(math.degrees(1.0), *names)
    states = _flight("c172p", 0, 3, moved=True)
    for tick, state in enumerate(_noisy(states, 3) if noisy else states):
        measured = measurements(state)
        in_degrees(measured)
        machine.step(measured, switch=tick > 120, readback=READBACK)
        assert not machine.holds_control
