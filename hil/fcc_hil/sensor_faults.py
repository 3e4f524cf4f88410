"""Puts faults into sensors: for tests, scripts and the campaign."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

from .faulty_sensors import EVERYTHING, MORE_CHANNELS, Kind, SensorFault
from .quantities import Quantity, finite, quantity_of

_LONGEST_DELAY_S = 60.0


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

    def loss(
        self,
        sensor: Quantity | str,
        *,
        share: float = 1.0,
        after: float = 0.0,
        lasts: float | None = None,
    ) -> SensorFault:
        """Lose a share of its samples, by default all."""
        return self._add(Kind.LOSS, sensor, after, lasts, share=share)

    def delay(
        self, sensor: Quantity | str, *, by: float, after: float = 0.0, lasts: float | None = None
    ) -> SensorFault:
        """Delay its values by `by` seconds."""
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
        """Repeat a share of its samples after the next one."""
        return self._add(Kind.DUPLICATE, sensor, after, lasts, share=share)

    def reorder(
        self,
        sensor: Quantity | str,
        *,
        share: float = 1.0,
        after: float = 0.0,
        lasts: float | None = None,
    ) -> SensorFault:
        """Let a share of its samples be overtaken by the next one."""
        return self._add(Kind.REORDER, sensor, after, lasts, share=share)

    def freeze(
        self, sensor: Quantity | str, *, after: float = 0.0, lasts: float | None = None
    ) -> SensorFault:
        """Keep its present value."""
        return self._add(Kind.FREEZE, sensor, after, lasts)

    def nan(
        self, sensor: Quantity | str, *, after: float = 0.0, lasts: float | None = None
    ) -> SensorFault:
        """Return NaN."""
        return self._add(Kind.NAN, sensor, after, lasts)

    def bias(
        self, sensor: Quantity | str, *, by: float, after: float = 0.0, lasts: float | None = None
    ) -> SensorFault:
        """Add a constant, in its unit."""
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

    def drift(
        self,
        sensor: Quantity | str,
        *,
        per_s: float,
        after: float = 0.0,
        lasts: float | None = None,
    ) -> SensorFault:
        """Add a bias that grows by so much each second, in its unit; no airspeed falls below 0."""
        return self._add(Kind.DRIFT, sensor, after, lasts, by=finite("per_s", per_s))

    def blocked_tube(
        self, *, drain_is_open: bool = False, after: float = 0.0, lasts: float | None = None
    ) -> SensorFault:
        """Block the pitot tube, and its drain unless that is open."""
        kind = Kind.OPEN_DRAIN if drain_is_open else Kind.BLOCKED_TUBE
        return self._add(kind, "airspeed", after, lasts)

    def blocked_static(self, *, after: float = 0.0, lasts: float | None = None) -> SensorFault:
        """Block the static port, which airspeed and altitude share."""
        return self._add(Kind.BLOCKED_STATIC, "airspeed", after, lasts)

    def round(
        self,
        sensor: Quantity | str,
        *,
        to: float,
        after: float = 0.0,
        lasts: float | None = None,
    ) -> SensorFault:
        """Round its values to multiples of `to`, in its unit."""
        to = finite("to", to)
        if to <= 0.0:
            raise ValueError(f"to is {to:g}: give a step above 0")
        return self._add(Kind.ROUND, sensor, after, lasts, by=to)

    def slow(
        self,
        sensor: Quantity | str,
        *,
        to_hz: float,
        after: float = 0.0,
        lasts: float | None = None,
    ) -> SensorFault:
        """Let it give no more than `to_hz` values a second."""
        to_hz = finite("to_hz", to_hz)
        if not 1.0 / _LONGEST_DELAY_S <= to_hz <= 1_000.0:
            raise ValueError(f"to_hz is {to_hz:g}: give 1/60 to 1000 values a second")
        return self._add(Kind.SLOW, sensor, after, lasts, amount=1.0 / to_hz)

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
