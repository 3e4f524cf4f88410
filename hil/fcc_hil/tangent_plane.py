"""Metres north and east of a place on WGS-84."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

_SEMI_MAJOR_M = 6_378_137.0
_ECCENTRICITY_2 = 6.694_379_990_14e-3


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


def away_m(latitude_deg: float, longitude_deg: float, track: tuple[Array, Array]) -> Array:
    """Return how far a place is from latitudes and longitudes, in degrees."""
    plane = Plane(math.radians(latitude_deg), math.radians(longitude_deg))
    return np.asarray(np.hypot(*plane.of(np.radians(track[0]), np.radians(track[1])).T))
