"""A flight of a plan, as it is scored: the truth, and what the autopilot says of its path."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from .tangent_plane import Array, away_m
from .truth import Truth
from .units import FT_TO_M, KT_TO_MPS


@dataclass(frozen=True)
class FlownPlan:
    """A flight, a row for each tick."""

    time_s: Array
    latitude_rad: Array
    longitude_rad: Array
    elevation_m: Array
    airspeed_mps: Array
    roll_rad: Array
    item: Array
    """The item that the autopilot flies."""
    course_rad: Array
    """The course of its path."""
    airspeed_demand_mps: Array
    altitude_demand_m: Array
    heading_rad: Array
    down_mps: Array
    on_ground: Array
    height_m: Array
    """Above the ground."""


def of_truth(truth: Truth) -> FlownPlan:
    """Return what the truth says of a flight: nothing of what the autopilot demanded."""
    nothing = np.zeros_like(truth["time_s"])
    return FlownPlan(
        time_s=truth["time_s"],
        latitude_rad=np.radians(truth["latitude_deg"]),
        longitude_rad=np.radians(truth["longitude_deg"]),
        elevation_m=truth["altitude_ft"] * FT_TO_M,
        airspeed_mps=truth["airspeed_kt"] * KT_TO_MPS,
        roll_rad=np.radians(truth["roll_deg"]),
        item=nothing,
        course_rad=nothing,
        airspeed_demand_mps=nothing,
        altitude_demand_m=nothing,
        heading_rad=np.radians(truth["heading_deg"]),
        down_mps=-truth["climb_fpm"] * FT_TO_M / 60.0,
        on_ground=truth["on_ground"],
        height_m=truth["height_ft"] * FT_TO_M,
    )


def go_arounds(modes: Sequence[str]) -> int:
    """Return how often a landing was given up, by the mode of each row."""
    changes = itertools.pairwise(modes)
    return sum(before != "go-around" and mode == "go-around" for before, mode in changes)


def moved_m(flown: FlownPlan, rows: int) -> float:
    """Return how far the aircraft has moved in the last rows."""
    last = slice(-rows - 1, None, rows)
    track = np.degrees(flown.latitude_rad[last]), np.degrees(flown.longitude_rad[last])
    return float(away_m(float(track[0][-1]), float(track[1][-1]), track)[0])
