"""What breaks in the aircraft's sensors, told once and put in on either way of flying.

In lockstep it befalls the measurements that the autopilot is handed, in real time the
values that the stand-in replies with: `FaultySensors.read` is called once a tick there
and once a frame here, with the true state, and says what the sensors make of it.

One draw is made for each sampling and fault, so the share of a loss is one of samplings:
40 a second in lockstep, as many as frames in real time.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from enum import Enum

import numpy as np

from .quantities import Quantity, finite, quantity_of
from .state import State
from .units import wrap_heading_rad

EVERYTHING = "everything"
"""In place of a sensor: the simulator as a whole, its clock and its switch included."""

NOTHING_MISSING: frozenset[str] = frozenset()

_LONGEST_DELAY_S = 60.0


class Kind(Enum):
    """What befalls a sensor. They act in this order, as from the sensor to the autopilot."""

    FREEZE = "freeze"
    """It says what it said when the fault began."""
    BIAS = "bias"
    """It is off by an amount."""
    NOISE = "noise"
    """White noise is added; the amount is one standard deviation."""
    NAN = "nan"
    """It says not-a-number."""
    DELAY = "delay"
    """What it says comes so many seconds late; nothing comes until the first has."""
    DUPLICATE = "duplicate"
    """A sample comes once more, after the next one."""
    REORDER = "reorder"
    """A sample is overtaken by the next one."""
    LOSS = "loss"
    """A sample does not come."""


_ORDER = {kind: place for place, kind in enumerate(Kind)}


@dataclass(frozen=True)
class SensorFault:
    """One fault of one sensor; times are simulated ones."""

    kind: Kind
    sensor: str
    """The name of a quantity, or EVERYTHING."""
    channels: tuple[str, ...]
    """Of `state.State`."""
    begins_s: float
    ends_s: float = math.inf
    amount: float = 0.0
    """Of bias and noise in SI units, of delay in s."""
    share: float = 1.0
    """How many of the samples of a loss, duplication or reordering, 0..1."""
    words: str = ""
    """What people call it."""
    seed: int = 0

    def is_active(self, time_s: float) -> bool:
        """Return whether it acts at a time."""
        return self.begins_s <= time_s < self.ends_s


class FaultySensors:
    """The sensors with their faults; one call of `read` is one sampling of all of them."""

    def __init__(self) -> None:
        """Start with none."""
        self._running: dict[SensorFault, _Running] = {}

    def set_faults(self, faults: Sequence[SensorFault]) -> None:
        """Change the faults; those that stay go on where they were."""
        ordered = sorted(faults, key=lambda fault: _ORDER[fault.kind])
        self._running = {fault: self._running.get(fault) or _Running(fault) for fault in ordered}

    def read(self, time_s: float, state: State) -> tuple[State | None, frozenset[str]]:
        """Return what the sensors say of a state, and the channels of which nothing comes.

        None for the state if nothing comes at all.
        """
        active = [run for fault, run in self._running.items() if fault.is_active(time_s)]
        if not active:
            return state, NOTHING_MISSING
        said: dict[str, float | None] = {}
        everything = False
        for run in active:
            channels = run.fault.channels
            if run.fault.sensor == EVERYTHING:
                everything |= run.draw()
                continue
            before = {name: said.get(name, getattr(state, name)) for name in channels}
            said.update(run.sample(time_s, before))
        if everything:
            return None, NOTHING_MISSING
        came = {name: value for name, value in said.items() if value is not None}
        return _with(state, came), frozenset(said.keys() - came.keys())


_Values = dict[str, float | None]


def _with(state: State, values: dict[str, float]) -> State:
    """Return a copy of a state with some of its fields changed."""
    changed = replace(state)
    for name, value in values.items():
        setattr(changed, name, value)
    return changed


class _Running:
    """A fault at work: what it remembers from one sampling to the next."""

    def __init__(self, fault: SensorFault) -> None:
        self.fault = fault
        self._random = np.random.default_rng(fault.seed)
        self._kept: _Values | None = None
        self._late: deque[tuple[float, _Values]] = deque()
        self._act: Callable[[float, _Values], _Values] = getattr(self, f"_{fault.kind.value}")

    def draw(self) -> bool:
        """Return whether this sample is one of its share."""
        return bool(self._random.random() < self.fault.share)

    def sample(self, time_s: float, values: _Values) -> _Values:
        """Return what becomes of one sample of its channels."""
        return self._act(time_s, values)

    def _freeze(self, _time_s: float, values: _Values) -> _Values:
        self._kept = self._kept or values
        return self._kept

    def _bias(self, _time_s: float, values: _Values) -> _Values:
        return {name: _add(name, value, self.fault.amount) for name, value in values.items()}

    def _noise(self, _time_s: float, values: _Values) -> _Values:
        return {
            name: _add(name, value, self.fault.amount * self._random.standard_normal())
            for name, value in values.items()
        }

    def _nan(self, _time_s: float, values: _Values) -> _Values:
        return dict.fromkeys(values, math.nan)

    def _delay(self, time_s: float, values: _Values) -> _Values:
        self._late.append((time_s + self.fault.amount, values))
        came: _Values = dict.fromkeys(values)
        # A hair early: sums of ticks and of frames are not exact.
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


def _add(channel: str, value: float | None, amount: float) -> float | None:
    if value is None:
        return None
    return wrap_heading_rad(value + amount) if channel == "heading_rad" else value + amount


class Faults:
    """Breaks sensors, from now or from so many seconds on, for a while or for good.

    Sensors go by quantities or their names: `heading`, `"airspeed"`, `attitude`; or
    by `"everything"`, which is the simulator as a whole (loss only). Amounts are in
    the quantity's unit: `faults.bias(altitude("m"), by=30)`.
    """

    def __init__(
        self,
        now_s: Callable[[], float],
        put_in: Callable[[Sequence[SensorFault]], None],
        seed: int = 1,
    ) -> None:
        """Take the simulated time from `now_s`, and hand all faults to `put_in`."""
        self._now_s = now_s
        self._put_in = put_in
        self._seed = seed
        self.all: list[SensorFault] = []
        """Every fault so far, those that are over included."""

    def loss(
        self,
        sensor: Quantity | str,
        *,
        share: float = 1.0,
        after: float = 0.0,
        lasts: float | None = None,
    ) -> SensorFault:
        """Lose a share of its samples, all by default."""
        return self._add(Kind.LOSS, sensor, after, lasts, share=share)

    def delay(
        self, sensor: Quantity | str, *, by: float, after: float = 0.0, lasts: float | None = None
    ) -> SensorFault:
        """Let what it says come `by` seconds late."""
        by = finite("by", by)
        if not 0.0 < by <= _LONGEST_DELAY_S:
            raise ValueError(f"by is {by:g} s: a delay is above 0 and at most 60 s")
        return self._add(Kind.DELAY, sensor, after, lasts, amount=by)

    def duplicate(
        self,
        sensor: Quantity | str,
        *,
        share: float = 1.0,
        after: float = 0.0,
        lasts: float | None = None,
    ) -> SensorFault:
        """Let a share of its samples come once more, after the next."""
        return self._add(Kind.DUPLICATE, sensor, after, lasts, share=share)

    def reorder(
        self,
        sensor: Quantity | str,
        *,
        share: float = 1.0,
        after: float = 0.0,
        lasts: float | None = None,
    ) -> SensorFault:
        """Let a share of its samples be overtaken by the next."""
        return self._add(Kind.REORDER, sensor, after, lasts, share=share)

    def freeze(
        self, sensor: Quantity | str, *, after: float = 0.0, lasts: float | None = None
    ) -> SensorFault:
        """Let it say the same for ever."""
        return self._add(Kind.FREEZE, sensor, after, lasts)

    def nan(
        self, sensor: Quantity | str, *, after: float = 0.0, lasts: float | None = None
    ) -> SensorFault:
        """Let it say not-a-number."""
        return self._add(Kind.NAN, sensor, after, lasts)

    def bias(
        self, sensor: Quantity | str, *, by: float, after: float = 0.0, lasts: float | None = None
    ) -> SensorFault:
        """Let it be off `by` so much, in its unit."""
        return self._add(Kind.BIAS, sensor, after, lasts, by=finite("by", by))

    def noise(
        self,
        sensor: Quantity | str,
        *,
        sigma: float,
        after: float = 0.0,
        lasts: float | None = None,
    ) -> SensorFault:
        """Add white noise with this standard deviation, in its unit."""
        sigma = finite("sigma", sigma)
        if sigma < 0.0:
            raise ValueError(f"sigma is {sigma:g}: a standard deviation is at least 0")
        return self._add(Kind.NOISE, sensor, after, lasts, by=sigma)

    def end(self, fault: SensorFault | None = None) -> None:
        """End a fault now, or all of them."""
        now_s = self._now_s()
        self.all = [
            replace(known, ends_s=now_s)
            if known.ends_s > now_s and fault in (None, known)
            else known
            for known in self.all
        ]
        self._put_in(self.all)

    def _add(
        self,
        kind: Kind,
        sensor: Quantity | str,
        after: float,
        lasts: float | None,
        *,
        by: float | None = None,
        amount: float = 0.0,
        share: float = 1.0,
    ) -> SensorFault:
        after, share = finite("after", after), finite("share", share)
        if after < 0.0:
            raise ValueError(f"after is {after:g} s: a fault cannot begin in the past")
        if lasts is not None and finite("lasts", lasts) <= 0.0:
            raise ValueError(f"lasts is {lasts:g} s: give more than 0, or leave it out")
        if not 0.0 < share <= 1.0:
            raise ValueError(f"share is {share:g}: give a fraction above 0 and up to 1")
        name, words = EVERYTHING, f"{kind.value} of {EVERYTHING}"
        channels: tuple[str, ...] = ()
        if sensor == EVERYTHING:
            if kind is not Kind.LOSS:
                raise ValueError(f"{kind.value} of everything: only its loss can be told")
        else:
            quantity = quantity_of(sensor)
            if not quantity.channels:
                raise ValueError(f"no sensor measures {quantity.name}: there is nothing to break")
            name, channels = quantity.name, quantity.channels
            words = f"{kind.value} of {name}"
            if by is not None:
                amount = by * quantity.si_per_unit
                words += f" by {quantity.words(by)}"
        begins_s = self._now_s() + after
        fault = SensorFault(
            kind=kind,
            sensor=name,
            channels=channels,
            begins_s=begins_s,
            ends_s=math.inf if lasts is None else begins_s + lasts,
            amount=amount,
            share=share,
            words=words,
            seed=self._seed * 1_000 + len(self.all),
        )
        self.all.append(fault)
        self._put_in(self.all)
        return fault
