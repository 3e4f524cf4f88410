"""How well the arcs and circles of a plan were flown, from the truth."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from .flown_plan import FlownPlan
from .plan_file import WAYPOINT, Item
from .tangent_plane import Array, Plane

ON_COURSE_RAD = math.radians(1.0)
"""The path has the course of the leg within this: the rest is a turn."""
_MOST_FLY_BY_RAD = math.radians(91.0)
"""A turn that is flown before its waypoint: right angles on a map are a little more than 90°."""
_OVERSHOOT_RAD = math.radians(3.0)
"""The path's course goes farther than this beyond that of the next leg: it is flown over."""
_ON_CIRCLE = 0.2
"""A circle is flown from where the aircraft is within this share of its radius."""


@dataclass(frozen=True)
class TurnScore:
    """How the arc before a waypoint was flown, which touches both legs."""

    item: int
    degrees: float
    radius_m: float
    """Of the planned arc, as the course of the path shows it."""
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


def score_turn(start: Item, item: Item, end: Item, flown: FlownPlan) -> TurnScore | None:
    """Score the turn at an item, if it is one between legs that is flown before its waypoint."""
    if {start.command, item.command, end.command} != {WAYPOINT}:
        return None
    plane = Plane(math.radians(item.latitude_deg), math.radians(item.longitude_deg))
    ends = plane.of(
        np.radians([start.latitude_deg, end.latitude_deg]),
        np.radians([start.longitude_deg, end.longitude_deg]),
    )
    courses = np.arctan2(*(ends * [[-1.0], [1.0]]).T[::-1])
    turn = float(within_pi(courses[1] - courses[0]))
    turned = within_pi(flown.course_rad - courses[0]) * math.copysign(1.0, turn)
    before = np.flatnonzero((flown.item == item.number) & (np.abs(turned) < ON_COURSE_RAD))
    after = np.flatnonzero(
        (flown.item == end.number) & (np.abs(turned - abs(turn)) < ON_COURSE_RAD)
    )
    if not (ON_COURSE_RAD < abs(turn) <= _MOST_FLY_BY_RAD and len(before) and len(after)):
        return None
    rows = np.arange(before[-1] + 1, after[0])
    if len(rows) < 2 or np.max(turned[rows]) > abs(turn) + _OVERSHOOT_RAD:
        return None
    at = plane.of(flown.latitude_rad, flown.longitude_rad)[rows]
    inwards = np.array([np.cos(courses), np.sin(courses)]) @ [-1.0, 1.0]
    # The centre, from the waypoint, of an arc of 1 m that touches both legs.
    centre = inwards / np.hypot(*inwards) / math.cos(turn / 2.0)
    radius = _planned_radius_m(at, centre, flown.course_rad[rows])
    error = np.hypot(*(at - centre * radius).T) - radius
    return TurnScore(
        item.number,
        math.degrees(turn),
        radius,
        float(np.sqrt(np.mean(error**2))),
        float(np.max(np.abs(error))),
        float(np.degrees(np.max(np.abs(flown.roll_rad[rows])))),
    )


def _planned_radius_m(at: Array, centre: Array, course_rad: Array) -> float:
    """Return the radius of the arc, whose centre lies across the path's course from everywhere.

    However far from the arc it is flown: the least squares of the distance of the centre from
    those lines. `centre` is that of an arc of 1 m.
    """
    along = np.stack([np.cos(course_rad), np.sin(course_rad)], axis=-1)
    of_place, of_centre = np.sum(at * along, axis=1), along @ centre
    return float(of_place @ of_centre / (of_centre @ of_centre))


def within_pi(angle: Array) -> Array:
    """Return angles, in rad, from -π to π."""
    return np.asarray(np.angle(np.exp(1j * angle)))


def score_circle(item: Item, flown: FlownPlan, radius_m: float) -> CircleScore:
    """Score a loiter, from a tenth of a turn on."""
    plane = Plane(math.radians(item.latitude_deg), math.radians(item.longitude_deg))
    at = plane.of(flown.latitude_rad, flown.longitude_rad)
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
