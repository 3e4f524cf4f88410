"""The rows of X-Plane's Data Output, for clients that use DATA instead of subscriptions."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

from .protocol import UNUSED
from .readout import Readout
from .units import (
    CELSIUS_ZERO_K,
    FT_TO_M,
    INHG_TO_PA,
    KT_TO_MPS,
    SEA_LEVEL_DENSITY_KGPM3,
    STANDARD_GRAVITY_MPS2,
)

_COLUMNS = 8
_MPH_PER_MPS = 3600.0 / 1609.344
_METRES_PER_NAUTICAL_MILE = 1852.0


def _times(r: Readout) -> Sequence[float]:
    t = r.flight_time_s
    return (t, t, t, t, UNUSED, 12.0 + t / 3600.0, 12.0 + t / 3600.0, t / 3600.0)


def _speeds(r: Readout) -> Sequence[float]:
    indicated, true = r.indicated_airspeed_mps(), r.state.true_airspeed_mps
    ground = r.groundspeed_mps()
    equivalent = true * math.sqrt(r.density_kgpm3() / SEA_LEVEL_DENSITY_KGPM3)
    knots = [v / KT_TO_MPS for v in (indicated, equivalent, true, ground)]
    return (*knots, UNUSED, *(v * _MPH_PER_MPS for v in (indicated, true, ground)))


def _loads(r: Readout) -> Sequence[float]:
    s, g = r.state, STANDARD_GRAVITY_MPS2
    climb_fpm = -s.down_mps / FT_TO_M * 60.0
    normal, side = -s.specific_force_z_mps2, s.specific_force_y_mps2
    axial = r.axial_sign * s.specific_force_x_mps2
    return (s.mach, UNUSED, climb_fpm, UNUSED, normal / g, axial / g, side / g)


def _weather(r: Readout) -> Sequence[float]:
    return (r.qnh_pa / INHG_TO_PA, 15.0)


def _ambient(r: Readout) -> Sequence[float]:
    s = r.state
    ratio = r.density_kgpm3() / SEA_LEVEL_DENSITY_KGPM3
    return (s.pressure_pa / INHG_TO_PA, s.temperature_k - CELSIUS_ZERO_K, UNUSED, ratio)


def _joystick(r: Readout) -> Sequence[float]:
    held = r.cockpit.yoke()
    return (held.elevator, held.aileron, held.rudder)


def _surfaces(r: Readout) -> Sequence[float]:
    at = r.surfaces or r.cockpit.controls()
    return (at.elevator, at.aileron, at.rudder)


def _rates(r: Readout) -> Sequence[float]:
    p, q, yaw = r.state.roll_rate_radps, r.state.pitch_rate_radps, r.state.yaw_rate_radps
    if r.dialect.major >= 12:
        return (math.degrees(p), math.degrees(q), math.degrees(yaw))
    return (q, p, yaw)


def _attitude(r: Readout) -> Sequence[float]:
    return (*r.local_attitude_deg, r.magnetic_heading_deg())


def _air_angles(r: Readout) -> Sequence[float]:
    s = r.state
    slip = -math.degrees(s.sideslip_rad)
    angles = (math.degrees(s.angle_of_attack_rad), slip, r.track_deg(), r.path_deg())
    return (*angles, UNUSED, UNUSED, UNUSED, slip)


def _compass(r: Readout) -> Sequence[float]:
    return (r.magnetic_heading_deg(), r.magnetic_variation_deg)


def _place(r: Readout) -> Sequence[float]:
    s = r.state
    place = (math.degrees(s.latitude_rad), math.degrees(s.longitude_rad))
    heights = (s.elevation_m / FT_TO_M, s.height_m / FT_TO_M)
    return (*place, *heights, float(s.on_ground), r.indicated_altitude_ft())


def _local(r: Readout) -> Sequence[float]:
    x, y, z = r.local_position_m
    distance_m = math.hypot(x, z)
    travelled = (distance_m / FT_TO_M, distance_m / _METRES_PER_NAUTICAL_MILE)
    return (x, y, z, *r.local_velocity_mps, *travelled)


def _throttles(r: Readout) -> Sequence[float]:
    return r.cockpit.throttles()


_ROWS: dict[int, Callable[[Readout], Sequence[float]]] = {
    1: _times,
    3: _speeds,
    4: _loads,
    5: _weather,
    6: _ambient,
    8: _joystick,
    11: _surfaces,
    16: _rates,
    17: _attitude,
    18: _air_angles,
    19: _compass,
    20: _place,
    21: _local,
    25: _throttles,
    26: _throttles,
}


def row_values(row: int, readout: Readout) -> tuple[float, ...] | None:
    """Return the eight columns of a row, unused ones -999; None for a row not supported here."""
    build = _ROWS.get(row)
    if build is None:
        return None
    values = tuple(build(readout))[:_COLUMNS]
    return values + (UNUSED,) * (_COLUMNS - len(values))
