"""Where a flight with a plan begins."""

from __future__ import annotations

import math

from .plan_file import TAKEOFF, Item, PlanFile
from .plant import Plant, Weather
from .units import FT_TO_M


def takes_off(plan: PlanFile) -> bool:
    """Return whether the plan begins with a take-off."""
    return plan.items[0].command == TAKEOFF


def plant(plan: PlanFile, aircraft: str, *, seed: int, weather: Weather) -> Plant:
    """Return an aircraft in level flight over the plan's home, towards its first place.

    On its wheels there if the plan begins with a take-off.
    """
    first = plan.items[0] if takes_off(plan) else next(i for i in plan.items if i.has_place)
    return Plant(
        aircraft,
        seed=seed,
        weather=weather,
        heading_deg=_bearing_deg(plan.home, first),
        latitude_deg=plan.home.latitude_deg,
        longitude_deg=plan.home.longitude_deg,
        runway_elevation_ft=plan.home.altitude_m / FT_TO_M if takes_off(plan) else None,
    )


def _bearing_deg(start: Item, end: Item) -> float:
    north = end.latitude_deg - start.latitude_deg
    east = (end.longitude_deg - start.longitude_deg) * math.cos(math.radians(start.latitude_deg))
    return math.degrees(math.atan2(east, north)) % 360.0
