"""Puts faults into sensors: for tests, scripts and the campaign."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, TypedDict

from .faulty_sensors import EVERYTHING, MORE_CHANNELS, Kind, SensorFault
from .quantities import Quantity, finite, quantity_of

if TYPE_CHECKING:
    from typing_extensions import Unpack

_LONGEST_DELAY_S = 60.0

Sensor = Quantity | str
"""A quantity, its name, or `"everything"`."""


class When(TypedDict, total=False):
    """When a fault acts."""

    after: float
    """It begins so many seconds from now; at once by default."""
    lasts: float | None
    """For so many seconds; None, the default, until the end."""


class Faults:
    """Adds faults to sensors, now or later, for a time or until the end.

    Sensors are given as quantities or their names: `heading`, `"airspeed"`, `attitude`; or as
    `"everything"`, the whole simulator (loss only). Amounts are in the quantity's unit:
    `faults.bias(altitude("m"), by=30)`.
    """

    def __init__(
        self,
        now_s: Callable[[], float],
        put_in: Callable[[Sequence[SensorFault]], None],
        seed: int = 1,
    ) -> None:
        """`now_s` gives the simulated time, `put_in` takes all faults."""
        self._now_s = now_s
        self._put_in = put_in
        self._seed = seed
        self.all: list[SensorFault] = []
        """Every fault so far, also those that have ended."""

    def loss(self, sensor: Sensor, *, share: float = 1.0, **when: Unpack[When]) -> SensorFault:
        """Lose a share of its samples, by default all."""
        return self._add(Kind.LOSS, sensor, share=share, **when)

    def delay(self, sensor: Sensor, *, by: float, **when: Unpack[When]) -> SensorFault:
        """Delay its values by `by` seconds."""
        by = finite("by", by)
        if not 0.0 < by <= _LONGEST_DELAY_S:
            raise ValueError(f"by is {by:g} s: a delay is above 0 and at most 60 s")
        return self._add(Kind.DELAY, sensor, amount=by, **when)

    def duplicate(self, sensor: Sensor, *, share: float = 1.0, **when: Unpack[When]) -> SensorFault:
        """Repeat a share of its samples after the next one."""
        return self._add(Kind.DUPLICATE, sensor, share=share, **when)

    def reorder(self, sensor: Sensor, *, share: float = 1.0, **when: Unpack[When]) -> SensorFault:
        """Let a share of its samples be overtaken by the next one."""
        return self._add(Kind.REORDER, sensor, share=share, **when)

    def freeze(self, sensor: Sensor, **when: Unpack[When]) -> SensorFault:
        """Keep its present value."""
        return self._add(Kind.FREEZE, sensor, **when)

    def nan(self, sensor: Sensor, **when: Unpack[When]) -> SensorFault:
        """Return NaN."""
        return self._add(Kind.NAN, sensor, **when)

    def bias(self, sensor: Sensor, *, by: float, **when: Unpack[When]) -> SensorFault:
        """Add a constant, in its unit."""
        return self._add(Kind.BIAS, sensor, by=finite("by", by), **when)

    def noise(self, sensor: Sensor, *, sigma: float, **when: Unpack[When]) -> SensorFault:
        """Add white noise with this standard deviation, in its unit."""
        sigma = finite("sigma", sigma)
        if sigma < 0.0:
            raise ValueError(f"sigma is {sigma:g}: a standard deviation is at least 0")
        return self._add(Kind.NOISE, sensor, by=sigma, **when)

    def drift(self, sensor: Sensor, *, per_s: float, **when: Unpack[When]) -> SensorFault:
        """Add a bias that grows by so much each second, in its unit; no airspeed falls below 0."""
        return self._add(Kind.DRIFT, sensor, by=finite("per_s", per_s), **when)

    def blocked_tube(self, *, drain_is_open: bool = False, **when: Unpack[When]) -> SensorFault:
        """Block the pitot tube, and its drain unless that is open."""
        kind = Kind.OPEN_DRAIN if drain_is_open else Kind.BLOCKED_TUBE
        return self._add(kind, "airspeed", **when)

    def blocked_static(self, **when: Unpack[When]) -> SensorFault:
        """Block the static port, which airspeed and altitude share."""
        return self._add(Kind.BLOCKED_STATIC, "airspeed", **when)

    def round(self, sensor: Sensor, *, to: float, **when: Unpack[When]) -> SensorFault:
        """Round its values to multiples of `to`, in its unit."""
        to = finite("to", to)
        if to <= 0.0:
            raise ValueError(f"to is {to:g}: give a step above 0")
        return self._add(Kind.ROUND, sensor, by=to, **when)

    def slow(self, sensor: Sensor, *, to_hz: float, **when: Unpack[When]) -> SensorFault:
        """Let it give no more than `to_hz` values a second."""
        to_hz = finite("to_hz", to_hz)
        if not 1.0 / _LONGEST_DELAY_S <= to_hz <= 1_000.0:
            raise ValueError(f"to_hz is {to_hz:g}: give 1/60 to 1000 values a second")
        return self._add(Kind.SLOW, sensor, amount=1.0 / to_hz, **when)

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
        sensor: Sensor,
        *,
        after: float = 0.0,
        lasts: float | None = None,
        by: float | None = None,
        amount: float = 0.0,
        share: float = 1.0,
    ) -> SensorFault:
        after, share = finite("after", after), finite("share", share)
        if after < 0.0:
            raise ValueError(f"after is {after:g} s: a fault cannot begin in the past")
        if lasts is not None and finite("lasts", lasts) <= 0.0:
            raise ValueError(f"lasts is {lasts:g} s: give more than 0, or omit it")
        if not 0.0 < share <= 1.0:
            raise ValueError(f"share is {share:g}: give a fraction above 0 and up to 1")
        name, words = EVERYTHING, f"{kind.value} of {EVERYTHING}"
        channels: tuple[str, ...] = ()
        if sensor == EVERYTHING:
            if kind is not Kind.LOSS:
                raise ValueError(f"{kind.value} of everything: only its loss is supported")
        else:
            quantity = quantity_of(sensor)
            if not quantity.channels:
                raise ValueError(f"no sensor measures {quantity.name}: it cannot have a fault")
            name, channels = quantity.name, quantity.channels
            channels += MORE_CHANNELS.get(kind, ())
            words = f"{kind.value.replace('_', ' ')} of {name}"
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
