"""The readable datarefs, each computed from the plant's state in X-Plane's units.

X-Plane's local axes are x east, y up, z south. Its load factors are as in the open-source
autopilots that use them: `g_nrml` is +1 in level flight, `g_axil` positive when pushed forward,
`g_side` positive when pushed to the right. Its `beta` is yaw against the flight path, positive with
the nose to the right of it: aerodynamic sideslip with the opposite sign.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from .cockpit import Cockpit
from .protocol import Dialect, Position
from .state import State
from .units import (
    CELSIUS_ZERO_K,
    FT_TO_M,
    INHG_TO_PA,
    KT_TO_MPS,
    SEA_LEVEL_PRESSURE_PA,
    STANDARD_GRAVITY_MPS2,
    wrap_heading,
)

_EARTH_RADIUS_M = 6_378_137.0
_FPM_PER_MPS = 60.0 / FT_TO_M


@dataclass(slots=True)
class Readout:
    """Everything that a dataref can be computed from, at one frame."""

    state: State
    """As measured, noise included."""
    cockpit: Cockpit
    dialect: Dialect
    flight_time_s: float
    paused: bool
    frame_period_s: float
    origin_latitude_rad: float
    """Origin of X-Plane's local axes."""
    origin_longitude_rad: float
    magnetic_variation_deg: float
    """Positive where magnetic north lies east of true."""

    def magnetic_heading_deg(self) -> float:
        """Return the heading from magnetic north, 0..360."""
        return wrap_heading(math.degrees(self.state.heading_rad) - self.magnetic_variation_deg)

    def groundspeed_mps(self) -> float:
        """Return the horizontal speed over the ground."""
        return math.hypot(self.state.north_mps, self.state.east_mps)

    def track_deg(self) -> float:
        """Return the true direction of the path over the ground, 0..360."""
        return wrap_heading(math.degrees(math.atan2(self.state.east_mps, self.state.north_mps)))

    def path_deg(self) -> float:
        """Return the angle of the path above the horizon."""
        return math.degrees(math.atan2(-self.state.down_mps, self.groundspeed_mps()))

    def local_x_m(self) -> float:
        """Return the distance east of the origin."""
        return (
            _EARTH_RADIUS_M
            * math.cos(self.origin_latitude_rad)
            * (self.state.longitude_rad - self.origin_longitude_rad)
        )

    def local_z_m(self) -> float:
        """Return the distance south of the origin."""
        return _EARTH_RADIUS_M * (self.origin_latitude_rad - self.state.latitude_rad)

    def acceleration_mps2(self) -> tuple[float, float, float]:
        """Return the acceleration over the ground: north, east, down."""
        s = self.state
        sin_p, cos_p = math.sin(s.pitch_rad), math.cos(s.pitch_rad)
        sin_r, cos_r = math.sin(s.roll_rad), math.cos(s.roll_rad)
        sin_h, cos_h = math.sin(s.heading_rad), math.cos(s.heading_rad)
        fx, fy, fz = s.specific_force_x_mps2, s.specific_force_y_mps2, s.specific_force_z_mps2
        # Body to local level: roll, then pitch, then heading.
        across = fy * cos_r - fz * sin_r
        under = fy * sin_r + fz * cos_r
        along = fx * cos_p + under * sin_p
        down = -fx * sin_p + under * cos_p
        return (
            along * cos_h - across * sin_h,
            along * sin_h + across * cos_h,
            down + STANDARD_GRAVITY_MPS2,
        )

    def position(self) -> Position:
        """Return the content of RPOS."""
        s = self.state
        return Position(
            longitude_deg=math.degrees(s.longitude_rad),
            latitude_deg=math.degrees(s.latitude_rad),
            elevation_m=s.elevation_m,
            height_m=s.height_m,
            pitch_deg=math.degrees(s.pitch_rad),
            heading_deg=math.degrees(s.heading_rad),
            roll_deg=math.degrees(s.roll_rad),
            east_mps=s.east_mps,
            up_mps=-s.down_mps,
            south_mps=-s.north_mps,
            roll_radps=s.roll_rate_radps,
            pitch_radps=s.pitch_rate_radps,
            yaw_radps=s.yaw_rate_radps,
        )


Getter = Callable[[Readout], float]

_P = "sim/flightmodel/position/"
_F = "sim/flightmodel/forces/"
_W = "sim/weather/aircraft/"

_READABLE: dict[str, Getter] = {
    _P + "indicated_airspeed": lambda r: r.state.airspeed_mps / KT_TO_MPS,
    _P + "true_airspeed": lambda r: r.state.true_airspeed_mps,
    _P + "groundspeed": Readout.groundspeed_mps,
    _P + "theta": lambda r: math.degrees(r.state.pitch_rad),
    _P + "phi": lambda r: math.degrees(r.state.roll_rad),
    _P + "psi": lambda r: math.degrees(r.state.heading_rad),
    _P + "mag_psi": Readout.magnetic_heading_deg,
    _P + "Prad": lambda r: r.state.roll_rate_radps,
    _P + "Qrad": lambda r: r.state.pitch_rate_radps,
    _P + "Rrad": lambda r: r.state.yaw_rate_radps,
    _P + "P": lambda r: math.degrees(r.state.roll_rate_radps),
    _P + "Q": lambda r: math.degrees(r.state.pitch_rate_radps),
    _P + "R": lambda r: math.degrees(r.state.yaw_rate_radps),
    _P + "alpha": lambda r: math.degrees(r.state.angle_of_attack_rad),
    _P + "beta": lambda r: -math.degrees(r.state.sideslip_rad),
    _P + "hpath": Readout.track_deg,
    _P + "vpath": Readout.path_deg,
    _P + "latitude": lambda r: math.degrees(r.state.latitude_rad),
    _P + "longitude": lambda r: math.degrees(r.state.longitude_rad),
    _P + "elevation": lambda r: r.state.elevation_m,
    _P + "y_agl": lambda r: r.state.height_m,
    _P + "local_x": Readout.local_x_m,
    _P + "local_y": lambda r: r.state.elevation_m,
    _P + "local_z": Readout.local_z_m,
    _P + "local_vx": lambda r: r.state.east_mps,
    _P + "local_vy": lambda r: -r.state.down_mps,
    _P + "local_vz": lambda r: -r.state.north_mps,
    _P + "local_ax": lambda r: r.acceleration_mps2()[1],
    _P + "local_ay": lambda r: -r.acceleration_mps2()[2],
    _P + "local_az": lambda r: -r.acceleration_mps2()[0],
    _P + "vh_ind_fpm": lambda r: -r.state.down_mps * _FPM_PER_MPS,
    _F + "g_nrml": lambda r: -r.state.specific_force_z_mps2 / STANDARD_GRAVITY_MPS2,
    _F + "g_axil": lambda r: r.state.specific_force_x_mps2 / STANDARD_GRAVITY_MPS2,
    _F + "g_side": lambda r: r.state.specific_force_y_mps2 / STANDARD_GRAVITY_MPS2,
    "sim/weather/barometer_current_inhg": lambda r: r.state.pressure_pa / INHG_TO_PA,
    "sim/cockpit2/gauges/indicators/altitude_ft_pilot": lambda r: r.state.altitude_m / FT_TO_M,
    "sim/time/paused": lambda r: float(r.paused),
    "sim/time/total_flight_time_sec": lambda r: r.flight_time_s,
    "sim/time/framerate_period": lambda r: r.frame_period_s,
    "sim/flightmodel/failures/onground_any": lambda r: float(r.state.on_ground),
    "sim/version/xplane_internal_version": lambda r: float(r.dialect.version),
}

_READABLE_SINCE_12: dict[str, Getter] = {
    _W + "barometer_current_pas": lambda r: r.state.pressure_pa,
    _W + "qnh_pas": lambda _: SEA_LEVEL_PRESSURE_PA,
    _W + "temperature_ambient_deg_c": lambda r: r.state.temperature_k - CELSIUS_ZERO_K,
    _W + "wind_now_x_msc": lambda r: r.state.wind_east_mps,
    _W + "wind_now_y_msc": lambda r: -r.state.wind_down_mps,
    _W + "wind_now_z_msc": lambda r: -r.state.wind_north_mps,
}


_TELLS: dict[str, tuple[str, ...]] = {
    "pitch_rad": (_P + "theta",),
    "roll_rad": (_P + "phi",),
    "heading_rad": (_P + "psi", _P + "mag_psi"),
    "roll_rate_radps": (_P + "Prad", _P + "P"),
    "pitch_rate_radps": (_P + "Qrad", _P + "Q"),
    "yaw_rate_radps": (_P + "Rrad", _P + "R"),
    "specific_force_x_mps2": (_P + "local_ax", _F + "g_axil"),
    "specific_force_y_mps2": (_P + "local_ay", _F + "g_side"),
    "specific_force_z_mps2": (_P + "local_az", _F + "g_nrml"),
    "airspeed_mps": (_P + "indicated_airspeed",),
    "altitude_m": ("sim/cockpit2/gauges/indicators/altitude_ft_pilot",),
}
"""The datarefs that are missing when the sensor for a field of `state.State` is silent.
Accelerations are along the world's axes, so any missing one removes all three."""


def withheld(missing: frozenset[str]) -> frozenset[str]:
    """Return the datarefs that are not sent while these fields of the state are missing."""
    return frozenset(path for field in missing for path in _TELLS[field])


def getter(path: str, cockpit: Cockpit, dialect: Dialect) -> Getter | None:
    """Return the function that reads a dataref, or None if this version does not have it."""
    found = _READABLE.get(path)
    if found is None and dialect.major >= 12:
        found = _READABLE_SINCE_12.get(path)
    if found is not None:
        return found
    element = cockpit.element(path)
    if element is None:
        return None
    return lambda readout: readout.cockpit.value(element)


def readable(dialect: Dialect) -> list[str]:
    """Return the names of the datarefs computed from the plant."""
    return [*_READABLE, *(_READABLE_SINCE_12 if dialect.major >= 12 else ())]
