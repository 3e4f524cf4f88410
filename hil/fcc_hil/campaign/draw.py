"""Draws the conditions of a flight: the same for the same number, seed and bounds.

The kinds of campaign differ by what is drawn here, and by their limits in `verdict`.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from types import MappingProxyType

import numpy as np

from ..actuation import Actuation
from ..faulty_sensors import Kind as SensorFaultKind
from ..faulty_sensors import SensorFault
from ..loading import Loading
from ..pattern import TimedPattern
from ..plant import STEPS_PER_SECOND, Weather
from ..quantities import QUANTITIES
from ..receiver import Receiver
from ..truth import TRUTH_HZ
from ..units import wrap_heading
from .aircraft import AIRCRAFT, SLOWEST, Limits


@dataclass(frozen=True)
class Kind:
    """What a kind of campaign draws at most, and how many of its flights are to be clean."""

    delay_ms: float
    """From a measurement to the effect of the command, in all, without servos."""
    turbulence: int
    """After MIL-F-8785C, 0..7."""
    least_clean_percent: float


KINDS = MappingProxyType(
    {
        "edges": Kind(75.0, 4, 98.0),
        "healthy": Kind(150.0, 5, 94.0),
        "airspeed": Kind(150.0, 5, 94.0),
    }
)

HOLD_S, LEG_S, LEGS = 15.0, 35.0, 3
"""Of the edges: long enough for a turn of 120 degrees at the greatest speed and a bank of 20."""
LEGS_S = tuple(HOLD_S + leg * LEG_S for leg in range(LEGS))
"""When they begin, since engaging."""
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
TUBE, WRONG = "pitot tube blocked", "airspeed wrong for a time"
"""The faults of the kind airspeed."""

_WITHIN = {
    "heading": 4.0,
    "altitude": 50.0,
    "airspeed": 3.0,
    "attitude": 1.0,
    "roll_rate": 0.2,
    "pitch_rate": 0.2,
    "yaw_rate": 0.2,
}
"""The tolerances of light aircraft's instruments, in each quantity's unit."""

_SECONDS, _LONG_SECONDS, _LONG_EACH = 310.0, 600.0, 4
"""Of the healthy ones; every fourth is a long one."""
_ORDER_S = (8.0, 45.0)
_LAST_ORDER_S = 75.0
"""Before the end: a turn by 180° at the largest bank takes 40 s at 135 kt, and 30 s are judged."""
_CLIMB_FT = 1_500.0
"""Around the first altitude, 3,000 ft above level ground."""
_LAST_CLIMB_FT = 150.0
"""Around the altitude at the last order, so that it stands when it is judged."""
_SIGMAS = {
    "roll_rad": (1.0, "bank"),
    "pitch_rad": (1.0, "pitch"),
    "roll_rate_radps": (0.5, "roll_rate"),
    "pitch_rate_radps": (0.5, "pitch_rate"),
    "yaw_rate_radps": (0.5, "yaw_rate"),
    "specific_force_x_mps2": (0.1, "specific_force"),
    "specific_force_y_mps2": (0.1, "specific_force"),
    "specific_force_z_mps2": (0.1, "specific_force"),
    "airspeed_mps": (2.0, "airspeed"),
    "altitude_m": (30.0, "altitude"),
    "heading_rad": (3.0, "heading"),
}
"""By channel: 1 sigma of its bias in °, °/s, m/s², kt, ft; and the quantity, whose unit it is."""
_COARSE = 1.0 / 3.0
_STEPS = {
    "airspeed": (0.1, 0.5, 1.0),
    "altitude": (1.0, 10.0, 20.0, 50.0, 100.0),
    "heading": (1.0,),
}
"""In kt, ft and °."""

TUBE_S = (4.0, 28.0, 58.0)
"""When the pitot tube is blocked, since engaging."""
_CRUISE = 1.7
"""Times the stalling speed."""


@dataclass(frozen=True)
class Bounds:
    """The severest conditions of a campaign."""

    delay_ms: float = KINDS["edges"].delay_ms
    turbulence: int = KINDS["edges"].turbulence
    raw_sensors: str | None = None
    """Flown by these alone, phone or board; None for sensors that measure what control needs."""
    kind: str = "edges"
    """Of KINDS: edges, healthy, or airspeed: healthy but for the airspeed."""

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
    return Bounds(KINDS[kind].delay_ms, KINDS[kind].turbulence, kind=kind)


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
    """Set points from a time on; what is None stays."""

    time_s: float
    """Since engaging."""
    heading_deg: float | None
    climb_ft: float | None
    """Above the altitude at which the flight was engaged, or the present one."""
    airspeed_kt: float | None
    from_present: bool = False


@dataclass(frozen=True)
class Fault:
    """Something that fails, of FAULTS, TUBE or WRONG."""

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
    seconds: float
    """How long it is flown, from engaging on."""
    orders: tuple[Order, ...]
    noise: float
    """As a multiple of the usual levels."""
    biases: dict[str, float]
    """By the fields of `state.State`."""
    sensor_delay_ticks: int
    actuation: Actuation
    gusts: tuple[Gust, ...] = ()
    receiver: Receiver | None = None
    """None if the velocity over the ground is not measured, or with the position."""
    measures_position: bool = False
    """Position and velocity over the ground, without errors."""
    measures_trim: bool = True
    steps: dict[str, float] = field(default_factory=dict)
    """Of sensors that are quantised, by their quantities, in kt, ft and °."""
    fault: Fault | None = None
    pattern: TimedPattern | None = None
    """What guidance flies instead of orders."""

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

    @property
    def has_receiver(self) -> bool:
        """Whether there is satellite navigation."""
        return self.measures_position or self.receiver is not None

    @property
    def biases_in_sigma(self) -> dict[str, float]:
        """The biases by channel, as multiples of what the healthy ones are drawn with."""
        return {
            channel: by / (_SIGMAS[channel][0] * _si(_SIGMAS[channel][1]))
            for channel, by in self.biases.items()
        }

    def errors(self) -> list[SensorFault]:
        """Return the steps, as the sensors have them."""
        return [
            SensorFault(
                SensorFaultKind.ROUND,
                name,
                QUANTITIES[name].channels,
                0.0,
                amount=step * QUANTITIES[name].si_per_unit,
            )
            for name, step in self.steps.items()
        ]


def draw(number: int, seed: int, bounds: Bounds) -> Flight:
    """Draw flight `number` of a campaign's `seed`. The aircraft take turns."""
    flight = (_edge if bounds.kind == "edges" else _healthy)(number, seed, bounds)
    if bounds.kind == "airspeed":
        flight = _with_failed_airspeed(flight)
    return flight if bounds.raw_sensors is None else _with_raw_sensors(flight)


def _with_raw_sensors(flight: Flight) -> Flight:
    """Return the same flight without what raw sensors bring themselves.

    That is noise, biases, steps and the delay of measurements.
    """
    late_steps = round(flight.sensor_delay_ticks * STEPS_PER_SECOND / TRUTH_HZ)
    outputs = flight.actuation
    return replace(
        flight,
        noise=1.0,
        biases={},
        steps={},
        sensor_delay_ticks=0,
        actuation=replace(outputs, latency_steps=outputs.latency_steps + late_steps),
    )


def _edge(number: int, seed: int, bounds: Bounds) -> Flight:
    random = np.random.default_rng([seed, number])
    limits = list(AIRCRAFT.values())[number % len(AIRCRAFT)]
    loading = _loading(random, limits)
    slow_kt = limits.slow_kt(loading.weight_lb)
    # A third at the lowest speed.
    drawn_kt = float(random.uniform(1.5 * slow_kt - 0.5 * limits.fast_kt, limits.fast_kt))
    airspeed_kt = max(slow_kt, drawn_kt)
    weather = _weather(random, bounds)
    delay_s, ticks = _delay(random, bounds)
    is_pattern = bool(random.random() < 0.4)
    gusts = tuple(_gusts(random))
    noise = float(random.uniform(0.0, 1.5))
    biases = {name: float(random.uniform(-most, most)) for name, most in _WITHIN.items()}
    servo_hz = float(random.uniform(3.0, 10.0)) if random.random() < 0.7 else None
    fault = _fault(random)
    pattern = _pattern(random) if is_pattern else None
    slow_order_kt = max(slow_kt, limits.slowest_order_kt)
    return Flight(
        number=number,
        seed=seed,
        bounds=bounds,
        aircraft=limits.name,
        loading=loading,
        airspeed_kt=airspeed_kt,
        weather=weather,
        seconds=HOLD_S + LEGS * LEG_S,
        orders=() if is_pattern else tuple(_turns(random, slow_order_kt, limits.fast_kt)),
        noise=noise,
        biases={
            channel: by * _si(name)
            for name, by in biases.items()
            for channel in QUANTITIES[name].channels
        },
        sensor_delay_ticks=ticks,
        actuation=Actuation(int((delay_s - ticks / TRUTH_HZ) * STEPS_PER_SECOND), servo_hz),
        gusts=gusts,
        receiver=_receiver(np.random.default_rng([seed, number, 1])),
        fault=fault,
        pattern=pattern,
    )


def _healthy(number: int, seed: int, bounds: Bounds) -> Flight:
    random = np.random.default_rng([seed, number])
    limits = list(AIRCRAFT.values())[number % len(AIRCRAFT)]
    loading = _loading(random, limits)
    slow_kt = max(SLOWEST * limits.stall_kt(loading.weight_lb), limits.slowest_order_kt)
    delay_s, ticks = _delay(random, bounds)
    steps = _steps(random)
    noise = float(random.uniform(0.0, 2.0))
    # Half of the sensors with steps have no noise.
    is_noiseless = bool(steps) and random.random() < 0.5
    seconds = _LONG_SECONDS if number % _LONG_EACH == _LONG_EACH - 1 else _SECONDS
    return Flight(
        number=number,
        seed=seed,
        bounds=bounds,
        aircraft=limits.name,
        loading=loading,
        airspeed_kt=float(random.uniform(slow_kt, limits.fast_kt)),
        weather=_weather(random, bounds),
        seconds=seconds,
        noise=0.0 if is_noiseless else noise,
        biases={
            channel: sigma * _si(quantity) * float(random.standard_normal())
            for channel, (sigma, quantity) in _SIGMAS.items()
        },
        sensor_delay_ticks=ticks,
        actuation=Actuation(latency_steps=round((delay_s - ticks / TRUTH_HZ) * STEPS_PER_SECOND)),
        measures_position=bool(random.random() < 0.5),
        measures_trim=bool(random.random() < 0.5),
        steps=steps,
        orders=tuple(_set_points(random, seconds, slow_kt, limits.fastest_order_kt)),
    )


def _si(quantity: str) -> float:
    # Specific force is drawn in m/s² and not in g.
    return 1.0 if quantity == "specific_force" else QUANTITIES[quantity].si_per_unit


def _loading(random: np.random.Generator, limits: Limits) -> Loading:
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


def _weather(random: np.random.Generator, bounds: Bounds) -> Weather:
    return Weather(
        wind_from_deg=float(random.uniform(0.0, 360.0)),
        wind_kt=float(random.uniform(0.0, 25.0)),
        turbulence_severity=int(random.integers(0, bounds.turbulence + 1)),
    )


def _delay(random: np.random.Generator, bounds: Bounds) -> tuple[float, int]:
    """Return the delay in all, in s, and how many ticks of it are the sensors'."""
    delay_s = 1e-3 * float(random.uniform(0.0, bounds.delay_ms))
    return delay_s, int(delay_s * float(random.uniform()) * TRUTH_HZ)


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


def _side_and_climb(random: np.random.Generator) -> tuple[float, float]:
    return float(random.choice([-1.0, 1.0])), float(random.uniform(100.0, 300.0))


def _pattern(random: np.random.Generator) -> TimedPattern:
    side, climb_ft = _side_and_climb(random)
    return TimedPattern(HOLD_S, LEG_S, side * float(random.uniform(30.0, 120.0)), climb_ft)


def _turns(random: np.random.Generator, slow_kt: float, fast_kt: float) -> Iterator[Order]:
    """Yield turns and climbs: a third climbing turns at one speed, the others at random."""
    side, side_ft = _side_and_climb(random)
    is_climbing_turn = random.random() < 0.3
    # Every flight begins to the north.
    heading_deg = climb_ft = 0.0
    for begins_s in LEGS_S:
        airspeed_kt = None
        if is_climbing_turn:
            heading_deg += side * float(random.uniform(60.0, 120.0))
            climb_ft += side_ft
        else:
            changes = random.random() < 0.5
            drawn_kt = float(random.uniform(slow_kt, fast_kt))
            airspeed_kt = drawn_kt if changes else None
            heading_deg += float(random.uniform(-120.0, 120.0))
            climb_ft += float(random.uniform(-300.0, 300.0))
        yield Order(begins_s, wrap_heading(heading_deg), climb_ft, airspeed_kt)


def _steps(random: np.random.Generator) -> dict[str, float]:
    """Return the steps of quantised sensors, at least of one, in a third of the flights."""
    is_coarse = random.random() < _COARSE
    drawn = {name: float(random.choice(steps)) for name, steps in _STEPS.items()}
    keeps = [bool(random.random() < 0.5) for _ in drawn]
    first = list(drawn)[int(random.integers(len(drawn)))]
    if not is_coarse:
        return {}
    return {
        name: step
        for (name, step), kept in zip(drawn.items(), keeps, strict=True)
        if kept or name == first
    }


def _set_points(
    random: np.random.Generator, seconds: float, slow_kt: float, fast_kt: float
) -> Iterator[Order]:
    last_s = seconds - _LAST_ORDER_S
    time_s = float(random.uniform(*_ORDER_S))
    while time_s <= last_s:
        is_last = time_s == last_s
        climb_ft = _LAST_CLIMB_FT if is_last else _CLIMB_FT
        yield Order(
            time_s,
            heading_deg=float(random.uniform(0.0, 360.0)),
            climb_ft=float(random.uniform(-climb_ft, climb_ft)),
            airspeed_kt=float(random.uniform(slow_kt, fast_kt)),
            from_present=is_last,
        )
        if is_last:
            return
        time_s += float(random.uniform(*_ORDER_S))
        if time_s > last_s - _ORDER_S[0]:
            time_s = last_s


def _with_failed_airspeed(flight: Flight) -> Flight:
    """Return it with an airspeed that fails: a blocked tube, or one that is wrong for a time."""
    random = np.random.default_rng([flight.seed, flight.number, 2])
    side = float(random.choice([-1.0, 1.0]))
    if flight.number % 2 == 0:
        begins_s = TUBE_S[flight.number // 2 % len(TUBE_S)]
        return replace(
            flight,
            # In cruise: nearer to the stall 1.2 Vs cannot be kept by anyone who is misled by 10 kt.
            airspeed_kt=max(flight.airspeed_kt, _CRUISE * flight.stall_kt),
            seconds=begins_s + 90.0,
            orders=(Order(begins_s, None, side * _CLIMB_FT, None),),
            fault=Fault(TUBE, begins_s, None),
        )
    fault = Fault(
        WRONG,
        float(random.uniform(30.0, 60.0)),
        float(random.uniform(20.0, 40.0)),
        side * float(random.uniform(10.0, 25.0)),
    )
    return replace(flight, fault=fault)
