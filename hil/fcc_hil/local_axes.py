"""X-Plane's local axes, of OpenGL: x east, y up, z south, level at the origin of its scenery.

Away from the origin they are not level, and their north is not true north: attitude, velocity and
acceleration in them differ from those about the level axes at the aircraft by about 1 degree for
each 110 km, and step when X-Plane moves the origin. The formulas are those of two level systems on
one sphere.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

EARTH_RADIUS_M = 6_378_137.0

Vector = tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class Turn:
    """The rotation from the level axes (north, east, down) at a place to those at another."""

    north: Vector
    """What the other place's north is in the axes of this one; likewise the others."""
    east: Vector
    down: Vector

    def apply(self, v: Vector) -> Vector:
        """Return a vector in the axes of the other place."""
        return (_dot(self.north, v), _dot(self.east, v), _dot(self.down, v))


@dataclass(frozen=True, slots=True)
class LocalAxes:
    """The axes with their origin at sea level at this place."""

    latitude_rad: float = 0.0
    longitude_rad: float = 0.0

    def turn(self, latitude_rad: float, longitude_rad: float) -> Turn:
        """Return the rotation from the level axes at a place to these."""
        here = _level_axes(latitude_rad, longitude_rad - self.longitude_rad)
        origin = _level_axes(self.latitude_rad, 0.0)
        north, east, down = (
            (_dot(axis, here[0]), _dot(axis, here[1]), _dot(axis, here[2])) for axis in origin
        )
        return Turn(north, east, down)

    def position_m(self, latitude_rad: float, longitude_rad: float, elevation_m: float) -> Vector:
        """Return x, y and z of a place."""
        radius_m = EARTH_RADIUS_M + elevation_m
        centre_to_here = (0.0, 0.0, -radius_m)
        north, east, down = self.turn(latitude_rad, longitude_rad).apply(centre_to_here)
        return (east, -down - EARTH_RADIUS_M, -north)


def attitude(turn: Turn, pitch_rad: float, roll_rad: float, heading_rad: float) -> Vector:
    """Return pitch, roll and heading about the axes that `turn` leads to."""
    sin_p, cos_p = math.sin(pitch_rad), math.cos(pitch_rad)
    sin_r, cos_r = math.sin(roll_rad), math.cos(roll_rad)
    sin_h, cos_h = math.sin(heading_rad), math.cos(heading_rad)
    nose = turn.apply((cos_p * cos_h, cos_p * sin_h, -sin_p))
    right_down = turn.apply(
        (
            sin_r * sin_p * cos_h - cos_r * sin_h,
            sin_r * sin_p * sin_h + cos_r * cos_h,
            sin_r * cos_p,
        )
    )[2]
    belly_down = turn.apply(
        (
            cos_r * sin_p * cos_h + sin_r * sin_h,
            cos_r * sin_p * sin_h - sin_r * cos_h,
            cos_r * cos_p,
        )
    )[2]
    return (
        math.asin(min(1.0, max(-1.0, -nose[2]))),
        math.atan2(right_down, belly_down),
        math.atan2(nose[1], nose[0]) % math.tau,
    )


class MeasuredAttitude:
    """Attitude about the local axes, from one that is measured about the level at the aircraft.

    The difference is that of the true attitude, so that a sensor's error of one angle stays in that
    one. An angle whose measurement stands still stands still here, too: a frozen sensor is frozen.
    """

    def __init__(self) -> None:
        """Begin without a measurement."""
        self._last: list[tuple[LocalAxes, float, float] | None] = [None] * 3

    def measure(self, axes: LocalAxes, turn: Turn, true: Vector, measured: Vector) -> Vector:
        """Return pitch, roll and heading about `axes`, to which `turn` leads."""
        local = attitude(turn, *true)
        pitch, roll, heading = (
            self._angle(place, axes, measured[place], local[place] - true[place])
            for place in range(3)
        )
        return (pitch, roll, heading % math.tau)

    def _angle(self, place: int, axes: LocalAxes, measured: float, differs: float) -> float:
        last = self._last[place]
        if last is None or last[:2] != (axes, measured):
            last = self._last[place] = (axes, measured, measured + differs)
        return last[2]


def _level_axes(latitude_rad: float, longitude_rad: float) -> tuple[Vector, Vector, Vector]:
    """Return north, east and down at a place, in axes fixed to the earth."""
    sin_a, cos_a = math.sin(latitude_rad), math.cos(latitude_rad)
    sin_o, cos_o = math.sin(longitude_rad), math.cos(longitude_rad)
    return (
        (-sin_a * cos_o, -sin_a * sin_o, cos_a),
        (-sin_o, cos_o, 0.0),
        (-cos_a * cos_o, -cos_a * sin_o, -sin_a),
    )


def _dot(a: Vector, b: Vector) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
