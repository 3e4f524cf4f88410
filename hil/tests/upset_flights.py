"""Flights into an upset: a script takes the controls of an engaged autopilot, then gives them back.

Truth is JSBSim's. The autopilot keeps running meanwhile; its outputs do not reach the aircraft, as
with a pilot who holds the controls or with a broken servo.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import edge_sensors

from fcc_hil.aircraft import Aircraft
from fcc_hil.lockstep import measurements
from fcc_hil.noise import SensorNoise
from fcc_hil.plant import STEP_S, Plant, Weather
from fcc_hil.raw_sensors import RawSensors
from fcc_hil.state import Controls, State
from fcc_hil.units import FT_TO_M, KT_TO_MPS

HOLD = '[guidance]\nmode = "hold"\n'
_TICK_STEPS = 3
_GRAVITY_MPS2 = 9.80665
_SCRIPTS_LOAD_S = 0.3
"""For this long after the controls were given back the load is that which the script left."""

Script = Callable[[float, State, Controls], Controls | None]
"""From the time since it began, the state and the autopilot's outputs to the controls; None gives
them back."""


@dataclass(frozen=True)
class Conditions:
    """The aircraft, its sensors and its servos."""

    aircraft: str | Aircraft = "c172p"
    seed: int = 1
    noise: bool = False
    delay_ticks: int = 0
    """Age of the measurements, in ticks of 25 ms."""
    servo_hz: float = math.inf
    """Bandwidth of every servo (first order)."""
    weather: Weather = field(default_factory=Weather)
    config: str = HOLD
    airspeed_kt: float | None = None
    """Commanded before the upset."""
    missing: tuple[str, ...] = ()
    """Readings that do not arrive from 2 s before the script on."""


ROUGH = Conditions(noise=True, delay_ticks=1, servo_hz=3.0)
"""Sensor noise, 25 ms of delay and servos of 3 Hz."""


@dataclass
class Recovery:
    """What was flown since the controls were given back."""

    begin: State
    events: list[str]
    state: str = ""
    before_ft: float = 0.0
    """The altitude before the upset."""
    least_ft: float = math.inf
    greatest_kt: float = 0.0
    least_kt: float = math.inf
    greatest_load: float = -math.inf
    least_load: float = math.inf
    greatest_alpha_deg: float = -math.inf
    level_after_s: float | None = None
    """When bank, pitch and rates were small for the rest of the flight."""
    end: State | None = None

    @property
    def lost_ft(self) -> float:
        """Return the height lost since the controls were given back."""
        return self.begin.altitude_m / FT_TO_M - self.least_ft

    def see(self, time_s: float, state: State) -> None:
        """Look at a state, a time after the controls were given back."""
        load = load_of(state)
        airspeed_kt = state.airspeed_mps / KT_TO_MPS
        self.least_ft = min(self.least_ft, state.altitude_m / FT_TO_M)
        self.greatest_kt = max(self.greatest_kt, airspeed_kt)
        self.least_kt = min(self.least_kt, airspeed_kt)
        if time_s > _SCRIPTS_LOAD_S:
            self.greatest_load = max(self.greatest_load, load)
            self.least_load = min(self.least_load, load)
        self.greatest_alpha_deg = max(
            self.greatest_alpha_deg, math.degrees(state.angle_of_attack_rad)
        )
        if abs(state.roll_rad) > math.radians(45.0) or abs(state.pitch_rad) > math.radians(25.0):
            self.level_after_s = None
        elif self.level_after_s is None:
            self.level_after_s = time_s
        self.end = state


def load_of(state: State) -> float:
    """Return the load, g."""
    return -state.specific_force_z_mps2 / _GRAVITY_MPS2


def fly(script: Script, conditions: Conditions | None = None, seconds: float = 25.0) -> Recovery:
    """Fly level for 5 s, then the script, then `seconds` with the controls given back."""
    conditions = conditions or Conditions()
    flight = Flight(conditions)
    for _ in range(round(edge_sensors.STANDBY_S / flight.machine.period_s)):
        flight.tick(None)
    flight.switch = True
    for _ in range(2):  # two readings agree
        flight.tick(None)
    assert flight.machine.state == "engaged", flight.machine.engage_inhibits
    if conditions.airspeed_kt is not None:
        flight.machine.command(airspeed_mps=conditions.airspeed_kt * KT_TO_MPS)
    wait_s = 5.0 if conditions.airspeed_kt is None else 25.0
    for _ in range(round(wait_s / flight.machine.period_s)):
        flight.tick(None)
    flight.missing = conditions.missing
    for _ in range(80 if conditions.missing else 0):
        flight.tick(None)
    before_ft = flight.plant.state().altitude_m / FT_TO_M
    began_s = flight.plant.time_s
    while True:
        taken = script(flight.plant.time_s - began_s, flight.plant.state(), flight.wanted)
        if taken is None:
            break
        flight.tick(taken)
    recovery = Recovery(flight.plant.state(), flight.events, before_ft=before_ft)
    given_back_s = flight.plant.time_s
    while flight.plant.time_s - given_back_s < seconds:
        flight.tick(None)
        state = flight.plant.state()
        recovery.see(flight.plant.time_s - given_back_s, state)
        if state.height_m < 0.0:
            break
    recovery.state = flight.machine.state
    return recovery


class Flight:
    """An aircraft and a loop, with the sensors and servos between them."""

    def __init__(self, conditions: Conditions) -> None:
        self.plant = Plant(
            conditions.aircraft,
            seed=conditions.seed,
            weather=conditions.weather,
            heading_deg=90.0,
            latitude_deg=edge_sensors.LATITUDE_DEG,
        )
        self.machine = edge_sensors.machine(conditions.config)
        between = edge_sensors.conditions(conditions.seed)
        self._calibration = between.calibration
        self._raw = (
            RawSensors(self.plant, between.raw_sensors, seed=conditions.seed)
            if between.raw_sensors
            else None
        )
        self.wanted = self.flown = self.plant.trim
        self.switch = False
        self.missing: tuple[str, ...] = ()
        self.events: list[str] = []
        self._noise = SensorNoise(conditions.seed) if conditions.noise else None
        self._waiting: deque[State] = deque(maxlen=conditions.delay_ticks + 1)
        self._share = 1.0 - math.exp(-2.0 * math.pi * conditions.servo_hz * STEP_S)

    def tick(self, taken: Controls | None) -> None:
        """Fly a tick with the autopilot's outputs, or with the controls that a script has taken."""
        plant = self.plant
        state = plant.state()
        self._waiting.append(self._noise.apply(state) if self._noise else state)
        stand = plant.controls
        values = measurements(self._waiting[0])
        ages_s = {} if self._raw is None else self._raw.read(values)
        if self._calibration is not None:
            self._calibration.apply(values)
        surfaces = self.machine.step(
            values,
            missing=[*self.missing, *edge_sensors.MISSING],
            ages_s=ages_s,
            readback=(stand.throttle, stand.elevator, stand.aileron, stand.rudder),
            switch=self.switch,
        )
        self.wanted = (
            plant.trim
            if surfaces is None
            else Controls(
                elevator=surfaces.elevator,
                aileron=surfaces.aileron,
                rudder=surfaces.rudder,
                throttle=surfaces.throttle,
            )
        )
        goal = taken or self.wanted
        for _ in range(_TICK_STEPS):
            self.flown = _between(self.flown, goal, self._share)
            plant.write(self.flown)
            plant.step()
            if self._raw is not None:
                self._raw.step()
        self.events += [f"{plant.time_s:.2f} {e.text}" for e in self.machine.events()]


def _between(stand: Controls, goal: Controls, share: float) -> Controls:
    return Controls(
        elevator=stand.elevator + share * (goal.elevator - stand.elevator),
        aileron=stand.aileron + share * (goal.aileron - stand.aileron),
        rudder=stand.rudder + share * (goal.rudder - stand.rudder),
        throttle=stand.throttle + share * (goal.throttle - stand.throttle),
    )


def full_aileron(for_s: float) -> Script:
    """Return full left aileron, the rest as the autopilot wants it: a servo that runs away."""

    def script(time_s: float, _state: State, wanted: Controls) -> Controls | None:
        return replace(wanted, aileron=-1.0) if time_s < for_s else None

    return script


def full_aileron_by_a_pilot(for_s: float) -> Script:
    """Return full left aileron, the rest centred."""

    def script(time_s: float, _state: State, _wanted: Controls) -> Controls | None:
        return Controls(aileron=-1.0, throttle=0.65) if time_s < for_s else None

    return script


def to_attitude(
    roll_deg: float, pitch_deg: float | None, airspeed_kt: float = 0.0, *, throttle: float
) -> Script:
    """Return a script that flies to an attitude, and gives back there.

    It rolls first, with a little of up elevator, then pitches; a simple pilot who sees the true
    state. With an airspeed it gives back when that is passed in the attitude.
    """
    was: list[float] = []

    def script(time_s: float, state: State, _wanted: Controls) -> Controls | None:
        roll, pitch = math.degrees(state.roll_rad), math.degrees(state.pitch_rad)
        airspeed = state.airspeed_mps / KT_TO_MPS
        roll_off = (roll_deg - roll + 180.0) % 360.0 - 180.0
        pitch_off = 0.0 if pitch_deg is None else pitch_deg - pitch
        passed = not airspeed_kt or (
            bool(was) and (was[-1] - airspeed_kt) * (airspeed - airspeed_kt) <= 0.0
        )
        was.append(airspeed)
        if abs(roll_off) < 8.0 and abs(pitch_off) < 8.0 and passed:
            return None
        assert time_s < 20.0, f"not reached: roll {roll:.0f}, pitch {pitch:.0f}, {airspeed:.0f} kt"
        rolls = max(-90.0, min(90.0, 3.0 * roll_off))
        pitches = max(-30.0, min(35.0, 1.5 * pitch_off)) * math.cos(state.roll_rad)
        if abs(roll_off) > 20.0 or pitch_deg is None:
            pitches = 0.0
        return Controls(
            elevator=0.012 * pitches + 0.03 * (pitches - math.degrees(state.pitch_rate_radps)),
            aileron=0.01 * rolls + 0.012 * (rolls - math.degrees(state.roll_rate_radps)),
            throttle=throttle,
        )

    return script


def stall_with_full_rudder(seconds: float) -> Script:
    """Return a script that stalls with idle power, then holds full rudder and full up elevator."""
    stalled_at: list[float] = []

    def script(time_s: float, state: State, _wanted: Controls) -> Controls | None:
        if not stalled_at:
            if state.angle_of_attack_rad > math.radians(14.0):
                stalled_at.append(time_s)
            assert time_s < 40.0, "it does not stall"
            level = -0.8 * state.roll_rad - 0.4 * state.roll_rate_radps
            return Controls(elevator=min(1.0, 0.1 * time_s), aileron=level)
        if time_s - stalled_at[0] < seconds:
            return Controls(elevator=1.0, rudder=1.0)
        return None

    return script


def wake_vortex(time_s: float, _state: State, wanted: Controls) -> Controls | None:
    """Roll by full aileron for a second, at 60 degrees a second and more."""
    return replace(wanted, aileron=1.0) if time_s < 1.0 else None
