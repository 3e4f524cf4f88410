"""What X-Plane knows at one frame, from which datarefs, rows and positions are computed."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

from .cockpit import ALTIMETER_SETTING, PITOT_ICE, Cockpit
from .local_axes import LocalAxes, Turn, Vector, attitude
from .protocol import Dialect, Position
from .state import Controls, State
from .units import (
    DRY_AIR_GAS_CONSTANT,
    FT_TO_M,
    INHG_TO_PA,
    SEA_LEVEL_PRESSURE_PA,
    STANDARD_GRAVITY_MPS2,
    pressure_altitude_m,
    wrap_heading,
)

SLOWEST_TRUE_PERIOD_S = 1.0 / 19.0
"""A longer frame moves the aircraft by no more than this: below 19 frames a second X-Plane's time
runs slower than the wall clock (DataRefs.txt, at `sim/time/sim_speed_actual_ogl`)."""


@dataclass
class Readout:
    """Everything that a dataref can be computed from, at one frame."""

    state: State
    """As measured, noise included."""
    cockpit: Cockpit
    dialect: Dialect
    flight_time_s: float
    paused: bool
    frame_period_s: float
    axes: LocalAxes
    magnetic_variation_deg: float
    """Positive where magnetic north lies east of true."""
    smoothed_period_s: float = 0.0
    running_time_s: float = 0.0
    """Since the simulator was started."""
    network_time_s: float = 0.0
    """The same by this machine's clock: it runs on in pauses and freezes."""
    in_replay: bool = False
    speed: float = 1.0
    """How many times as fast as real time it is to run; 0 when paused."""
    qnh_pa: float = SEA_LEVEL_PRESSURE_PA
    axial_sign: float = 1.0
    """In row 4."""
    surfaces: Controls | None = None
    """Where the control surfaces are; None for where they are commanded."""
    aircraft: str = ""
    attitude_rad: Vector | None = None
    """Pitch, roll and heading about the local axes, as measured; None for those of `state`."""

    @cached_property
    def _turn(self) -> Turn:
        """The rotation from the level axes at the aircraft to the local ones."""
        return self.axes.turn(self.state.latitude_rad, self.state.longitude_rad)

    @cached_property
    def local_attitude_deg(self) -> Vector:
        """Return pitch, roll and heading about the local axes; heading 0..360."""
        s = self.state
        pitch, roll, heading = self.attitude_rad or attitude(
            self._turn, s.pitch_rad, s.roll_rad, s.heading_rad
        )
        return (math.degrees(pitch), math.degrees(roll), wrap_heading(math.degrees(heading)))

    @cached_property
    def local_position_m(self) -> Vector:
        """Return x, y, z."""
        s = self.state
        return self.axes.position_m(s.latitude_rad, s.longitude_rad, s.elevation_m)

    @cached_property
    def local_velocity_mps(self) -> Vector:
        """Return the velocity over the ground along x, y, z."""
        s = self.state
        return self._along_local((s.north_mps, s.east_mps, s.down_mps))

    @cached_property
    def local_acceleration_mps2(self) -> Vector:
        """Return the acceleration over the ground along x, y, z."""
        return self._along_local(self.acceleration_mps2())

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

    def achieved_speed(self) -> float:
        """Return how many times as fast as real time it runs, with what too few frames lose."""
        return self.speed * min(1.0, SLOWEST_TRUE_PERIOD_S / self.frame_period_s)

    def indicated_airspeed_mps(self) -> float:
        """Return the reading of the airspeed indicator, which falls as the pitot tube ices up."""
        ice = self.cockpit.read(PITOT_ICE) or 0.0
        return self.state.airspeed_mps * (1.0 - ice)

    def indicated_altitude_ft(self) -> float:
        """Return the reading of the pilot's altimeter at its present setting.

        An altimeter shows the height in the standard atmosphere above the level of its setting.
        """
        setting_inhg = self.cockpit.read(ALTIMETER_SETTING) or 0.0
        level_m = pressure_altitude_m(max(1.0, setting_inhg) * INHG_TO_PA)
        return (self.state.altitude_m - level_m) / FT_TO_M

    def density_kgpm3(self) -> float:
        """Return the density of the air at the aircraft."""
        return self.state.pressure_pa / (DRY_AIR_GAS_CONSTANT * self.state.temperature_k)

    def acceleration_mps2(self) -> Vector:
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
        pitch_deg, roll_deg, heading_deg = self.local_attitude_deg
        east_mps, up_mps, south_mps = self.local_velocity_mps
        return Position(
            longitude_deg=math.degrees(s.longitude_rad),
            latitude_deg=math.degrees(s.latitude_rad),
            elevation_m=s.elevation_m,
            height_m=s.height_m,
            pitch_deg=pitch_deg,
            heading_deg=heading_deg,
            roll_deg=roll_deg,
            east_mps=east_mps,
            up_mps=up_mps,
            south_mps=south_mps,
            roll_radps=s.roll_rate_radps,
            pitch_radps=s.pitch_rate_radps,
            yaw_radps=s.yaw_rate_radps,
        )

    def _along_local(self, v: Vector) -> Vector:
        north, east, down = self._turn.apply(v)
        return (east, -down, -north)
