"""How well a plan was flown, from the truth.

The places are those of the plan's file, the positions those of the simulator; of the autopilot only
which item it flies, and the course of its path, which says when a turn is over.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from .clearance import TerrainScore
from .flown_plan import FlownPlan
from .plan_arcs import ON_COURSE_RAD, CircleScore, TurnScore, score_circle, score_turn, within_pi
from .plan_file import LAND, LOITERS, TAKEOFF, WAYPOINT, Item, PlanFile
from .tangent_plane import Array, Plane
from .units import FT_TO_M, KT_TO_MPS

_BOUNCES = 800
"""Touches within so many rows, 20 s, of one another are one landing."""


@dataclass(frozen=True)
class WaypointScore:
    """How a waypoint was passed."""

    item: int
    passed: bool
    closest_m: float
    altitude_error_ft: float


@dataclass(frozen=True)
class LegScore:
    """How a leg to an item was flown, from the end of a turn to the begin of the next."""

    item: int
    seconds: float
    cross_track_rms_m: float
    cross_track_max_m: float
    altitude_rms_ft: float
    """Against the altitude that was demanded along it."""
    altitude_max_ft: float
    airspeed_error_kt: float
    """The largest of a second's mean."""


@dataclass(frozen=True)
class TakeoffScore:
    """How a take-off was flown, on the wheels."""

    centre_line_m: float
    """The largest distance from the line from home to the item's place."""
    run_m: float
    heading_error_deg: float
    """When the wheels left the ground."""


@dataclass(frozen=True)
class LandingScore:
    """How a landing was flown."""

    centre_line_m: float
    """Where the wheels touched, to the right of the centre line."""
    along_m: float
    """Behind the point that was aimed at."""
    sink_fpm: float
    heading_error_deg: float
    bank_deg: float
    roll_out_m: float
    """The largest distance from the centre line until it stood."""
    stops_m: float
    """Behind the point that was aimed at."""
    go_arounds: int


@dataclass(frozen=True)
class PlanScore:
    """How well a plan was flown."""

    waypoints: list[WaypointScore]
    legs: list[LegScore]
    turns: list[TurnScore]
    circles: list[CircleScore]
    takeoff: TakeoffScore | None = None
    landing: LandingScore | None = None
    lands: bool = False
    """Whether the plan has a landing."""
    terrain: TerrainScore | None = None
    """Where the ground is that of tiles."""

    def document(self) -> dict[str, Any]:
        """Return it for JSON."""
        return asdict(self)

    @property
    def missing(self) -> list[str]:
        """What of the plan was not flown, in words."""
        words = [f"item {one.item} was not passed" for one in self.waypoints if not one.passed]
        if self.lands and self.landing is None:
            words.append("the landing was not flown: at the end the aircraft does not stand")
        if self.terrain is not None and self.terrain.collides:
            words.append("the ground was flown into")
        return words


def _plane(item: Item) -> Plane:
    return Plane(math.radians(item.latitude_deg), math.radians(item.longitude_deg))


def score(
    plan: PlanFile,
    flown: FlownPlan,
    reached: dict[int, float],
    loiter_m: float,
    go_arounds: int = 0,
) -> PlanScore:
    """Score a flight.

    `reached` says when the autopilot reported each item, `loiter_m` is the radius of a circle for
    which the plan gives none.
    """
    flights = [item for item in plan.items if item.has_place]
    waypoints, legs, circles = [], [], []
    corners = zip(flights, flights[1:], flights[2:], strict=False)
    turns = [score_turn(*places, flown) for places in corners]
    before: Item | None = None
    takeoff: TakeoffScore | None = None
    for item in plan.items:
        if item.command == TAKEOFF and item.latitude_deg:
            takeoff = _takeoff(plan.home, item, flown)
    for item in flights:
        if item.command == WAYPOINT:
            waypoints.append(_waypoint(item, flown, reached))
            if before is not None and before.command == WAYPOINT:
                legs.append(_leg(before, item, flown))
        elif item.command in LOITERS:
            circles.append(score_circle(item, flown, item.radius_m or loiter_m))
        before = item
    landing = score_landing(plan, flown, go_arounds)
    kept = [leg for leg in legs if leg.seconds > 0.0]
    return PlanScore(
        waypoints,
        kept,
        [turn for turn in turns if turn],
        circles,
        takeoff,
        landing,
        lands=any(item.command == LAND for item in flights),
    )


def _along(start: Item, end: Item, at: Item, flown: FlownPlan) -> tuple[float, Array, Array]:
    """Return the course from start to end, and across and along it from a place of it."""
    plane = _plane(at)
    ends = plane.of(
        np.radians([start.latitude_deg, end.latitude_deg]),
        np.radians([start.longitude_deg, end.longitude_deg]),
    )
    course = (ends[1] - ends[0]) / np.hypot(*(ends[1] - ends[0]))
    where = plane.of(flown.latitude_rad, flown.longitude_rad)
    across = course[0] * where[:, 1] - course[1] * where[:, 0]
    return math.atan2(course[1], course[0]), across, where @ course


def _heading_error_deg(flown: FlownPlan, index: int, course_rad: float) -> float:
    off = float(flown.heading_rad[index]) - course_rad
    return math.degrees(math.atan2(math.sin(off), math.cos(off)))


def _takeoff(home: Item, item: Item, flown: FlownPlan) -> TakeoffScore | None:
    on_ground = flown.on_ground > 0.0
    if not on_ground[0] or on_ground.all():
        return None
    left = int(np.argmin(on_ground))
    course_rad, across, along = _along(home, item, home, flown)
    return TakeoffScore(
        float(np.max(np.abs(across[:left]))),
        float(along[left] - along[0]),
        _heading_error_deg(flown, left, course_rad),
    )


def score_landing(plan: PlanFile, flown: FlownPlan, go_arounds: int) -> LandingScore | None:
    """Score the plan's last landing; return None without one, or if it does not stand."""
    flights = [item for item in plan.items if item.has_place]
    pairs = [ends for ends in itertools.pairwise(flights) if ends[1].command == LAND]
    return _landing(*pairs[-1], flown, go_arounds) if pairs else None


def _landing(start: Item, item: Item, flown: FlownPlan, go_arounds: int) -> LandingScore | None:
    on_ground = flown.on_ground > 0.0
    in_air = np.flatnonzero(~on_ground)
    if not len(in_air) or not on_ground[-1]:
        return None
    # The first touch of the last landing: a bounce is not another one.
    touches = np.flatnonzero(on_ground[1:] & ~on_ground[:-1]) + 1
    touch = int(touches[np.searchsorted(touches, in_air[-1] - _BOUNCES)])
    course_rad, across, along = _along(start, item, item, flown)
    return LandingScore(
        float(across[touch]),
        float(along[touch]),
        float(np.max(flown.down_mps[touch - 2 : touch + 1])) * 60.0 / FT_TO_M,
        _heading_error_deg(flown, touch, course_rad),
        math.degrees(float(flown.roll_rad[touch])),
        float(np.max(np.abs(across[touch:]))),
        float(along[-1]),
        go_arounds,
    )


def _waypoint(item: Item, flown: FlownPlan, reached: dict[int, float]) -> WaypointScore:
    away = np.hypot(*_plane(item).of(flown.latitude_rad, flown.longitude_rad).T)
    when = reached.get(item.number)
    # A place may be flown over twice.
    near = np.ones(len(away), bool) if when is None else np.abs(flown.time_s - when) < 60.0
    index = int(np.argmin(np.where(near, away, np.inf)))
    closest = float(away[index])
    within = item.radius_m or math.inf
    return WaypointScore(
        item.number,
        when is not None and closest <= within,
        closest,
        float(flown.elevation_m[index] - item.altitude_m) / FT_TO_M,
    )


def _leg(start: Item, end: Item, flown: FlownPlan) -> LegScore:
    course_rad, across, _ = _along(start, end, end, flown)
    off = within_pi(flown.course_rad - course_rad)
    on = (flown.item == end.number) & (np.abs(off) < ON_COURSE_RAD)
    cross = across[on]
    if not len(cross):
        return LegScore(end.number, 0.0, *[math.nan] * 5)
    altitude = (flown.elevation_m - flown.altitude_demand_m)[on] / FT_TO_M
    airspeed = (flown.airspeed_mps - flown.airspeed_demand_mps)[on] / KT_TO_MPS
    tick_s = float(np.median(np.diff(flown.time_s)))
    second = max(1, round(1.0 / tick_s))
    whole = airspeed[: len(airspeed) // second * second].reshape(-1, second)
    return LegScore(
        end.number,
        len(cross) * tick_s,
        float(np.sqrt(np.mean(cross**2))),
        float(np.max(np.abs(cross))),
        float(np.sqrt(np.mean(altitude**2))),
        float(np.max(np.abs(altitude))),
        float(np.max(np.abs(whole.mean(axis=1)))) if len(whole) else math.nan,
    )
