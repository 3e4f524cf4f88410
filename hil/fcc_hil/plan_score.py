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
import numpy.typing as npt

from .clearance import TerrainScore
from .plan_file import LAND, LOITERS, TAKEOFF, WAYPOINT, Item, PlanFile
from .truth import Truth
from .units import FT_TO_M, KT_TO_MPS

Array = npt.NDArray[np.float64]

_SEMI_MAJOR_M = 6_378_137.0
_ECCENTRICITY_2 = 6.694_379_990_14e-3
_ON_COURSE_RAD = math.radians(1.0)
"""The path has the course of the leg within this: the rest is a turn."""
_BOUNCES = 800
"""Touches within so many rows, 20 s, of one another are one landing."""
_MOST_FLY_BY_RAD = math.radians(91.0)
"""A turn that is flown before its waypoint: right angles on a map are a little more than 90°."""
_OVERSHOOT_RAD = math.radians(3.0)
"""The path's course goes farther than this beyond that of the next leg: it is flown over."""
_ON_CIRCLE = 0.2
"""A circle is flown from where the aircraft is within this share of its radius."""


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
class TurnScore:
    """How the arc before a waypoint was flown, which touches both legs."""

    item: int
    degrees: float
    radius_m: float
    """That by which the path's course changes along the way."""
    cross_track_rms_m: float
    cross_track_max_m: float
    bank_max_deg: float


@dataclass(frozen=True)
class CircleScore:
    """How a circle was flown."""

    item: int
    seconds: float
    radius_m: float
    radius_error_max_percent: float
    bank_max_deg: float


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
    terrain: TerrainScore | None = None
    """Where the ground is that of tiles."""

    def document(self) -> dict[str, Any]:
        """Return it for JSON."""
        return asdict(self)


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
    )


def moved_m(flown: FlownPlan, rows: int) -> float:
    """Return how far the aircraft has moved in the last rows."""
    last = slice(-rows - 1, None, rows)
    track = np.degrees(flown.latitude_rad[last]), np.degrees(flown.longitude_rad[last])
    return float(away_m(float(track[0][-1]), float(track[1][-1]), track)[0])


class Plane:
    """Metres north and east of a place on WGS-84: its tangent plane, good to 1 cm in 10 km."""

    def __init__(self, latitude_rad: float, longitude_rad: float) -> None:
        """At a place."""
        sine, cosine = math.sin(latitude_rad), math.cos(latitude_rad)
        east_sine, east_cosine = math.sin(longitude_rad), math.cos(longitude_rad)
        self._origin = _cartesian(np.array(latitude_rad), np.array(longitude_rad))
        self._north = np.array([-sine * east_cosine, -sine * east_sine, cosine])
        self._east = np.array([-east_sine, east_cosine, 0.0])

    def of(self, latitude_rad: Array, longitude_rad: Array) -> Array:
        """Return (n, 2), north and east."""
        way = _cartesian(latitude_rad, longitude_rad) - self._origin
        return np.stack([way @ self._north, way @ self._east], axis=-1)


def _cartesian(latitude_rad: Array, longitude_rad: Array) -> Array:
    sine, cosine = np.sin(latitude_rad), np.cos(latitude_rad)
    radius = _SEMI_MAJOR_M / np.sqrt(1.0 - _ECCENTRICITY_2 * sine**2)
    return np.stack(
        [
            radius * cosine * np.cos(longitude_rad),
            radius * cosine * np.sin(longitude_rad),
            radius * (1.0 - _ECCENTRICITY_2) * sine,
        ],
        axis=-1,
    )


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
    turns = [
        _turn(*places, flown) for places in zip(flights, flights[1:], flights[2:], strict=False)
    ]
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
            circles.append(_circle(item, flown, item.radius_m or loiter_m))
        before = item
    landing = score_landing(plan, flown, go_arounds)
    kept = [leg for leg in legs if leg.seconds > 0.0]
    return PlanScore(waypoints, kept, [turn for turn in turns if turn], circles, takeoff, landing)


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


def away_m(latitude_deg: float, longitude_deg: float, track: tuple[Array, Array]) -> Array:
    """Return how far a place is from latitudes and longitudes, in degrees."""
    plane = Plane(math.radians(latitude_deg), math.radians(longitude_deg))
    return np.asarray(np.hypot(*plane.of(np.radians(track[0]), np.radians(track[1])).T))


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
    plane = _plane(end)
    begin = plane.of(
        np.array([math.radians(start.latitude_deg)]), np.array([math.radians(start.longitude_deg)])
    )[0]
    course = -begin / np.hypot(*begin)
    course_rad = math.atan2(course[1], course[0])
    at = plane.of(flown.latitude_rad, flown.longitude_rad)
    off = _within_pi(flown.course_rad - course_rad)
    on = (flown.item == end.number) & (np.abs(off) < _ON_COURSE_RAD)
    cross = (course[0] * at[:, 1] - course[1] * at[:, 0])[on]
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


def _turn(start: Item, item: Item, end: Item, flown: FlownPlan) -> TurnScore | None:
    """Score the turn at an item, if it is one between legs that is flown before its waypoint."""
    if {start.command, item.command, end.command} != {WAYPOINT}:
        return None
    plane = _plane(item)
    ends = plane.of(
        np.radians([start.latitude_deg, end.latitude_deg]),
        np.radians([start.longitude_deg, end.longitude_deg]),
    )
    courses = np.arctan2(*(ends * [[-1.0], [1.0]]).T[::-1])
    turn = _within_pi(courses[1] - courses[0])
    turned = _within_pi(flown.course_rad - courses[0]) * math.copysign(1.0, turn)
    straight = _ON_COURSE_RAD
    before = np.flatnonzero((flown.item == item.number) & (np.abs(turned) < straight))
    after = np.flatnonzero((flown.item == end.number) & (np.abs(turned - abs(turn)) < straight))
    if not (straight < abs(turn) <= _MOST_FLY_BY_RAD and len(before) and len(after)):
        return None
    rows = np.arange(before[-1] + 1, after[0])
    if len(rows) < 2 or np.max(turned[rows]) > abs(turn) + _OVERSHOOT_RAD:
        return None
    at = plane.of(flown.latitude_rad, flown.longitude_rad)[rows]
    way = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(at, axis=0).T))])
    radius = 1.0 / float(np.polyfit(way, turned[rows], 1)[0])
    inwards = np.array([np.cos(courses), np.sin(courses)]) @ [-1.0, 1.0]
    centre = inwards / np.hypot(*inwards) * radius / math.cos(turn / 2.0)
    error = np.hypot(*(at - centre).T) - radius
    return TurnScore(
        item.number,
        math.degrees(turn),
        radius,
        float(np.sqrt(np.mean(error**2))),
        float(np.max(np.abs(error))),
        float(np.degrees(np.max(np.abs(flown.roll_rad[rows])))),
    )


def _within_pi(angle: Array) -> Array:
    """Return angles, in rad, from -π to π."""
    return np.asarray(np.angle(np.exp(1j * angle)))


def _circle(item: Item, flown: FlownPlan, radius_m: float) -> CircleScore:
    at = _plane(item).of(flown.latitude_rad, flown.longitude_rad)
    away = np.hypot(*at.T)
    on = (flown.item == item.number) & (np.abs(away - radius_m) < _ON_CIRCLE * radius_m)
    # The leg onto the circle touches it, too: from a tenth of a turn on.
    around = np.unwrap(np.arctan2(at[:, 1], at[:, 0])[on])
    on_circle = np.flatnonzero(on)[np.abs(around - around[0]) > math.tau / 10.0] if on.any() else []
    if not len(on_circle):
        return CircleScore(item.number, 0.0, radius_m, math.nan, math.nan)
    tick_s = float(np.median(np.diff(flown.time_s)))
    error = np.abs(away[on_circle] - radius_m) / radius_m
    return CircleScore(
        item.number,
        len(on_circle) * tick_s,
        radius_m,
        float(100.0 * np.max(error)),
        float(np.degrees(np.max(np.abs(flown.roll_rad[on_circle])))),
    )
