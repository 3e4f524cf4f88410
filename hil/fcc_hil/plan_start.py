"""Where a flight with a plan begins."""

from __future__ import annotations

import math
from dataclasses import replace

from .plan_file import TAKEOFF, Item, PlanFile
from .plant import Plant, Weather
from .settings import Settings, Start
from .terrain_tiles import Tiles
from .units import FT_TO_M


def takes_off(plan: PlanFile) -> bool:
    """Return whether the plan begins with a take-off."""
    return plan.items[0].command == TAKEOFF


def settings(plan: PlanFile, simulator: Settings) -> Settings:
    """Return a simulator whose aircraft begins there, towards the plan's first place.

    In flight over the plan's home, or on its wheels if the plan begins with a take-off.
    """
    home, off = plan.home, takes_off(plan)
    first = plan.items[0] if off else next(i for i in plan.items if i.has_place)
    elevation_ft = home.altitude_m / FT_TO_M if off else None
    return replace(
        simulator,
        start=Start(home.latitude_deg, home.longitude_deg, elevation_ft),
        heading_deg=_bearing_deg(home, first),
    )


def plant(
    plan: PlanFile, aircraft: str, *, seed: int, weather: Weather, terrain: Tiles | None = None
) -> Plant:
    """Return an aircraft that begins there, on the ground of `terrain`."""
    begins = settings(plan, Settings())
    start = begins.start
    elevation_ft = start.runway_elevation_ft
    if terrain is not None and elevation_ft is not None:
        known_m = terrain.elevation_m(start.latitude_deg, start.longitude_deg)
        elevation_ft = elevation_ft if known_m is None else known_m / FT_TO_M
    begun = Plant(
        aircraft,
        seed=seed,
        weather=weather,
        heading_deg=begins.heading_deg,
        latitude_deg=start.latitude_deg,
        longitude_deg=start.longitude_deg,
        runway_elevation_ft=elevation_ft,
    )
    if terrain is not None:
        begun.fly_over(terrain)
    return begun


def _bearing_deg(start: Item, end: Item) -> float:
    north = end.latitude_deg - start.latitude_deg
    east = (end.longitude_deg - start.longitude_deg) * math.cos(math.radians(start.latitude_deg))
    return math.degrees(math.atan2(east, north)) % 360.0
