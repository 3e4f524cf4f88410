"""Draws the conditions of a flight: the same for the same number, seed and bounds."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

from ..actuation import Actuation
from ..loading import Loading
from ..plant import STEPS_PER_SECOND, Weather
from ..receiver import Receiver
from ..truth import TRUTH_HZ
from .aircraft import AIRCRAFT, Limits

HOLD_S = 15.0
LEG_S = 35.0
LEGS = 3
"""Long enough for a turn of 120 degrees at the greatest speed and a bank of 20 degrees."""

SLOWEST = 1.3
"""The lowest speed ordered, as a multiple of the stalling speed: that of an approach."""

_FLOOR_MARGIN_KT = 4.0
"""Above the lowest permitted speed, because measurements have errors."""

_NO_FAULT = 0.6
FAULTS = (
    "everything lost briefly",
    "attitude lost briefly",
    "heading lost briefly",
    "altitude lost briefly",
    "samples lost",
    "airspeed lost",
    "airspeed frozen",
    "airspeed biased",
    "engine out",
)


RAW_RECEIVER = Receiver(period_ticks=int(TRUTH_HZ) // 5, delay_ticks=5, sigma_mps=0.1)
"""That of the raw sensors: 5 fixes a second, 120 ms late."""


@dataclass(frozen=True)
class Bounds:
    """The severest conditions of a campaign."""

    delay_ms: float = 75.0
    """From a measurement to the effect of the command, in all, without servos."""
    turbulence: int = 4
    """After MIL-F-8785C, 0..7."""
    raw_sensors: str | None = None
    """Flown by these alone, phone or board; None for sensors that measure what control needs."""
    kind: str = "edges"
    """edges, healthy, or airspeed: healthy but for the airspeed."""

    @property
    def words(self) -> str:
        """The options of the command that are not the usual ones."""
        usual = usual_bounds(self.kind)
        words = "" if self.kind == "edges" else f" --{self.kind}"
        if self.delay_ms != usual.delay_ms:
            words += f" --delay-ms {self.delay_ms:g}"
        if self.turbulence != usual.turbulence:
            words += f" --turbulence {self.turbulence}"
        return words if self.raw_sensors is None else f"{words} --raw {self.raw_sensors}"


def usual_bounds(kind: str) -> Bounds:
    """Return the bounds of a kind of campaign, unless others are asked for."""
    return Bounds() if kind == "edges" else Bounds(150.0, 5, kind=kind)


@dataclass(frozen=True)
class Gust:
    """Moving air that comes and goes as 1 - cos, constant in between."""

    begins_s: float
    """Since engaging."""
    ramp_s: float
    steady_s: float
    north_mps: float = 0.0
    east_mps: float = 0.0
    down_mps: float = 0.0


@dataclass(frozen=True)
class Order:
    """Changes of the set points."""

    turn_deg: float
    """Positive to the right."""
    climb_ft: float
    airspeed_kt: float | None = None
    """None to keep it."""


@dataclass(frozen=True)
class Fault:
    """Something that fails, of FAULTS."""

    what: str
    begins_s: float
    """Since engaging."""
    lasts_s: float | None
    """None to the end."""
    amount: float = 0.0
    """Of a bias in kt; of lost samples their share."""


@dataclass(frozen=True)
class Flight:
    """The conditions of one flight."""

    number: int
    seed: int
    bounds: Bounds
    aircraft: str
    loading: Loading
    airspeed_kt: float
    """At which it is trimmed and engaged."""
    weather: Weather
    gusts: tuple[Gust, ...]
    noise: float
    """As a multiple of the usual levels."""
    biases: dict[str, float]
    """By the name of the quantity, in its unit."""
    sensor_delay_ticks: int
    receiver: Receiver | None
    """None in half of the flights: the velocity over the ground is not measured."""
    actuation: Actuation
    fault: Fault | None
    is_pattern: bool
    """Whether guidance flies the timed pattern; else the set points are commanded."""
    orders: tuple[Order, ...]

    @property
    def limits(self) -> Limits:
        """Where the aircraft stalls."""
        return AIRCRAFT[self.aircraft]

    @property
    def stall_kt(self) -> float:
        """The stalling speed at its weight."""
        return self.limits.stall_kt(self.loading.weight_lb)

    @property
    def delay_ms(self) -> float:
        """The delay in all."""
        return 1e3 * (
            self.sensor_delay_ticks / TRUTH_HZ + self.actuation.latency_steps / STEPS_PER_SECOND
        )


_AnyFlight = TypeVar("_AnyFlight", bound=Flight)


def draw(number: int, seed: int, bounds: Bounds) -> Flight:
    """Draw flight `number` of a campaign's `seed`. The aircraft take turns."""
    flight = _draw(number, seed, bounds)
    return flight if bounds.raw_sensors is None else with_raw_sensors(flight)


def with_raw_sensors(flight: _AnyFlight) -> _AnyFlight:
    """Return the same flight by raw sensors, but for what these bring themselves.

    That is noise, biases, the delay of measurements, and how often a receiver gives a fix.
    """
    late_steps = round(flight.sensor_delay_ticks * STEPS_PER_SECOND / TRUTH_HZ)
    outputs = flight.actuation
    return replace(
        flight,
        noise=1.0,
        biases={},
        sensor_delay_ticks=0,
        actuation=replace(outputs, latency_steps=outputs.latency_steps + late_steps),
        receiver=None if flight.receiver is None else RAW_RECEIVER,
    )


def _draw(number: int, seed: int, bounds: Bounds) -> Flight:
    random = np.random.default_rng([seed, number])
    limits = list(AIRCRAFT.values())[number % len(AIRCRAFT)]
    loading = draw_loading(random, limits)
    slow_kt = max(SLOWEST * limits.stall_kt(loading.weight_lb), limits.floor_kt + _FLOOR_MARGIN_KT)
    # A third at the lowest speed.
    drawn_kt = float(random.uniform(1.5 * slow_kt - 0.5 * limits.fast_kt, limits.fast_kt))
    airspeed_kt = max(slow_kt, drawn_kt)
    weather = Weather(
        wind_from_deg=float(random.uniform(0.0, 360.0)),
        wind_kt=float(random.uniform(0.0, 25.0)),
        turbulence_severity=int(random.integers(0, bounds.turbulence + 1)),
    )
    delay_s = 1e-3 * float(random.uniform(0.0, bounds.delay_ms))
    ticks = int(delay_s * float(random.uniform()) * TRUTH_HZ)
    is_pattern = bool(random.random() < 0.4)
    return Flight(
        number=number,
        seed=seed,
        bounds=bounds,
        aircraft=limits.name,
        loading=loading,
        airspeed_kt=airspeed_kt,
        weather=weather,
        gusts=tuple(_gusts(random)),
        noise=float(random.uniform(0.0, 1.5)),
        biases=_biases(random),
        sensor_delay_ticks=ticks,
        actuation=Actuation(
            latency_steps=int((delay_s - ticks / TRUTH_HZ) * STEPS_PER_SECOND),
            servo_hz=float(random.uniform(3.0, 10.0)) if random.random() < 0.7 else None,
        ),
        receiver=_receiver(np.random.default_rng([seed, number, 1])),
        fault=_fault(random),
        is_pattern=is_pattern,
        orders=tuple(
            _orders(random, is_pattern, max(slow_kt, limits.slowest_order_kt), limits.fast_kt)
        ),
    )


def draw_loading(random: np.random.Generator, limits: Limits) -> Loading:
    """Return a loading from one person with little fuel to the greatest weight."""
    fuel_lb = float(random.uniform(0.1, 1.0)) * min(
        limits.tanks_lb, limits.most_lb - limits.bare_lb
    )
    least_lb = limits.bare_lb + fuel_lb
    return Loading(
        weight_lb=float(random.uniform(least_lb, limits.most_lb)),
        fuel_lb=fuel_lb,
        aft_in=float(random.uniform(-2.0, 2.0)),
    )


def _gusts(random: np.random.Generator) -> Iterator[Gust]:
    """Yield gusts of up to 6 m/s, and columns of rising or sinking air of up to 5 m/s."""
    for _ in range(int(random.integers(0, 3))):
        towards = float(random.uniform(0.0, 2.0 * np.pi))
        level_mps = float(random.uniform(0.0, 6.0))
        yield Gust(
            begins_s=float(random.uniform(0.0, HOLD_S + LEGS * LEG_S - 5.0)),
            ramp_s=float(random.uniform(0.5, 2.0)),
            steady_s=0.0,
            north_mps=level_mps * float(np.cos(towards)),
            east_mps=level_mps * float(np.sin(towards)),
            down_mps=float(random.uniform(-6.0, 6.0)),
        )
    if random.random() < 0.3:
        yield Gust(
            begins_s=float(random.uniform(0.0, HOLD_S + LEGS * LEG_S - 40.0)),
            ramp_s=float(random.uniform(2.0, 5.0)),
            steady_s=float(random.uniform(5.0, 25.0)),
            down_mps=float(random.uniform(-3.0, 5.0)),
        )


def _biases(random: np.random.Generator) -> dict[str, float]:
    """Return constant errors within the tolerances of light aircraft's instruments."""
    within = {
        "heading": 4.0,
        "altitude": 50.0,
        "airspeed": 3.0,
        "attitude": 1.0,
        "roll_rate": 0.2,
        "pitch_rate": 0.2,
        "yaw_rate": 0.2,
    }
    return {name: float(random.uniform(-most, most)) for name, most in within.items()}


def _receiver(random: np.random.Generator) -> Receiver | None:
    """Return a receiver of 1 to 10 velocities a second, 50 to 250 ms late."""
    if random.random() < 0.5:
        return None
    return Receiver(
        period_ticks=int(TRUTH_HZ) // int(random.choice([1, 5, 10])),
        delay_ticks=int(random.integers(2, 11)),
        sigma_mps=float(random.uniform(0.05, 0.3)),
    )


def _fault(random: np.random.Generator) -> Fault | None:
    drawn, which = random.random(), int(random.integers(len(FAULTS)))
    begins_s = float(random.uniform(5.0, 80.0))
    short_s, long_s = float(random.uniform(0.1, 0.5)), float(random.uniform(5.0, 30.0))
    share, bias_kt = float(random.uniform(0.02, 0.2)), float(random.uniform(-20.0, 20.0))
    if drawn < _NO_FAULT:
        return None
    what = FAULTS[which]
    if what == "samples lost":
        return Fault(what, 0.0, None, share)
    if what in ("airspeed biased", "engine out"):
        return Fault(what, begins_s, None, bias_kt)
    return Fault(what, begins_s, long_s if what.startswith("airspeed") else short_s)


def _orders(
    random: np.random.Generator, is_pattern: bool, slow_kt: float, fast_kt: float
) -> Iterator[Order]:
    side, climb_ft = float(random.choice([-1.0, 1.0])), float(random.uniform(100.0, 300.0))
    if is_pattern:
        turn_deg = side * float(random.uniform(30.0, 120.0))
        for leg in range(LEGS):
            yield Order(turn_deg, climb_ft if leg % 2 == 0 else -climb_ft)
        return
    if random.random() < 0.3:
        # Climbing turns at one speed.
        for _ in range(LEGS):
            yield Order(side * float(random.uniform(60.0, 120.0)), climb_ft)
        return
    for _ in range(LEGS):
        changes = random.random() < 0.5
        airspeed_kt = float(random.uniform(slow_kt, fast_kt))
        yield Order(
            float(random.uniform(-120.0, 120.0)),
            float(random.uniform(-300.0, 300.0)),
            airspeed_kt if changes else None,
        )
