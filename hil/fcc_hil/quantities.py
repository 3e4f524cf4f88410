"""The quantities of a flight, with their units and where they are found.

    altitude                      in feet
    altitude("m")                 in metres
    abs(bank) > 35                a condition, for `flight.never(...)`

A quantity has a column of the truth, for requirements, or channels of the sensors, for faults, or
both.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from .units import FT_TO_M, KT_TO_MPS, STANDARD_GRAVITY_MPS2

Samples = npt.NDArray[np.float64]

_ANGLE = {"deg": 1.0, "rad": math.radians(1.0)}
_TURN_RATE = {"deg/s": 1.0, "rad/s": math.radians(1.0)}
_HEIGHT = {"ft": 1.0, "m": FT_TO_M}
_SPEED = {"kt": 1.0, "m/s": KT_TO_MPS, "km/h": 1.852}
_CLIMB = {"ft/min": 1.0, "m/s": FT_TO_M / 60.0}
_FORCE = {"g": 1.0, "m/s2": STANDARD_GRAVITY_MPS2}
_VOLTAGE = {"V": 1.0}
_DISTANCE = {"m": 1.0}
_OVER_GROUND = {"m/s": 1.0}
_SHAFT = {"rpm": 1.0, "rad/s": math.tau / 60.0}
_FRACTION = {"": 1.0}


def finite(name: str, value: object) -> float:
    """Return an argument as a number, or raise TypeError or ValueError with its name."""
    if isinstance(value, bool) or not isinstance(value, (int, float, np.integer, np.floating)):
        raise TypeError(f"{name} is {value!r}: give a number")
    number = float(value)
    if not math.isfinite(number):
        raise ValueError(f"{name} is {number}: give a finite number")
    return number


@dataclass(frozen=True, eq=False)
class Quantity:
    """A quantity in one of its units."""

    name: str
    unit: str
    units: Mapping[str, float]
    """The size of the first unit in each unit."""
    column: str | None = None
    """The column of the truth, in the first unit; None if it is not a single number."""
    channels: tuple[str, ...] = ()
    """The fields of `state.State` measured by sensors; empty if there are none."""
    circle: float | None = None
    """A full turn, in the first unit."""
    is_absolute: bool = False
    """Whether its magnitude is meant."""

    def __call__(self, unit: str) -> Quantity:
        """Return it in another unit."""
        if unit not in self.units:
            known = " or ".join(repr(known) for known in self.units)
            raise ValueError(f"{self.name} is measured in {known}, not in {unit!r}")
        return replace(self, unit=unit)

    def __abs__(self) -> Quantity:
        """Return its magnitude."""
        return replace(self, is_absolute=True)

    def __gt__(self, limit: float) -> Condition:
        return Condition(self, "above", finite("limit", limit))

    def __lt__(self, limit: float) -> Condition:
        return Condition(self, "below", finite("limit", limit))

    def __str__(self) -> str:
        return f"|{self.name}|" if self.is_absolute else self.name

    @property
    def si_per_unit(self) -> float:
        """Return how many of SI's units (rad, m, m/s, m/s²) its unit is."""
        si = list(self.units.values())[1] if len(self.units) > 1 else 1.0
        return si / self.units[self.unit]

    def of(self, columns: Callable[[str], Samples]) -> Samples:
        """Return its values, by the columns of a truth."""
        if self.column is None:
            raise ValueError(f"{self.name} is not a single number: use one of its parts")
        values = columns(self.column) * self.units[self.unit]
        return np.abs(values) if self.is_absolute else values

    def difference(self, of: Samples, to: Samples | float) -> Samples:
        """Return `of` minus `to` in its unit; for a direction, the shorter way."""
        off = np.asarray(of - to, dtype=np.float64)
        if self.circle is None:
            return off
        circle = self.circle * self.units[self.unit]
        return (off + circle / 2.0) % circle - circle / 2.0

    def words(self, value: float, digits: int = 1) -> str:
        """Return a value with its unit, as text."""
        if not self.unit:
            digits += 1
        return f"{value:.{digits}f} {self.unit}".rstrip()


@dataclass(frozen=True)
class Condition:
    """A quantity above or below a limit."""

    quantity: Quantity
    side: str
    """above or below."""
    limit: float

    def __bool__(self) -> bool:
        raise TypeError(
            f"'{self}' is a condition for flight.never(...), neither true nor false by itself; "
            "give two limits as two requirements"
        )

    def __str__(self) -> str:
        return f"{self.quantity} {self.side} {self.quantity.words(self.limit)}"

    def holds(self, values: Samples) -> npt.NDArray[np.bool_]:
        """Return at which values it holds."""
        return values > self.limit if self.side == "above" else values < self.limit


def _angle(name: str, column: str, channel: str, circle: float | None = None) -> Quantity:
    return Quantity(name, "deg", _ANGLE, column, (channel,), circle)


def _rate(name: str, *channels: str) -> Quantity:
    return Quantity(name, "deg/s", _TURN_RATE, None, channels)


_RATES = ("roll_rate_radps", "pitch_rate_radps", "yaw_rate_radps")
_FORCES = ("specific_force_x_mps2", "specific_force_y_mps2", "specific_force_z_mps2")

heading = _angle("heading", "heading_deg", "heading_rad", circle=360.0)
altitude = Quantity("altitude", "ft", _HEIGHT, "altitude_ft", ("altitude_m",))
airspeed = Quantity("airspeed", "kt", _SPEED, "airspeed_kt", ("airspeed_mps",))
bank = _angle("bank", "roll_deg", "roll_rad")
pitch = _angle("pitch", "pitch_deg", "pitch_rad")
climb = Quantity("climb", "ft/min", _CLIMB, "climb_fpm")
lateral = Quantity("lateral", "g", _FORCE, "lateral_g", (_FORCES[1],))
elevator = Quantity("elevator", "", _FRACTION, "elevator")
aileron = Quantity("aileron", "", _FRACTION, "aileron")
rudder = Quantity("rudder", "", _FRACTION, "rudder")
throttle = Quantity("throttle", "", _FRACTION, "throttle")
attitude = Quantity("attitude", "deg", _ANGLE, None, ("pitch_rad", "roll_rad"))
body_rates = _rate("body_rates", *_RATES)
roll_rate = _rate("roll_rate", _RATES[0])
pitch_rate = _rate("pitch_rate", _RATES[1])
yaw_rate = _rate("yaw_rate", _RATES[2])
specific_force = Quantity("specific_force", "g", _FORCE, None, _FORCES)
battery = Quantity("battery", "V", _VOLTAGE, None, ("battery_voltage_v",))
position = Quantity(
    "position", "m", _DISTANCE, None, ("latitude_rad", "longitude_rad", "elevation_m")
)
velocity = Quantity("velocity", "m/s", _OVER_GROUND, None, ("north_mps", "east_mps", "down_mps"))
engine_speed = Quantity("engine_speed", "rpm", _SHAFT, None, ("engine_speed_radps",))
weight_on_wheels = Quantity("weight_on_wheels", "", _FRACTION, None, ("on_ground",))

QUANTITIES: dict[str, Quantity] = {
    quantity.name: quantity
    for quantity in (
        *(heading, altitude, airspeed, bank, pitch, climb, lateral),
        *(elevator, aileron, rudder, throttle),
        *(attitude, body_rates, roll_rate, pitch_rate, yaw_rate, specific_force, battery),
        *(position, velocity, engine_speed, weight_on_wheels),
    )
}

SENSORS: dict[str, tuple[str, ...]] = {
    quantity.name: quantity.channels
    for quantity in (attitude, heading, body_rates, specific_force, airspeed, altitude)
}
"""The sensors that the autopilot flies by, with their channels."""

READINGS = SENSORS | {
    quantity.name: quantity.channels
    for quantity in (battery, position, velocity, engine_speed, weight_on_wheels)
}
"""Everything that is measured and can have a fault."""


def quantity_of(given: Quantity | str) -> Quantity:
    """Return a quantity given by itself or by its name; ValueError lists the names."""
    if isinstance(given, Quantity):
        return given
    if isinstance(given, str) and given in QUANTITIES:
        return QUANTITIES[given]
    raise ValueError(f"there is no quantity {given!r}; choose one of {', '.join(QUANTITIES)}")


_LONGEST_S = 24 * 3_600.0


def seconds(name: str, value: object) -> float:
    """Return a time in s; raise ValueError or TypeError for what is none."""
    value_s = finite(name, value)
    if not 0.0 <= value_s <= _LONGEST_S:
        raise ValueError(f"{name} is {value_s:g} s: give 0 to {_LONGEST_S:g}")
    return value_s


def positive(name: str, value: object) -> float:
    """Return a number greater than 0; raise ValueError or TypeError for another one."""
    number = finite(name, value)
    if number <= 0.0:
        raise ValueError(f"{name} is {number:g}: give more than 0")
    return number
