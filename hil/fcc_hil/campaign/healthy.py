"""Draws the healthy campaign: ordinary sensor errors, random set points, nothing that fails."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from ..actuation import Actuation
from ..faulty_sensors import Kind, SensorFault
from ..plant import STEPS_PER_SECOND, Weather
from ..quantities import QUANTITIES
from ..truth import TRUTH_HZ
from .aircraft import AIRCRAFT
from .draw import RAW_RECEIVER, Bounds, Fault, Flight, draw_loading, with_raw_sensors

SECONDS, LONG_SECONDS, LONG_EACH = 310.0, 600.0, 4
"""Every fourth flight is a long one."""
ORDER_S = (8.0, 45.0)
LAST_ORDER_S = 75.0
"""Before the end: a turn by 180° at the largest bank takes 40 s at 135 kt, and 30 s are judged."""
_CLIMB_FT = 1_500.0
"""Around the first altitude, 3,000 ft above level ground."""
_LAST_CLIMB_FT = 150.0
"""Around the altitude at the last order, so that it stands when it is judged."""

BIASES = {
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
"""By channel: 1 sigma in °, °/s, m/s², kt, ft; and the quantity, whose unit it is."""

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
TUBE, WRONG = "pitot tube blocked", "airspeed wrong for a time"


@dataclass(frozen=True)
class SetPointOrder:
    """Set points from a time on; what is None stays."""

    time_s: float
    """Since engaging."""
    heading_deg: float | None
    climb_ft: float | None
    """Above the altitude at which the flight was engaged, or the present one."""
    airspeed_kt: float | None
    from_present: bool = False


@dataclass(frozen=True, kw_only=True)
class HealthyFlight(Flight):
    """The conditions of a flight of which all sensors are healthy, or the airspeed is not."""

    seconds: float
    set_points: tuple[SetPointOrder, ...]
    measures_position: bool
    """Position and velocity over the ground."""
    measures_trim: bool
    steps: dict[str, float]
    """Of sensors that are quantised, by their quantities, in kt, ft and °."""

    @property
    def biases_in_sigma(self) -> dict[str, float]:
        """Return the biases by channel, as multiples of what they are drawn with."""
        return {
            channel: by / (BIASES[channel][0] * _si(BIASES[channel][1]))
            for channel, by in self.biases.items()
        }

    def errors(self) -> list[SensorFault]:
        """Return the steps, as the sensors have them."""
        return [
            SensorFault(
                Kind.ROUND,
                name,
                QUANTITIES[name].channels,
                0.0,
                amount=step * QUANTITIES[name].si_per_unit,
            )
            for name, step in self.steps.items()
        ]


def draw(number: int, seed: int, bounds: Bounds) -> HealthyFlight:
    """Draw flight `number` of a campaign's `seed`. The aircraft take turns."""
    flight = _draw(number, seed, bounds)
    if bounds.kind == "airspeed":
        flight = _with_fault(flight)
    if bounds.raw_sensors is None:
        return flight
    receiver = RAW_RECEIVER if flight.measures_position else None
    return replace(with_raw_sensors(flight), steps={}, receiver=receiver)


def _draw(number: int, seed: int, bounds: Bounds) -> HealthyFlight:
    random = np.random.default_rng([seed, number])
    limits = list(AIRCRAFT.values())[number % len(AIRCRAFT)]
    loading = draw_loading(random, limits)
    slow_kt = max(1.3 * limits.stall_kt(loading.weight_lb), limits.slowest_order_kt)
    delay_s = 1e-3 * float(random.uniform(0.0, bounds.delay_ms))
    ticks = int(delay_s * float(random.uniform()) * TRUTH_HZ)
    steps = _steps(random)
    noise = float(random.uniform(0.0, 2.0))
    # Half of the sensors with steps have no noise.
    is_noiseless = bool(steps) and random.random() < 0.5
    seconds = LONG_SECONDS if number % LONG_EACH == LONG_EACH - 1 else SECONDS
    return HealthyFlight(
        number=number,
        seed=seed,
        bounds=bounds,
        aircraft=limits.name,
        loading=loading,
        airspeed_kt=float(random.uniform(slow_kt, limits.fast_kt)),
        weather=Weather(
            wind_from_deg=float(random.uniform(0.0, 360.0)),
            wind_kt=float(random.uniform(0.0, 25.0)),
            turbulence_severity=int(random.integers(0, bounds.turbulence + 1)),
        ),
        gusts=(),
        noise=0.0 if is_noiseless else noise,
        biases={
            channel: sigma * _si(quantity) * float(random.standard_normal())
            for channel, (sigma, quantity) in BIASES.items()
        },
        sensor_delay_ticks=ticks,
        actuation=Actuation(latency_steps=round((delay_s - ticks / TRUTH_HZ) * STEPS_PER_SECOND)),
        receiver=None,
        fault=None,
        is_pattern=False,
        orders=(),
        seconds=seconds,
        measures_position=bool(random.random() < 0.5),
        measures_trim=bool(random.random() < 0.5),
        steps=steps,
        set_points=tuple(_set_points(random, seconds, slow_kt, limits.fastest_order_kt)),
    )


def _si(quantity: str) -> float:
    # Specific force is drawn in m/s² and not in g.
    return 1.0 if quantity == "specific_force" else QUANTITIES[quantity].si_per_unit


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
) -> Iterator[SetPointOrder]:
    last_s = seconds - LAST_ORDER_S
    time_s = float(random.uniform(*ORDER_S))
    while time_s <= last_s:
        is_last = time_s == last_s
        climb_ft = _LAST_CLIMB_FT if is_last else _CLIMB_FT
        yield SetPointOrder(
            time_s,
            heading_deg=float(random.uniform(0.0, 360.0)),
            climb_ft=float(random.uniform(-climb_ft, climb_ft)),
            airspeed_kt=float(random.uniform(slow_kt, fast_kt)),
            from_present=is_last,
        )
        if is_last:
            return
        time_s += float(random.uniform(*ORDER_S))
        if time_s > last_s - ORDER_S[0]:
            time_s = last_s


def _with_fault(flight: HealthyFlight) -> HealthyFlight:
    """Return it with an airspeed that fails: a blocked tube, or one that is wrong for a time."""
    random = np.random.default_rng([flight.seed, flight.number, 2])
    side = float(random.choice([-1.0, 1.0]))
    if flight.number % 2 == 0:
        begins_s = TUBE_S[flight.number // 2 % len(TUBE_S)]
        order = SetPointOrder(begins_s, None, side * _CLIMB_FT, None)
        fault = Fault(TUBE, begins_s, None)
        # In cruise: nearer to the stall 1.2 Vs cannot be kept by anyone who is misled by 10 kt.
        airspeed_kt = max(flight.airspeed_kt, _CRUISE * flight.stall_kt)
        return replace(
            flight,
            airspeed_kt=airspeed_kt,
            seconds=begins_s + 90.0,
            set_points=(order,),
            fault=fault,
        )
    fault = Fault(
        WRONG,
        float(random.uniform(30.0, 60.0)),
        float(random.uniform(20.0, 40.0)),
        side * float(random.uniform(10.0, 25.0)),
    )
    return replace(flight, fault=fault)
