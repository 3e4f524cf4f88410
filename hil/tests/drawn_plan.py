"""Plans that a flight draws: their places are metres north and east of a place at 47 degrees."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

from fcc_hil.plan_file import LAND, WAYPOINT

LATITUDE_DEG, LONGITUDE_DEG = 47.0, 8.0
"""Of the place that they are counted from."""
_METRES_PER_DEGREE = 111_170.0
"""Of latitude at 47 degrees."""
LANDING_START = 189

Metres = tuple[float, float]
"""North and east."""


@dataclass(frozen=True)
class Drawn:
    """An item of a plan; the first one is home."""

    command: int
    at_m: Metres
    altitude_m: float
    parameters: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0)


def place(at_m: Metres) -> tuple[float, float]:
    """Return latitude and longitude, degrees."""
    across = _METRES_PER_DEGREE * math.cos(math.radians(LATITUDE_DEG))
    return LATITUDE_DEG + at_m[0] / _METRES_PER_DEGREE, LONGITUDE_DEG + at_m[1] / across


def ahead(from_m: Metres, bearing_deg: float, way_m: float) -> Metres:
    """Return the place so far away in a direction."""
    bearing = math.radians(bearing_deg)
    return from_m[0] + way_m * math.cos(bearing), from_m[1] + way_m * math.sin(bearing)


def waypoints(home: Metres, altitude_m: float, *places: Metres) -> list[Drawn]:
    """Return home and waypoints, all at one altitude."""
    return [Drawn(WAYPOINT, at_m, altitude_m) for at_m in (home, *places)]


def landing(approach_m: float, height_m: float) -> list[Drawn]:
    """Return the landing at the origin, to the north at sea level, from so far south of it."""
    begins = (-approach_m, 0.0)
    return [
        Drawn(LANDING_START, begins, height_m),
        Drawn(WAYPOINT, begins, height_m),
        Drawn(LAND, (0.0, 0.0), 0.0),
    ]


def text(items: Iterable[Drawn]) -> str:
    """Return a plan as QGC WPL 110."""
    lines = ["QGC WPL 110"]
    for number, item in enumerate(items):
        latitude, longitude = place(item.at_m)
        parameters = " ".join(f"{value:.3f}" for value in item.parameters)
        lines.append(
            f"{number} 0 0 {item.command} {parameters} {latitude:.9f} {longitude:.9f} "
            f"{item.altitude_m:.3f} 1"
        )
    return "\n".join(lines) + "\n"
