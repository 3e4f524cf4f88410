"""The readable datarefs, each computed from the plant's state in X-Plane's units.

X-Plane's local axes are x east, y up, z south, level at their origin (`local_axes`): `theta`, `phi`
and `psi` are about them, `true_theta`, `true_phi` and `true_psi` about the level at the aircraft.
Its load factors are as in the open-source autopilots that use them: `g_nrml` is +1 in level flight,
`g_axil` positive when pushed forward, `g_side` positive when pushed to the right. Its `beta` is yaw
against the flight path, positive with the nose to the right of it: aerodynamic sideslip with the
opposite sign.

Names and units are those of Laminar's DataRefs.txt of 12.10. Those here of 12 only are not in a
list of 11.50.
"""

from __future__ import annotations

import math
from collections.abc import Callable

from .cockpit import SIM_SPEED, Cockpit, split
from .protocol import Dialect
from .readout import Readout
from .units import (
    CELSIUS_ZERO_K,
    FT_TO_M,
    INHG_TO_PA,
    KT_TO_MPS,
    SEA_LEVEL_DENSITY_KGPM3,
    STANDARD_GRAVITY_MPS2,
)

_FPM_PER_MPS = 60.0 / FT_TO_M

Getter = Callable[[Readout], float]

_P = "sim/flightmodel/position/"
_P2 = "sim/flightmodel2/position/"
_F = "sim/flightmodel/forces/"
_W = "sim/weather/"
_T = "sim/time/"
_TOTAL = "sim/cockpit2/controls/total_"
_STABILISED = "sim/joystick/FC_"
_ICAO = "sim/aircraft/view/acf_ICAO"
"""A string: its elements are characters."""
_ALTITUDE = "sim/cockpit2/gauges/indicators/altitude_ft_pilot"
_BATTERY = "sim/cockpit2/electrical/battery_voltage_actual_volts[0]"
_ENGINE_SPEED = "sim/cockpit2/engine/indicators/engine_speed_rpm[0]"
_ON_GROUND = "sim/flightmodel/failures/onground_any"
RPOS = "RPOS"
"""The position by its own message, beside the datarefs."""


def _pitch_deg(r: Readout) -> float:
    return math.degrees(r.state.pitch_rad)


def _roll_deg(r: Readout) -> float:
    return math.degrees(r.state.roll_rad)


def _heading_deg(r: Readout) -> float:
    return math.degrees(r.state.heading_rad)


def _ambient_deg_c(r: Readout) -> float:
    return r.state.temperature_k - CELSIUS_ZERO_K


_READABLE: dict[str, Getter] = {
    _P + "indicated_airspeed": lambda r: r.indicated_airspeed_mps() / KT_TO_MPS,
    _P + "true_airspeed": lambda r: r.state.true_airspeed_mps,
    _P + "groundspeed": Readout.groundspeed_mps,
    _P + "theta": lambda r: r.local_attitude_deg[0],
    _P + "phi": lambda r: r.local_attitude_deg[1],
    _P + "psi": lambda r: r.local_attitude_deg[2],
    _P + "true_theta": _pitch_deg,
    _P + "true_phi": _roll_deg,
    _P + "true_psi": _heading_deg,
    _P2 + "true_theta": _pitch_deg,
    _P2 + "true_phi": _roll_deg,
    _P2 + "true_psi": _heading_deg,
    _P + "mag_psi": Readout.magnetic_heading_deg,
    _P2 + "mag_psi": Readout.magnetic_heading_deg,
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
    _P + "local_x": lambda r: r.local_position_m[0],
    _P + "local_y": lambda r: r.local_position_m[1],
    _P + "local_z": lambda r: r.local_position_m[2],
    _P + "local_vx": lambda r: r.local_velocity_mps[0],
    _P + "local_vy": lambda r: r.local_velocity_mps[1],
    _P + "local_vz": lambda r: r.local_velocity_mps[2],
    _P + "local_ax": lambda r: r.local_acceleration_mps2[0],
    _P + "local_ay": lambda r: r.local_acceleration_mps2[1],
    _P + "local_az": lambda r: r.local_acceleration_mps2[2],
    _P + "vh_ind_fpm": lambda r: -r.state.down_mps * _FPM_PER_MPS,
    _F + "g_nrml": lambda r: -r.state.specific_force_z_mps2 / STANDARD_GRAVITY_MPS2,
    _F + "g_axil": lambda r: r.state.specific_force_x_mps2 / STANDARD_GRAVITY_MPS2,
    _F + "g_side": lambda r: r.state.specific_force_y_mps2 / STANDARD_GRAVITY_MPS2,
    _ALTITUDE: Readout.indicated_altitude_ft,
    _TOTAL + "pitch_ratio": lambda r: r.cockpit.controls().elevator,
    _TOTAL + "roll_ratio": lambda r: r.cockpit.controls().aileron,
    _TOTAL + "heading_ratio": lambda r: r.cockpit.controls().rudder,
    _STABILISED + "ptch": lambda r: r.cockpit.stabilised().elevator,
    _STABILISED + "roll": lambda r: r.cockpit.stabilised().aileron,
    _STABILISED + "hdng": lambda r: r.cockpit.stabilised().rudder,
    _W + "barometer_current_inhg": lambda r: r.state.pressure_pa / INHG_TO_PA,
    _W + "barometer_sealevel_inhg": lambda r: r.qnh_pa / INHG_TO_PA,
    _W + "rho": Readout.density_kgpm3,
    _W + "sigma": lambda r: r.density_kgpm3() / SEA_LEVEL_DENSITY_KGPM3,
    _W + "temperature_ambient_c": _ambient_deg_c,
    _T + "paused": lambda r: float(r.paused),
    _T + "is_in_replay": lambda r: float(r.in_replay),
    SIM_SPEED: lambda r: r.speed,
    _T + "sim_speed_actual": lambda r: r.speed,
    _T + "sim_speed_actual_ogl": Readout.achieved_speed,
    _T + "total_flight_time_sec": lambda r: r.flight_time_s,
    _T + "total_running_time_sec": lambda r: r.running_time_s,
    "sim/network/misc/network_time_sec": lambda r: r.network_time_s,
    _T + "framerate_period": lambda r: r.smoothed_period_s,
    "sim/operation/misc/frame_rate_period": lambda r: r.frame_period_s,
    _ENGINE_SPEED: lambda r: r.state.engine_speed_radps * 60.0 / math.tau,
    _BATTERY: lambda r: r.state.battery_voltage_v,
    _ON_GROUND: lambda r: float(r.state.on_ground),
    "sim/aircraft/engine/acf_num_engines": lambda r: float(r.cockpit.engines),
    "sim/version/xplane_internal_version": lambda r: float(r.dialect.version),
}

_READABLE_SINCE_12: dict[str, Getter] = {
    _P2 + "pressure_altitude": lambda r: r.state.altitude_m / FT_TO_M,
    _W + "aircraft/barometer_current_pas": lambda r: r.state.pressure_pa,
    _W + "aircraft/qnh_pas": lambda r: r.qnh_pa,
    _W + "aircraft/temperature_ambient_deg_c": _ambient_deg_c,
    _W + "aircraft/wind_now_x_msc": lambda r: r.state.wind_east_mps,
    _W + "aircraft/wind_now_y_msc": lambda r: -r.state.wind_down_mps,
    _W + "aircraft/wind_now_z_msc": lambda r: -r.state.wind_north_mps,
    _W + "region/qnh_pas": lambda r: r.qnh_pa,
    _W + "region/sealevel_pressure_pas": lambda r: r.qnh_pa,
}


_TELLS: dict[str, tuple[str, ...]] = {
    "pitch_rad": (_P + "theta", _P + "true_theta", _P2 + "true_theta"),
    "roll_rad": (_P + "phi", _P + "true_phi", _P2 + "true_phi"),
    "heading_rad": (
        _P + "psi",
        _P + "true_psi",
        _P2 + "true_psi",
        _P + "mag_psi",
        _P2 + "mag_psi",
    ),
    "roll_rate_radps": (_P + "Prad", _P + "P"),
    "pitch_rate_radps": (_P + "Qrad", _P + "Q"),
    "yaw_rate_radps": (_P + "Rrad", _P + "R"),
    "specific_force_x_mps2": (_P + "local_ax", _F + "g_axil"),
    "specific_force_y_mps2": (_P + "local_ay", _F + "g_side"),
    "specific_force_z_mps2": (_P + "local_az", _F + "g_nrml"),
    "airspeed_mps": (_P + "indicated_airspeed",),
    "altitude_m": (_ALTITUDE, _P2 + "pressure_altitude"),
    "battery_voltage_v": (_BATTERY,),
    "latitude_rad": (RPOS, _P + "latitude", _P + "local_x", _P + "local_y", _P + "local_z"),
    "longitude_rad": (RPOS, _P + "longitude"),
    "elevation_m": (RPOS, _P + "elevation"),
    "north_mps": (_P + "local_vz", _P + "groundspeed", _P + "hpath"),
    "east_mps": (_P + "local_vx",),
    "down_mps": (_P + "local_vy", _P + "vh_ind_fpm", _P + "vpath"),
    "engine_speed_radps": (_ENGINE_SPEED,),
    "on_ground": (_ON_GROUND,),
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
    if element is not None:
        return lambda readout: readout.cockpit.value(element)
    name = split(path)
    if name is not None and name[0] == _ICAO:
        place = name[1]
        return lambda readout: float(ord(readout.aircraft[place : place + 1] or "\0"))
    return None


def readable(dialect: Dialect) -> list[str]:
    """Return the names of the datarefs computed from the plant."""
    return [*_READABLE, *(_READABLE_SINCE_12 if dialect.major >= 12 else ())]
