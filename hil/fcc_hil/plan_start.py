"""Where a flight with a plan begins."""

from __future__ import annotations

import math

from .plan_file import TAKEOFF, Item, PlanFile
from .plant import Plant, Weather
from .terrain_tiles import Tiles
from .units import FT_TO_M


def takes_off(plan: PlanFile) -> bool:
    """Return whether the plan begins with a take-off."""
    return plan.items[0].command == TAKEOFF


def plant(
    plan: PlanFile, aircraft: str, *, seed: int, weather: Weather, terrain: Tiles | None = None
) -> Plant:
    """Return an aircraft in level flight over the plan's home, towards its first place.

    On its wheels there if the plan begins with a take-off, on the ground of `terrain`.
    """
    home = plan.home
    known_m = terrain and terrain.elevation_m(home.latitude_deg, home.longitude_deg)
    elevation_m = home.altitude_m if known_m is None else known_m
    first = plan.items[0] if takes_off(plan) else next(i for i in plan.items if i.has_place)
    begun = Plant(
        aircraft,
        seed=seed,
        weather=weather,
        heading_deg=_bearing_deg(plan.home, first),
        latitude_deg=plan.home.latitude_deg,
        longitude_deg=plan.home.longitude_deg,
        runway_elevation_ft=elevation_m / FT_TO_M if takes_off(plan) else None,
    )
    if terrain is not None:
        begun.fly_over(terrain)
    return begun


def _bearing_deg(start: Item, end: Item) -> float:
    north = end.latitude_deg - start.latitude_deg
    east = (end.longitude_deg - start.longitude_deg) * math.cos(math.radians(start.latitude_deg))
    return math.degrees(math.atan2(east, north)) % 360.0
