"""Where a flight with a plan begins."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np

from .plan_file import TAKEOFF, Item, PlanFile
from .plant import Plant, Weather
from .settings import Settings, Start
from .tangent_plane import Plane
from .terrain_tiles import Tiles
from .units import FT_TO_M


def takes_off(plan: PlanFile) -> bool:
    """Return whether the plan begins with a take-off."""
    return plan.items[0].command == TAKEOFF


def settings(plan: PlanFile, simulator: Settings) -> Settings:
    """Return a simulator whose aircraft begins there, towards the plan's first place.

    In flight over the plan's home, or on its wheels if the plan begins with a take-off; there it
    stands on the ground of the simulator's terrain.
    """
    home, off = plan.home, takes_off(plan)
    first = plan.items[0] if off else next(i for i in plan.items if i.has_place)
    elevation_ft = home.altitude_m / FT_TO_M if off else None
    if simulator.terrain is not None and elevation_ft is not None:
        tiles = Tiles(simulator.terrain)
        elevation_ft = tiles.runway_ft(home.latitude_deg, home.longitude_deg, elevation_ft)
    return replace(
        simulator,
        start=Start(home.latitude_deg, home.longitude_deg, elevation_ft),
        heading_deg=_bearing_deg(home, first),
    )


def plant(
    plan: PlanFile, aircraft: str, *, seed: int, weather: Weather, terrain: Path | None = None
) -> Plant:
    """Return an aircraft that begins there, on the ground of `terrain`."""
    begins = settings(plan, Settings(terrain=terrain))
    start = begins.start
    begun = Plant(
        aircraft,
        seed=seed,
        weather=weather,
        heading_deg=begins.heading_deg,
        latitude_deg=start.latitude_deg,
        longitude_deg=start.longitude_deg,
        runway_elevation_ft=start.runway_elevation_ft,
    )
    if terrain is not None:
        begun.fly_over(Tiles(terrain))
    return begun


def _bearing_deg(start: Item, end: Item) -> float:
    plane = Plane(math.radians(start.latitude_deg), math.radians(start.longitude_deg))
    place = np.radians([end.latitude_deg]), np.radians([end.longitude_deg])
    ((north_m, east_m),) = plane.of(*place)
    return math.degrees(math.atan2(east_m, north_m)) % 360.0
