"""Faults of the aircraft's sensors, defined once for both ways of flying.

In lockstep they change the autopilot's measurements, in real time the values in the stand-in's
replies: `FaultySensors.read` is called once per tick or frame with the true state, and returns the
measured one.

One random number is drawn for each sample and fault, so the share of a loss is one of samples: 40 a
second in lockstep, one per frame in real time.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from enum import Enum

import numpy as np

from .local_axes import EARTH_RADIUS_M
from .state import State
from .units import calibrated_airspeed_mps, impact_pressure_pa, wrap_heading_rad

EVERYTHING = "everything"
"""In place of a sensor: the whole simulator, its clock and its switch included."""

NOTHING_MISSING: frozenset[str] = frozenset()


class Kind(Enum):
    """The kinds of faults. They act in this order, from the sensor to the autopilot."""

    BLOCKED_TUBE = "blocked_tube"
    """The pitot tube and its drain are blocked: the total pressure stays as it was."""
    OPEN_DRAIN = "open_drain"
    """The pitot tube is blocked and its drain is not: the total pressure falls to the static."""
    BLOCKED_STATIC = "blocked_static"
    """The static port is blocked: its pressure stays as it was, for airspeed and altitude."""
    FREEZE = "freeze"
    """It keeps the value of the fault's beginning."""
    BIAS = "bias"
    """A constant is added."""
    NOISE = "noise"
    """White noise is added; the amount is one standard deviation."""
    DRIFT = "drift"
    """A bias grows by the amount each second."""
    ROUND = "round"
    """Its values are multiples of the amount."""
    NAN = "nan"
    """It returns NaN."""
    SLOW = "slow"
    """It gives one value in so many seconds."""
    DELAY = "delay"
    """Values are late by so many seconds; none until the first arrives."""
    DUPLICATE = "duplicate"
    """A sample is repeated after the next one."""
    REORDER = "reorder"
    """A sample is overtaken by the next one."""
    LOSS = "loss"
    """A sample is lost."""


MORE_CHANNELS = {
    Kind.BLOCKED_TUBE: ("pressure_pa",),
    Kind.OPEN_DRAIN: ("pressure_pa",),
    Kind.BLOCKED_STATIC: ("pressure_pa", "altitude_m"),
}
"""What else of the state they need or change."""

_DRAINS_S = 2.0
SAMPLES_PER_S = 40.0
"""In lockstep."""

_ORDER = {kind: place for place, kind in enumerate(Kind)}


@dataclass(frozen=True)
class SensorFault:
    """A fault of one sensor; times are simulated ones."""

    kind: Kind
    sensor: str
    """The name of a quantity, or EVERYTHING."""
    channels: tuple[str, ...]
    """Of `state.State`."""
    begins_s: float
    ends_s: float = math.inf
    amount: float = 0.0
    """Of bias, noise and steps in SI units, of delay and the time between values in s."""
    share: float = 1.0
    """The share of the samples of a loss, duplication or reordering, 0..1."""
    words: str = ""
    """Its description."""
    seed: int = 0

    def is_active(self, time_s: float) -> bool:
        """Return whether it acts at a time."""
        return self.begins_s <= time_s < self.ends_s


class FaultySensors:
    """The sensors with their faults; one call of `read` is one sample of all of them."""

    def __init__(self) -> None:
        """Start without faults."""
        self._running: dict[SensorFault, _Running] = {}

    def set_faults(self, faults: Sequence[SensorFault]) -> None:
        """Replace the faults; those that stay continue."""
        ordered = sorted(faults, key=lambda fault: _ORDER[fault.kind])
        self._running = {fault: self._running.get(fault) or _Running(fault) for fault in ordered}

    def read(self, time_s: float, state: State) -> tuple[State | None, frozenset[str]]:
        """Return the measured state, and the missing channels.

        The state is None if everything is missing.
        """
        active = [run for fault, run in self._running.items() if fault.is_active(time_s)]
        if not active:
            return state, NOTHING_MISSING
        measured: dict[str, float | None] = {}
        everything = False
        for run in active:
            channels = run.fault.channels
            if run.fault.sensor == EVERYTHING:
                everything |= run.draw()
                continue
            before = {name: measured.get(name, getattr(state, name)) for name in channels}
            measured.update(run.sample(time_s, before))
        if everything:
            return None, NOTHING_MISSING
        came = {name: value for name, value in measured.items() if value is not None}
        return _with(state, came), frozenset(measured.keys() - came.keys())


_Values = dict[str, float | None]


def _with(state: State, values: dict[str, float]) -> State:
    """Return a copy of a state with some of its fields changed."""
    changed = replace(state)
    for name, value in values.items():
        setattr(changed, name, value)
    return changed


class _Running:
    """An active fault, with its memory."""

    def __init__(self, fault: SensorFault) -> None:
        self.fault = fault
        self._random = np.random.default_rng(fault.seed)
        self._kept: _Values | None = None
        self._late: deque[tuple[float, _Values]] = deque()
        self._next_s = -math.inf
        self._act: Callable[[float, _Values], _Values] = getattr(self, f"_{fault.kind.value}")

    def draw(self) -> bool:
        """Return whether this sample belongs to its share."""
        return bool(self._random.random() < self.fault.share)

    def sample(self, time_s: float, values: _Values) -> _Values:
        """Return one sample of its channels, changed."""
        return self._act(time_s, values)

    def _freeze(self, _time_s: float, values: _Values) -> _Values:
        self._kept = self._kept or values
        return self._kept

    def _bias(self, _time_s: float, values: _Values) -> _Values:
        return {name: _add(name, values, self.fault.amount) for name in values}

    def _drift(self, time_s: float, values: _Values) -> _Values:
        by = self.fault.amount * (time_s - self.fault.begins_s)
        drifted = {name: _add(name, values, by) for name in values}
        airspeed_mps = drifted.get("airspeed_mps")
        return (
            drifted if airspeed_mps is None else drifted | {"airspeed_mps": max(0.0, airspeed_mps)}
        )

    def _blocked_tube(self, _time_s: float, values: _Values) -> _Values:
        return self._by_pressures(values, tube_s=math.inf, static=False)

    def _open_drain(self, _time_s: float, values: _Values) -> _Values:
        return self._by_pressures(values, tube_s=_DRAINS_S, static=False)

    def _blocked_static(self, _time_s: float, values: _Values) -> _Values:
        return self._by_pressures(values, tube_s=0.0, static=True)

    def _by_pressures(self, values: _Values, *, tube_s: float, static: bool) -> _Values:
        """Return what the instruments show with a tube or a static port that is blocked.

        The trapped total pressure falls to the static one with the time constant `tube_s`; 0 is
        a tube that is open.
        """
        airspeed_mps, pressure_pa = values["airspeed_mps"], values["pressure_pa"]
        if airspeed_mps is None or pressure_pa is None:
            return values
        total_pa = pressure_pa + impact_pressure_pa(airspeed_mps)
        self._kept = self._kept or {"total": total_pa, **values}
        if tube_s > 0.0:
            kept_pa = self._kept["total"] or total_pa
            left = 1.0 if math.isinf(tube_s) else math.exp(-1.0 / (SAMPLES_PER_S * tube_s))
            total_pa = pressure_pa + left * (kept_pa - pressure_pa)
            self._kept["total"] = total_pa
        if static:
            kept = {name: self._kept[name] for name in ("pressure_pa", "altitude_m")}
            values, pressure_pa = values | kept, kept["pressure_pa"] or pressure_pa
        return values | {"airspeed_mps": calibrated_airspeed_mps(total_pa - pressure_pa)}

    def _noise(self, _time_s: float, values: _Values) -> _Values:
        return {
            name: _add(name, values, self.fault.amount * self._random.standard_normal())
            for name in values
        }

    def _round(self, _time_s: float, values: _Values) -> _Values:
        return {
            name: None if value is None else _in_range(name, round(value / step) * step)
            for name, value in values.items()
            for step in (self.fault.amount * _unit(name, values),)
        }

    def _slow(self, time_s: float, values: _Values) -> _Values:
        # Slightly early: sums of ticks and of frames are not exact.
        if time_s < self._next_s - 1e-6:
            return dict.fromkeys(values)
        self._next_s = max(self._next_s, time_s) + self.fault.amount
        return values

    def _nan(self, _time_s: float, values: _Values) -> _Values:
        return dict.fromkeys(values, math.nan)

    def _delay(self, time_s: float, values: _Values) -> _Values:
        self._late.append((time_s + self.fault.amount, values))
        came: _Values = dict.fromkeys(values)
        # Slightly early: sums of ticks and of frames are not exact.
        while self._late and self._late[0][0] <= time_s + 1e-6:
            came = self._late.popleft()[1]
        return came

    def _duplicate(self, _time_s: float, values: _Values) -> _Values:
        again, self._kept = self._kept, values if self.draw() else None
        return values if again is None else again

    def _reorder(self, _time_s: float, values: _Values) -> _Values:
        overtaken, self._kept = self._kept, None
        if overtaken is not None:
            return overtaken
        if self.draw():
            self._kept = values
            return dict.fromkeys(values)
        return values

    def _loss(self, _time_s: float, values: _Values) -> _Values:
        return dict.fromkeys(values) if self.draw() else values


def _add(channel: str, values: _Values, amount: float) -> float | None:
    value = values[channel]
    return None if value is None else _in_range(channel, value + amount * _unit(channel, values))


def _unit(channel: str, values: _Values) -> float:
    """Return a unit of the fault's amount in that of a channel: of a position, metres in rad."""
    if channel not in ("latitude_rad", "longitude_rad"):
        return 1.0
    latitude_rad = values["latitude_rad"] if channel == "longitude_rad" else 0.0
    return 1.0 / (EARTH_RADIUS_M * math.cos(latitude_rad or 0.0))


def _in_range(channel: str, value: float) -> float:
    return wrap_heading_rad(value) if channel == "heading_rad" else value
