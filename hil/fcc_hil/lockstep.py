"""The autopilot and JSBSim in lockstep: no clock, no network, as fast as both compute.

The same autopilot as in the daemon, through the module `fcc`. Each tick reads the sensors, steps
the autopilot, writes the controls and steps the plant; with a delay of n ticks it gets the
measurements of n ticks before.
"""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass, replace

import fcc

from .aircraft import by_name
from .initial_state import InitialState, begin
from .loading import Loading
from .noise import SensorNoise
from .pattern import TimedPattern
from .plant import Plant, Weather
from .quantities import SENSORS
from .score import Score
from .state import Controls, State
from .truth import STEPS_PER_ROW, TRUTH_HZ, Truth, row

_CHANNELS = tuple(channel for channels in SENSORS.values() for channel in channels)
_CALM = Weather()
_THESIS_PATTERN = TimedPattern()


@dataclass(frozen=True)
class Scenario:
    """A flight and its conditions."""

    aircraft: str = "c172p"
    legs: int = 8
    seed: int = 1
    noise: bool = False
    delay_ticks: int = 0
    """Age of the measurements, in ticks of 25 ms."""
    weather: Weather = _CALM
    pattern: TimedPattern = _THESIS_PATTERN
    config: str = ""
    """Text of a configuration; the default gains if empty."""
    initial_state: InitialState = InitialState.TRIMMED
    airspeed_kt: float | None = None
    """At which it is trimmed and engaged; None for that of the aircraft table."""
    loading: Loading | None = None
    """None for that of the aircraft's file."""

    def plant(self) -> Plant:
        """Return the aircraft, trimmed."""
        aircraft = replace(by_name(self.aircraft), loading=self.loading)
        if self.airspeed_kt is not None:
            aircraft = replace(aircraft, airspeed_kt=self.airspeed_kt)
        return Plant(aircraft, seed=self.seed, weather=self.weather)


def measurements(state: State) -> fcc.Measurements:
    """Return the measurements of ideal sensors."""
    return fcc.Measurements(
        weight_on_wheels=float(state.on_ground),
        engine_speed_radps=state.engine_speed_radps,
        battery_voltage_v=state.battery_voltage_v,
        **{channel: getattr(state, channel) for channel in _CHANNELS},
    )


def as_surfaces(stand: Controls) -> fcc.Surfaces:
    """Return where the controls stand, for the autopilot."""
    return fcc.Surfaces(
        throttle=stand.throttle,
        elevator=stand.elevator,
        aileron=stand.aileron,
        rudder=stand.rudder,
        elevator_trim=math.nan if stand.elevator_trim is None else stand.elevator_trim,
    )


def as_controls(surfaces: fcc.Surfaces) -> Controls:
    """Return the autopilot's outputs, for the plant."""
    return Controls(
        elevator=surfaces.elevator,
        aileron=surfaces.aileron,
        rudder=surfaces.rudder,
        throttle=surfaces.throttle,
        elevator_trim=_given(surfaces.elevator_trim),
        flaps=_given(surfaces.flaps),
        left_brake=_given(surfaces.left_brake),
        right_brake=_given(surfaces.right_brake),
        nose_wheel=_given(surfaces.nose_wheel),
        gear=_given(surfaces.gear),
    )


def _given(value: float) -> float | None:
    return None if math.isnan(value) else value


class _Sensors:
    """Noise and delay between a plant and the autopilot."""

    def __init__(self, scenario: Scenario) -> None:
        self._noise = SensorNoise(scenario.seed) if scenario.noise else None
        self._waiting: deque[fcc.Measurements] = deque(maxlen=scenario.delay_ticks + 1)

    def read(self, state: State) -> fcc.Measurements:
        self._waiting.append(measurements(self._noise.apply(state) if self._noise else state))
        return self._waiting[0]


def fly(scenario: Scenario) -> tuple[Score, Truth]:
    """Fly a scenario to its end; return its score and the truth."""
    plant = scenario.plant()
    autopilot = fcc.Autopilot(scenario.config)
    sensors = _Sensors(scenario)

    def watch(state: State) -> None:
        autopilot.observe(sensors.read(state), 1 / TRUTH_HZ)

    standing = begin(plant, scenario.initial_state, scenario.config, measurements, watch)
    autopilot.engage(
        sensors.read(plant.state()),
        1 / TRUTH_HZ,
        throttle=standing.throttle,
        elevator=standing.elevator,
        aileron=standing.aileron,
        rudder=standing.rudder,
        elevator_trim=standing.elevator_trim,
    )

    engaged_at_s = plant.time_s
    rows = [row(plant.state(), plant.controls)]
    for _ in range(round(scenario.pattern.duration_s(scenario.legs) * TRUTH_HZ)):
        plant.step(STEPS_PER_ROW)
        state = plant.state()
        surfaces = autopilot.step(sensors.read(state), 1 / TRUTH_HZ)
        plant.write(as_controls(surfaces))
        rows.append(row(state, plant.controls))
    truth = Truth(rows)
    return truth.score(scenario.pattern, scenario.legs, engaged_at_s), truth
