"""The flight control computer: autopilot, aircraft, recordings, a running daemon.

SI and radians throughout; body axes x forward, y right, z down; headings clockwise from
north. An error that is not a wrong argument is an `Error`.

The parts between `<schema>` and `</schema>` follow from the schema:
`FCC_UPDATE=1 python -m pytest hil/tests/test_fcc_stub.py` writes them anew.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from os import PathLike
from pathlib import Path
from typing import Any, Final, TypeAlias, TypedDict, final, overload

import numpy as np
import numpy.typing as npt
from typing_extensions import Unpack

_Array: TypeAlias = npt.NDArray[np.float64]
_Records: TypeAlias = npt.NDArray[np.void]
_Path: TypeAlias = str | PathLike[str]
_Source: TypeAlias = Sequence[npt.ArrayLike]

class _Commanded(TypedDict, total=False):
    """Set points of a command; None stays as it is."""

    airspeed_mps: float | None
    heading_rad: float | None
    altitude_m: float | None
    pressure_altitude_m: float | None
    height_m: float | None
    altimeter_setting_pa: float | None
    plan_item: float | None
    pause: float | None
    return_home: float | None
    land: float | None
    go_around: float | None
    go_to_latitude_rad: float | None
    go_to_longitude_rad: float | None
    go_to_altitude_m: float | None
    heartbeat_s: float | None

__version__: Final[str]
MEASUREMENTS: Final[tuple[str, ...]]
SURFACES: Final[tuple[str, ...]]
TRUTH: Final[tuple[str, ...]]
STATES: Final[tuple[str, ...]]
RECORD: Final[np.dtype[np.void]]
TRUTH_RECORD: Final[np.dtype[np.void]]

class Error(Exception): ...
class ConfigError(Error, ValueError): ...
class PlanError(Error, ValueError): ...
class EngageError(Error, RuntimeError): ...
class FlightError(Error): ...
class RecordingError(Error): ...
class TelemetryError(Error): ...
class CommandError(Error): ...
class TimerError(Error): ...

@final
class Measurements:
    """What the sensors measure at one instant; NaN is what is not measured."""

    # <schema>
    def __new__(
        cls,
        *,
        pitch_rad: float = ...,
        roll_rad: float = ...,
        heading_rad: float = ...,
        roll_rate_radps: float = ...,
        pitch_rate_radps: float = ...,
        yaw_rate_radps: float = ...,
        specific_force_x_mps2: float = ...,
        specific_force_y_mps2: float = ...,
        specific_force_z_mps2: float = ...,
        airspeed_mps: float = ...,
        altitude_m: float = ...,
        angle_of_attack_rad: float = ...,
        latitude_rad: float = ...,
        longitude_rad: float = ...,
        position_altitude_m: float = ...,
        north_mps: float = ...,
        east_mps: float = ...,
        down_mps: float = ...,
        pilot_pitch: float = ...,
        pilot_roll: float = ...,
        pilot_yaw: float = ...,
        raw_specific_force_x_mps2: float = ...,
        raw_specific_force_y_mps2: float = ...,
        raw_specific_force_z_mps2: float = ...,
        raw_roll_rate_radps: float = ...,
        raw_pitch_rate_radps: float = ...,
        raw_yaw_rate_radps: float = ...,
        magnetic_field_x_ut: float = ...,
        magnetic_field_y_ut: float = ...,
        magnetic_field_z_ut: float = ...,
        static_pressure_pa: float = ...,
        differential_pressure_pa: float = ...,
        air_temperature_k: float = ...,
        gnss_latitude_rad: float = ...,
        gnss_longitude_rad: float = ...,
        gnss_position_altitude_m: float = ...,
        gnss_north_mps: float = ...,
        gnss_east_mps: float = ...,
        gnss_down_mps: float = ...,
        gnss_horizontal_accuracy_m: float = ...,
        gnss_vertical_accuracy_m: float = ...,
        gnss_speed_accuracy_mps: float = ...,
        range_m: float = ...,
        weight_on_wheels: float = ...,
        engine_speed_radps: float = ...,
        battery_voltage_v: float = ...,
        battery_charge: float = ...,
    ) -> Measurements: ...
    @property
    def pitch_rad(self) -> float:
        """Nose above the horizon."""

    @pitch_rad.setter
    def pitch_rad(self, value: float) -> None: ...
    @property
    def roll_rad(self) -> float:
        """Right wing down."""

    @roll_rad.setter
    def roll_rad(self, value: float) -> None: ...
    @property
    def heading_rad(self) -> float:
        """Magnetic heading in rad, clockwise from magnetic north."""

    @heading_rad.setter
    def heading_rad(self, value: float) -> None: ...
    @property
    def roll_rate_radps(self) -> float:
        """P, about x: right wing down."""

    @roll_rate_radps.setter
    def roll_rate_radps(self, value: float) -> None: ...
    @property
    def pitch_rate_radps(self) -> float:
        """Q, about y: nose up."""

    @pitch_rate_radps.setter
    def pitch_rate_radps(self, value: float) -> None: ...
    @property
    def yaw_rate_radps(self) -> float:
        """R, about z: nose right."""

    @yaw_rate_radps.setter
    def yaw_rate_radps(self, value: float) -> None: ...
    @property
    def specific_force_x_mps2(self) -> float:
        """Forward."""

    @specific_force_x_mps2.setter
    def specific_force_x_mps2(self, value: float) -> None: ...
    @property
    def specific_force_y_mps2(self) -> float:
        """Right."""

    @specific_force_y_mps2.setter
    def specific_force_y_mps2(self, value: float) -> None: ...
    @property
    def specific_force_z_mps2(self) -> float:
        """Down."""

    @specific_force_z_mps2.setter
    def specific_force_z_mps2(self, value: float) -> None: ...
    @property
    def airspeed_mps(self) -> float:
        """Indicated airspeed in m/s."""

    @airspeed_mps.setter
    def airspeed_mps(self, value: float) -> None: ...
    @property
    def altitude_m(self) -> float:
        """Pressure altitude in m."""

    @altitude_m.setter
    def altitude_m(self, value: float) -> None: ...
    @property
    def angle_of_attack_rad(self) -> float:
        """Angle of attack in rad, positive when the air comes from below the nose."""

    @angle_of_attack_rad.setter
    def angle_of_attack_rad(self, value: float) -> None: ...
    @property
    def latitude_rad(self) -> float:
        """North of the equator."""

    @latitude_rad.setter
    def latitude_rad(self, value: float) -> None: ...
    @property
    def longitude_rad(self) -> float:
        """East of Greenwich."""

    @longitude_rad.setter
    def longitude_rad(self, value: float) -> None: ...
    @property
    def position_altitude_m(self) -> float:
        """Above mean sea level, m."""

    @position_altitude_m.setter
    def position_altitude_m(self, value: float) -> None: ...
    @property
    def north_mps(self) -> float:
        """Towards true north."""

    @north_mps.setter
    def north_mps(self, value: float) -> None: ...
    @property
    def east_mps(self) -> float:
        """Towards east."""

    @east_mps.setter
    def east_mps(self, value: float) -> None: ...
    @property
    def down_mps(self) -> float:
        """Down."""

    @down_mps.setter
    def down_mps(self, value: float) -> None: ...
    @property
    def pilot_pitch(self) -> float:
        """Pulled, for nose up."""

    @pilot_pitch.setter
    def pilot_pitch(self, value: float) -> None: ...
    @property
    def pilot_roll(self) -> float:
        """To the right."""

    @pilot_roll.setter
    def pilot_roll(self, value: float) -> None: ...
    @property
    def pilot_yaw(self) -> float:
        """Right pedal."""

    @pilot_yaw.setter
    def pilot_yaw(self, value: float) -> None: ...
    @property
    def raw_specific_force_x_mps2(self) -> float:
        """Forward."""

    @raw_specific_force_x_mps2.setter
    def raw_specific_force_x_mps2(self, value: float) -> None: ...
    @property
    def raw_specific_force_y_mps2(self) -> float:
        """Right."""

    @raw_specific_force_y_mps2.setter
    def raw_specific_force_y_mps2(self, value: float) -> None: ...
    @property
    def raw_specific_force_z_mps2(self) -> float:
        """Down."""

    @raw_specific_force_z_mps2.setter
    def raw_specific_force_z_mps2(self, value: float) -> None: ...
    @property
    def raw_roll_rate_radps(self) -> float:
        """P, about x: right wing down."""

    @raw_roll_rate_radps.setter
    def raw_roll_rate_radps(self, value: float) -> None: ...
    @property
    def raw_pitch_rate_radps(self) -> float:
        """Q, about y: nose up."""

    @raw_pitch_rate_radps.setter
    def raw_pitch_rate_radps(self, value: float) -> None: ...
    @property
    def raw_yaw_rate_radps(self) -> float:
        """R, about z: nose right."""

    @raw_yaw_rate_radps.setter
    def raw_yaw_rate_radps(self, value: float) -> None: ...
    @property
    def magnetic_field_x_ut(self) -> float:
        """Forward."""

    @magnetic_field_x_ut.setter
    def magnetic_field_x_ut(self, value: float) -> None: ...
    @property
    def magnetic_field_y_ut(self) -> float:
        """Right."""

    @magnetic_field_y_ut.setter
    def magnetic_field_y_ut(self, value: float) -> None: ...
    @property
    def magnetic_field_z_ut(self) -> float:
        """Down."""

    @magnetic_field_z_ut.setter
    def magnetic_field_z_ut(self, value: float) -> None: ...
    @property
    def static_pressure_pa(self) -> float:
        """Static pressure in Pa, from a barometer."""

    @static_pressure_pa.setter
    def static_pressure_pa(self, value: float) -> None: ...
    @property
    def differential_pressure_pa(self) -> float:
        """Total minus static pressure in Pa, from a pitot tube."""

    @differential_pressure_pa.setter
    def differential_pressure_pa(self, value: float) -> None: ...
    @property
    def air_temperature_k(self) -> float:
        """Temperature of the air outside in K."""

    @air_temperature_k.setter
    def air_temperature_k(self, value: float) -> None: ...
    @property
    def gnss_latitude_rad(self) -> float:
        """North of the equator."""

    @gnss_latitude_rad.setter
    def gnss_latitude_rad(self, value: float) -> None: ...
    @property
    def gnss_longitude_rad(self) -> float:
        """East of Greenwich."""

    @gnss_longitude_rad.setter
    def gnss_longitude_rad(self, value: float) -> None: ...
    @property
    def gnss_position_altitude_m(self) -> float:
        """Above mean sea level, m."""

    @gnss_position_altitude_m.setter
    def gnss_position_altitude_m(self, value: float) -> None: ...
    @property
    def gnss_north_mps(self) -> float:
        """Towards true north."""

    @gnss_north_mps.setter
    def gnss_north_mps(self, value: float) -> None: ...
    @property
    def gnss_east_mps(self) -> float:
        """Towards east."""

    @gnss_east_mps.setter
    def gnss_east_mps(self, value: float) -> None: ...
    @property
    def gnss_down_mps(self) -> float:
        """Down."""

    @gnss_down_mps.setter
    def gnss_down_mps(self, value: float) -> None: ...
    @property
    def gnss_horizontal_accuracy_m(self) -> float:
        """Of the position, north and east, m."""

    @gnss_horizontal_accuracy_m.setter
    def gnss_horizontal_accuracy_m(self, value: float) -> None: ...
    @property
    def gnss_vertical_accuracy_m(self) -> float:
        """Of the altitude, m."""

    @gnss_vertical_accuracy_m.setter
    def gnss_vertical_accuracy_m(self, value: float) -> None: ...
    @property
    def gnss_speed_accuracy_mps(self) -> float:
        """Of each axis of the velocity, m/s."""

    @gnss_speed_accuracy_mps.setter
    def gnss_speed_accuracy_mps(self, value: float) -> None: ...
    @property
    def range_m(self) -> float:
        """Distance in m to the ground or an obstacle, along the body's z axis."""

    @range_m.setter
    def range_m(self, value: float) -> None: ...
    @property
    def weight_on_wheels(self) -> float:
        """Whether the wheels bear weight: 0 in the air, 1 on the ground."""

    @weight_on_wheels.setter
    def weight_on_wheels(self, value: float) -> None: ...
    @property
    def engine_speed_radps(self) -> float:
        """Speed of the engine's shaft, rad/s; of the first of several."""

    @engine_speed_radps.setter
    def engine_speed_radps(self, value: float) -> None: ...
    @property
    def battery_voltage_v(self) -> float:
        """Its voltage, V."""

    @battery_voltage_v.setter
    def battery_voltage_v(self, value: float) -> None: ...
    @property
    def battery_charge(self) -> float:
        """What is left of its charge, 0 empty, 1 full."""

    @battery_charge.setter
    def battery_charge(self, value: float) -> None: ...
    # </schema>
    @staticmethod
    def from_array(row: npt.ArrayLike) -> Measurements: ...
    def to_array(self) -> _Array: ...
    def __eq__(self, other: object, /) -> bool: ...
    __hash__: None  # type: ignore[assignment]

@final
class Surfaces:
    """Throttle 0..1; elevator (nose up), aileron (right), rudder (right) and elevator trim -1..1.

    The trim is NaN where there is none, and is then left as it is.
    """

    # <schema>
    def __new__(
        cls,
        *,
        throttle: float = ...,
        elevator: float = ...,
        aileron: float = ...,
        rudder: float = ...,
        elevator_trim: float = ...,
        flaps: float = ...,
        left_brake: float = ...,
        right_brake: float = ...,
        nose_wheel: float = ...,
        gear: float = ...,
    ) -> Surfaces: ...
    @property
    def throttle(self) -> float:
        """0 idle, 1 full."""

    @property
    def elevator(self) -> float:
        """Positive raises the nose."""

    @property
    def aileron(self) -> float:
        """Positive rolls right."""

    @property
    def rudder(self) -> float:
        """Positive yaws right."""

    @property
    def elevator_trim(self) -> float:
        """The elevator's trim, positive raises the nose."""

    @property
    def flaps(self) -> float:
        """Flaps, 0 up, 1 fully extended; NaN leaves them as they are."""

    @property
    def left_brake(self) -> float:
        """The left wheel's brake, 0 released, 1 full; NaN leaves it as it is."""

    @property
    def right_brake(self) -> float:
        """The right wheel's brake, likewise."""

    @property
    def nose_wheel(self) -> float:
        """The nose wheel's steering, positive to the right."""

    @property
    def gear(self) -> float:
        """The landing gear, 0 up, 1 down; NaN leaves it as it is."""

    # </schema>
    def to_array(self) -> _Array: ...
    def __eq__(self, other: object, /) -> bool: ...
    __hash__: None  # type: ignore[assignment]

@final
class Setpoints:
    """The set points of the autopilot, and the mode and progress of guidance."""

    # <schema>
    @property
    def airspeed_mps(self) -> float:
        """Indicated airspeed, m/s."""

    @property
    def heading_rad(self) -> float:
        """Magnetic heading, rad."""

    @property
    def altitude_m(self) -> float:
        """Pressure altitude, m, whatever the set point refers to."""

    @property
    def roll_rad(self) -> float:
        """Bank commanded by the heading loop, rad, right wing down."""

    @property
    def climb_rate_mps(self) -> float:
        """Climb rate commanded by the altitude loop, m/s, up."""

    @property
    def pitch_rad(self) -> float:
        """Pitch commanded by the climb-rate loop, rad, nose up."""

    @property
    def guidance_mode(self) -> str:
        """The mode."""

    @property
    def guidance_item(self) -> int:
        """The present part of the mode: of a pattern, the leg; of a plan, the item, from 1."""

    @property
    def guidance_elapsed_s(self) -> float:
        """How long it has been active, s of the plant's time."""

    @property
    def guidance_captured_airspeed_mps(self) -> float:
        """Indicated airspeed, m/s."""

    @property
    def guidance_captured_heading_rad(self) -> float:
        """Magnetic heading, rad, clockwise from magnetic north."""

    @property
    def guidance_captured_altitude_m(self) -> float:
        """Pressure altitude, m."""

    @property
    def altimeter_setting_pa(self) -> float:
        """The altimeter setting (QNH), Pa; in every state."""

    @property
    def altitude_reference(self) -> str:
        """What the altitude refers to."""

    @property
    def altitude_above_reference_m(self) -> float:
        """The altitude above what it refers to, m."""

    @property
    def course_rad(self) -> float:
        """True course of the path over the ground where it is nearest, rad."""

    @property
    def cross_track_m(self) -> float:
        """How far the aircraft is to the right of the path, m."""

    @property
    def to_go_m(self) -> float:
        """How far it is to the leg's end, a turn's item or a circle's centre, m."""

    @property
    def plan_hash(self) -> int:
        """The first 64 bits of the SHA-256 of the flight plan; 0 without one."""

    @property
    def plan_uploaded_unix_s(self) -> int:
        """When the flight plan was uploaded, s since 1970 (UTC)."""

    @property
    def contingency(self) -> str:
        """What the autopilot does by itself, and why."""

    @property
    def took_off_latitude_rad(self) -> float:
        """Geodetic latitude, rad."""

    @property
    def took_off_longitude_rad(self) -> float:
        """Longitude, rad."""

    @property
    def took_off_course_rad(self) -> float:
        """True course along the runway, rad."""

    @property
    def took_off_elevation_m(self) -> float:
        """Of the aircraft on its wheels there, m above mean sea level."""

    # </schema>
    def __eq__(self, other: object, /) -> bool: ...
    __hash__: None  # type: ignore[assignment]

@final
class Estimate:
    """Navigation's estimate."""

    # <schema>
    @property
    def roll_rad(self) -> float:
        """Right wing down, rad."""

    @property
    def pitch_rad(self) -> float:
        """Nose up, rad."""

    @property
    def heading_rad(self) -> float:
        """Magnetic heading, rad, clockwise from magnetic north."""

    @property
    def roll_rate_radps(self) -> float:
        """P, about x: right wing down."""

    @property
    def pitch_rate_radps(self) -> float:
        """Q, about y: nose up."""

    @property
    def yaw_rate_radps(self) -> float:
        """R, about z: nose right."""

    @property
    def airspeed_mps(self) -> float:
        """Indicated airspeed, m/s."""

    @property
    def true_airspeed_mps(self) -> float:
        """True airspeed, m/s."""

    @property
    def altitude_m(self) -> float:
        """Pressure altitude, m."""

    @property
    def climb_rate_mps(self) -> float:
        """Climb rate, m/s, up."""

    @property
    def side_force_mps2(self) -> float:
        """Specific force to the right, m/s²: 0 in a coordinated turn."""

    @property
    def load_factor(self) -> float:
        """Load factor, g, along the body's z axis, upwards."""

    @property
    def gust_load(self) -> float:
        """Standard deviation of the load that gusts cause, g."""

    @property
    def angle_of_attack_rad(self) -> float:
        """Angle of attack, rad."""

    @property
    def acceleration_mps2(self) -> float:
        """Acceleration along the flight path, without gusts, m/s²."""

    @property
    def output_latency_s(self) -> float:
        """The time from an output to its effect, s, measured by the elevator."""

    @property
    def elevator_play(self) -> float:
        """The play of the elevator, in the elevator's units of -1 to 1."""

    @property
    def airspeed_source(self) -> str:
        """Where the airspeed comes from."""

    @property
    def airspeed_uncertainty_mps(self) -> float:
        """Standard deviation of an airspeed that comes from the forces, m/s."""

    @property
    def latitude_rad(self) -> float:
        """Latitude by which the modes over the ground fly, rad; 0 before it is known."""

    @property
    def longitude_rad(self) -> float:
        """Longitude, likewise, rad."""

    @property
    def north_mps(self) -> float:
        """Velocity over the ground towards true north, likewise, m/s."""

    @property
    def east_mps(self) -> float:
        """Towards east, m/s."""

    @property
    def wind_north_mps(self) -> float:
        """Wind, towards true north, m/s."""

    @property
    def wind_east_mps(self) -> float:
        """Towards east, m/s."""

    @property
    def position_uncertainty_m(self) -> float:
        """Standard deviation of the horizontal position, m."""

    @property
    def reading_age_s(self) -> float:
        """How old the newest reading was when it arrived."""

    @property
    def reading_jitter_s(self) -> float:
        """The mean change of that age from one arrival to the next, s."""

    # </schema>
    def __eq__(self, other: object, /) -> bool: ...
    __hash__: None  # type: ignore[assignment]

@final
class Truth:
    """The true state of the built-in aircraft, without sensor errors."""

    # <schema>
    @property
    def time_s(self) -> float:
        """Simulated time, s."""

    @property
    def roll_rad(self) -> float:
        """Right wing down, rad."""

    @property
    def pitch_rad(self) -> float:
        """Nose up, rad."""

    @property
    def heading_rad(self) -> float:
        """True heading, rad."""

    @property
    def roll_rate_radps(self) -> float:
        """P, about x: right wing down."""

    @property
    def pitch_rate_radps(self) -> float:
        """Q, about y: nose up."""

    @property
    def yaw_rate_radps(self) -> float:
        """R, about z: nose right."""

    @property
    def specific_force_x_mps2(self) -> float:
        """Forward."""

    @property
    def specific_force_y_mps2(self) -> float:
        """Right."""

    @property
    def specific_force_z_mps2(self) -> float:
        """Down."""

    @property
    def true_airspeed_mps(self) -> float:
        """True airspeed, m/s."""

    @property
    def indicated_airspeed_mps(self) -> float:
        """Indicated airspeed, m/s."""

    @property
    def angle_of_attack_rad(self) -> float:
        """Angle of attack, rad."""

    @property
    def sideslip_rad(self) -> float:
        """Sideslip, rad, positive when the air comes from the right."""

    @property
    def north_m(self) -> float:
        """North of where the flight began, m."""

    @property
    def east_m(self) -> float:
        """East of where the flight began, m."""

    @property
    def altitude_m(self) -> float:
        """Above mean sea level, m."""

    @property
    def north_mps(self) -> float:
        """Towards true north."""

    @property
    def east_mps(self) -> float:
        """Towards east."""

    @property
    def down_mps(self) -> float:
        """Down."""

    @property
    def throttle(self) -> float:
        """Throttle after the engine's lag."""

    @property
    def elevator_rad(self) -> float:
        """Elevator deflection, rad, positive trailing edge down."""

    @property
    def aileron_rad(self) -> float:
        """Aileron deflection, rad, positive rolls right."""

    @property
    def rudder_rad(self) -> float:
        """Rudder deflection, rad, positive trailing edge left."""

    # </schema>
    def __eq__(self, other: object, /) -> bool: ...
    __hash__: None  # type: ignore[assignment]

@final
class RawTruth:
    """The truth that raw sensors measure, at one moment; 0 if not given."""

    # <schema>
    def __new__(
        cls,
        *,
        time_s: float = ...,
        pitch_rad: float = ...,
        roll_rad: float = ...,
        heading_rad: float = ...,
        roll_rate_radps: float = ...,
        pitch_rate_radps: float = ...,
        yaw_rate_radps: float = ...,
        specific_force_x_mps2: float = ...,
        specific_force_y_mps2: float = ...,
        specific_force_z_mps2: float = ...,
        static_pressure_pa: float = ...,
        differential_pressure_pa: float = ...,
        air_temperature_k: float = ...,
        latitude_rad: float = ...,
        longitude_rad: float = ...,
        position_altitude_m: float = ...,
        north_mps: float = ...,
        east_mps: float = ...,
        down_mps: float = ...,
        height_m: float = ...,
        throttle: float = ...,
    ) -> RawTruth: ...
    @property
    def time_s(self) -> float:
        """Simulated time, s, of up to four months."""

    @property
    def pitch_rad(self) -> float:
        """Nose above the horizon."""

    @property
    def roll_rad(self) -> float:
        """Right wing down."""

    @property
    def heading_rad(self) -> float:
        """True heading, rad."""

    @property
    def roll_rate_radps(self) -> float:
        """P, about x: right wing down."""

    @property
    def pitch_rate_radps(self) -> float:
        """Q, about y: nose up."""

    @property
    def yaw_rate_radps(self) -> float:
        """R, about z: nose right."""

    @property
    def specific_force_x_mps2(self) -> float:
        """Forward."""

    @property
    def specific_force_y_mps2(self) -> float:
        """Right."""

    @property
    def specific_force_z_mps2(self) -> float:
        """Down."""

    @property
    def static_pressure_pa(self) -> float:
        """Static pressure, Pa: from below the Dead Sea to 20 km."""

    @property
    def differential_pressure_pa(self) -> float:
        """Total minus static pressure, Pa; at the speed of sound 90 kPa."""

    @property
    def air_temperature_k(self) -> float:
        """Temperature of the undisturbed air, K."""

    @property
    def latitude_rad(self) -> float:
        """North of the equator."""

    @property
    def longitude_rad(self) -> float:
        """East of Greenwich."""

    @property
    def position_altitude_m(self) -> float:
        """Above mean sea level, m."""

    @property
    def north_mps(self) -> float:
        """Towards true north."""

    @property
    def east_mps(self) -> float:
        """Towards east."""

    @property
    def down_mps(self) -> float:
        """Down."""

    @property
    def height_m(self) -> float:
        """Above the ground, m."""

    @property
    def throttle(self) -> float:
        """Throttle after the engine's lag."""

    # </schema>
    def __eq__(self, other: object, /) -> bool: ...
    __hash__: None  # type: ignore[assignment]

@final
class RawSensors:
    """What raw sensors give of a true motion, with the errors of their data sheets.

    `sensors` is "phone", the thesis' of 2011, or "board", a present one; `field_ut` is the
    magnetic field in microtesla, north, east and down, up to 800 each. Raises ValueError for
    what is out of its range, with the range.
    """

    def __new__(
        cls,
        sensors: str,
        start: RawTruth,
        *,
        seed: int | None = None,
        field_ut: npt.ArrayLike | None = None,
    ) -> RawSensors: ...
    def step(self, truth: RawTruth) -> None:
        """Take the samples from the last truth to this one, at most 1 s later."""

    def read(self, into: Measurements) -> dict[str, float]:
        """Write what arrived since the last time, NaN for what did not.

        Returns when each reading arrived, in s, by its name.
        """

@final
class Event:
    """Something that happened once."""

    @property
    def tick(self) -> int: ...
    @property
    def time_s(self) -> float: ...
    @property
    def time_ns(self) -> int | None: ...
    @property
    def kind(self) -> str: ...
    @property
    def text(self) -> str: ...

@final
class Config:
    """A configuration as `fccd` reads it; `replace` gives another one."""

    def __new__(cls, text: str = "") -> Config: ...
    @staticmethod
    def load(path: _Path) -> Config: ...
    def __getitem__(self, key: str, /) -> Any: ...
    def __contains__(self, key: str, /) -> bool: ...
    def keys(self) -> list[str]: ...
    def replace(self, values: dict[str, Any]) -> Config: ...
    def to_toml(self) -> str: ...
    def to_dict(self) -> dict[str, Any]: ...
    def __eq__(self, other: object, /) -> bool: ...
    __hash__: None  # type: ignore[assignment]

@final
class Plan:
    """A flight plan, of QGroundControl or QGC WPL 110; PlanError has every problem of a text."""

    def __new__(cls, text: str) -> Plan: ...
    @staticmethod
    def read(path: _Path) -> Plan: ...
    def check(self, config: Config | str | None = None) -> list[dict[str, Any]]:
        """List what keeps the aircraft from flying it: `item` (from 1), `field` and `message`.

        Empty if nothing does. The aircraft, and the wind that is checked for, are those of the
        configuration; without one a Cessna 172's, in 20 kt.
        """

    @property
    def items(self) -> list[dict[str, Any]]: ...
    @property
    def hash(self) -> str: ...
    def to_text(self, kind: str) -> str:
        """Its text: "plan" is QGroundControl's JSON, "wpl" QGC WPL 110."""

    def write(self, path: _Path) -> None:
        """Write it in the format of the file's name: .plan, .waypoints, .wpl or .txt."""

    def __len__(self) -> int: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...

@final
class Autopilot:
    """The autopilot: `observe`, then `engage` once, then `step` for each tick."""

    def __new__(cls, config: Config | str | None = None) -> Autopilot: ...
    def observe(self, measurements: Measurements, dt: float = 0.025) -> None: ...
    def observe_series(self, measurements: npt.ArrayLike, dt: float = 0.025) -> None: ...
    def engage(
        self,
        measurements: Measurements,
        dt: float = 0.025,
        *,
        throttle: float,
        elevator: float = 0.0,
        aileron: float = 0.0,
        rudder: float = 0.0,
        elevator_trim: float | None = None,
    ) -> None: ...
    def step(self, measurements: Measurements, dt: float = 0.025) -> Surfaces: ...
    def fly(self, measurements: npt.ArrayLike, dt: float = 0.025) -> _Array: ...
    def failsafe(self, measurements: Measurements, dt: float = 0.025) -> Surfaces: ...
    def disengage(self) -> None: ...
    def command(self, **setpoints: Unpack[_Commanded]) -> None: ...
    @property
    def engaged(self) -> bool: ...
    @property
    def setpoints(self) -> Setpoints: ...
    @property
    def estimate(self) -> Estimate: ...
    @property
    def engage_inhibits(self) -> list[str]: ...
    @property
    def faults(self) -> list[str]: ...

@final
class Fleet:
    """Many autopilots stepped together: row i of an array belongs to autopilot i."""

    def __new__(cls, configs: Iterable[Config | str]) -> Fleet: ...
    def __len__(self) -> int: ...
    def observe(self, measurements: npt.ArrayLike, dt: float = 0.025) -> None: ...
    def engage(
        self, measurements: npt.ArrayLike, surfaces: npt.ArrayLike, dt: float = 0.025
    ) -> None: ...
    def step(self, measurements: npt.ArrayLike, dt: float = 0.025) -> _Array: ...
    @property
    def setpoints(self) -> _Array: ...

@final
class Machine:
    """The daemon's loop around a plant in Python: one call, one tick.

    Its states, failsafe, commands and recording are those of `fccd`; its clock does not
    move between calls.
    """

    def __new__(cls, config: Config | str | None = None) -> Machine: ...
    def step(
        self,
        measurements: Measurements | None = None,
        *,
        missing: Sequence[str] | None = ...,
        readback: Surfaces | tuple[float, float, float, float] | None = None,
        switch: bool | None = None,
        ages_s: Mapping[str, float] = ...,
    ) -> Surfaces | None:
        """One tick: the surfaces to set, or None while the loop does not hold the controls.

        `measurements` are those of the sensors, None if nothing arrives; `missing` names the
        readings that do not arrive in this tick: attitude, heading, body_rates,
        specific_force, airspeed, altitude. `ages_s` says of readings, by their names, how
        long before this tick they were taken (0 to 10 s). `readback` is the position of
        throttle (0..1), elevator, aileron and rudder (-1..1), None if the aircraft has none;
        `switch` the engage switch, None if there is none.
        """

    def engage(self) -> None: ...
    def disengage(self) -> None: ...
    def stop(self) -> None: ...
    def command(self, **setpoints: Unpack[_Commanded]) -> None: ...
    def replace_plan(self, file: _Path, item: int = 1) -> None:
        """Fly another plan from the next tick on, from an item on.

        Raises PlanError with all problems of the file. That it was replaced, or why not, is an
        event of that tick.
        """

    def events(self) -> list[Event]: ...
    def records(self) -> _Records: ...
    def record_to(
        self,
        folder: _Path,
        *,
        aircraft: str = "lockstep",
        ending: str = "recorded so far",
    ) -> list[Path]: ...
    @property
    def state(self) -> str: ...
    @property
    def engage_inhibits(self) -> list[str]: ...
    @property
    def faults(self) -> list[str]: ...
    @property
    def holds_control(self) -> bool: ...
    @property
    def setpoints(self) -> Setpoints: ...
    @property
    def learned_airframe(self) -> dict[str, float] | None:
        """What was learned of the aircraft: the keys of `[autopilot.airframe]`.

        None before a minute with an airspeed sensor that is believed and a throttle that is
        read back.
        """

    @property
    def estimate(self) -> Estimate: ...
    @property
    def tick(self) -> int: ...
    @property
    def time_s(self) -> float: ...
    @property
    def period_s(self) -> float: ...

@final
class BuiltInAircraft:
    """The built-in aircraft in lockstep: six degrees of freedom, by `[built-in]`."""

    def __new__(cls, config: Config | str | None = None) -> BuiltInAircraft: ...
    def step(self, surfaces: Surfaces | None, dt: float = 0.025) -> Measurements: ...
    @property
    def truth(self) -> Truth: ...
    @property
    def impact(self) -> Truth | None: ...
    @property
    def switch(self) -> bool: ...
    @property
    def controls(self) -> Surfaces: ...

@final
class Flight:
    """A flight that is over."""

    @property
    def records(self) -> _Records: ...
    @property
    def truth(self) -> _Records: ...
    @property
    def events(self) -> list[Event]: ...
    @property
    def seconds(self) -> float: ...
    @property
    def took_s(self) -> float: ...
    @property
    def times_real_time(self) -> float: ...
    @property
    def state(self) -> str: ...
    @property
    def ending(self) -> str: ...
    @property
    def impact(self) -> dict[str, float] | None: ...
    @property
    def score(self) -> dict[str, Any] | None: ...
    @property
    def timing(self) -> dict[str, Any]: ...

def fly(
    config: Config | str | None = None,
    *,
    seconds: float | None = None,
    sensor: Callable[[float, Measurements], Measurements | None] | None = None,
    controller: Callable[[float, Measurements, Setpoints, Surfaces], Surfaces] | None = None,
    real_time: bool = False,
    keep: bool = True,
) -> Flight:
    """Fly the built-in aircraft, in lockstep or in real time; EngageError if it never engaged."""

@final
class Pid:
    """PID controller with anti-windup, limits, feed-forward and bumpless engagement."""

    def __new__(
        cls,
        kp: float = 0.0,
        ki: float = 0.0,
        kd: float = 0.0,
        *,
        derivative_tau_s: float = 0.0,
        output_min: float = ...,
        output_max: float = ...,
        output_rate_per_s: float = ...,
        tracking_tau_s: float | None = None,
    ) -> Pid: ...
    def step(
        self,
        setpoint: float,
        measurement: float,
        dt: float,
        *,
        feed_forward: float = 0.0,
        gain_scale: float = 1.0,
    ) -> float: ...
    def engage(
        self,
        output: float,
        setpoint: float,
        measurement: float,
        *,
        feed_forward: float = 0.0,
        gain_scale: float = 1.0,
    ) -> None: ...
    @property
    def integral(self) -> float: ...

@final
class LowPass:
    """First-order low pass."""

    def __new__(cls, tau_s: float) -> LowPass: ...
    def step(self, value: float, dt: float) -> float: ...
    def run(self, inputs: npt.ArrayLike, dt: float) -> _Array: ...
    def reset(self, output: float) -> None: ...
    @property
    def output(self) -> float: ...

@final
class HighPass:
    """First-order high pass."""

    def __new__(cls, tau_s: float) -> HighPass: ...
    def step(self, value: float, dt: float) -> float: ...
    def run(self, inputs: npt.ArrayLike, dt: float) -> _Array: ...
    def reset(self, constant: float) -> None: ...

@final
class RateLimit:
    """Limits how fast a signal may move."""

    def __new__(cls, rate_per_s: float) -> RateLimit: ...
    def step(self, value: float, dt: float) -> float: ...
    def run(self, inputs: npt.ArrayLike, dt: float) -> _Array: ...
    def reset(self, output: float) -> None: ...

@final
class Complementary:
    """First-order complementary filter: a rate in the short run, a measurement in the long."""

    def __new__(cls, tau_s: float) -> Complementary: ...
    def predict(self, rate: float, dt: float) -> None: ...
    def correct(self, measurement: float, dt: float) -> None: ...
    def reset(self, value: float) -> None: ...
    @property
    def value(self) -> float: ...

@final
class SquareRootProfile:
    """How fast to close an error so that a constant deceleration ends at 0."""

    def __new__(cls, gain_per_s: float, deceleration: float) -> SquareRootProfile: ...
    def speed(self, error: float) -> float: ...

@overload
def pressure_pa(altitude_m: float) -> float: ...
@overload
def pressure_pa(altitude_m: npt.ArrayLike) -> _Array: ...
@overload
def pressure_altitude_m(pressure_pa: float) -> float: ...
@overload
def pressure_altitude_m(pressure_pa: npt.ArrayLike) -> _Array: ...
@overload
def density_ratio(altitude_m: float) -> float: ...
@overload
def density_ratio(altitude_m: npt.ArrayLike) -> _Array: ...
@overload
def true_airspeed_mps(equivalent_mps: float, altitude_m: float) -> float: ...
@overload
def true_airspeed_mps(equivalent_mps: npt.ArrayLike, altitude_m: float) -> _Array: ...
@overload
def wrap_pi(angle_rad: float) -> float: ...
@overload
def wrap_pi(angle_rad: npt.ArrayLike) -> _Array: ...
@overload
def wrap_two_pi(angle_rad: float) -> float: ...
@overload
def wrap_two_pi(angle_rad: npt.ArrayLike) -> _Array: ...
def quaternion_from_euler(roll_rad: float, pitch_rad: float, heading_rad: float) -> _Array: ...
def euler_from_quaternion(quaternion: npt.ArrayLike) -> tuple[float, float, float]: ...
def body_to_earth(quaternion: npt.ArrayLike, vector: npt.ArrayLike) -> _Array: ...
def earth_to_body(quaternion: npt.ArrayLike, vector: npt.ArrayLike) -> _Array: ...
def calibrate(samples: npt.ArrayLike, strength: float) -> dict[str, Any]:
    """Find bias, scale and misalignment by which all samples (n, 3) have one strength.

    Gravity's in m/s2 of an accelerometer at rest, the field's in uT of a magnetometer. Raises
    ValueError with the reason if there is none.
    """

def calibrate_gyroscope(*, gyroscope: _Source, accelerometer: _Source) -> dict[str, Any]:
    """Find bias, scale and misalignment of a gyroscope that was turned between positions at rest.

    Left alone for 11 s, then by quarter and half turns about each of its axes, with 3 s of rest
    after each. Both are times in s and samples (n, 3): rad/s as given, m/s2 calibrated and along
    the same axes. Raises ValueError with the reason if there is none.
    """

def levelled(force_mps2: npt.ArrayLike) -> list[list[float]]:
    """Find the smallest rotation after which the force (3,) of a level aircraft points up."""

def level_and_nose_up(level_mps2: npt.ArrayLike, nose_up_mps2: npt.ArrayLike) -> list[list[float]]:
    """Find how sensors are turned, by the forces (3,) of the aircraft level and with its nose up.

    From their axes to the body's. Raises ValueError if both are parallel.
    """

def constant_dip(down: npt.ArrayLike, field: npt.ArrayLike) -> list[list[float]]:
    """Find the rotation of a magnetometer after which the field's dip is the same everywhere.

    Both are (n, 3), of the same attitudes. Raises ValueError if they do not determine it.
    """

def navigate(
    *,
    gyroscope: _Source | None = None,
    accelerometer: _Source | None = None,
    magnetometer: _Source | None = None,
    static_pressure: _Source | None = None,
    differential_pressure: _Source | None = None,
    airspeed: _Source | None = None,
    gnss_position: _Source | None = None,
    gnss_velocity: _Source | None = None,
    delays_s: dict[str, float] | None = None,
    mounting: npt.ArrayLike | dict[str, npt.ArrayLike] | None = None,
    year: float | None = None,
) -> dict[str, Any]:
    """Compute attitude, velocity, position and wind from raw samples: arrays with sigmas."""

@final
class Expiry:
    """One deadline that was served."""

    @property
    def number(self) -> int: ...
    @property
    def scheduled_ns(self) -> int: ...
    @property
    def woke_ns(self) -> int: ...
    @property
    def missed(self) -> int: ...
    @property
    def lateness_ns(self) -> int: ...

@final
class TimingSummary:
    """How well a timer kept time."""

    @property
    def rate_hz(self) -> float: ...
    @property
    def ticks(self) -> int: ...
    @property
    def missed(self) -> int: ...
    @property
    def runtime_s(self) -> float: ...
    @property
    def period_mean_ms(self) -> float: ...
    @property
    def period_median_ms(self) -> float: ...
    @property
    def period_min_ms(self) -> float: ...
    @property
    def period_max_ms(self) -> float: ...
    @property
    def period_range_ms(self) -> float: ...
    @property
    def period_within_2_percent(self) -> float: ...
    @property
    def lateness_p50_us(self) -> float: ...
    @property
    def lateness_p99_us(self) -> float: ...
    @property
    def lateness_p99_9_us(self) -> float: ...
    @property
    def lateness_max_us(self) -> float: ...

@final
class Timer:
    """A periodic timer of the kernel: "timerfd", "posix" or "nanosleep"."""

    def __new__(cls, period_s: float, kind: str = "timerfd") -> Timer: ...
    def start(self) -> None: ...
    def wait(self) -> Expiry: ...
    def __iter__(self) -> Iterator[Expiry]: ...
    def __next__(self) -> Expiry: ...
    def summary(self) -> TimingSummary: ...
    @property
    def kind(self) -> str: ...
    @property
    def period_s(self) -> float: ...

@final
class Recording:
    """A recording of any plant, whole or cut off."""

    def __new__(cls, path: _Path) -> Recording: ...
    @property
    def records(self) -> _Records: ...
    @property
    def columns(self) -> dict[str, dict[str, Any]]: ...
    @property
    def events(self) -> list[Event]: ...
    @property
    def cut(self) -> str | None: ...
    @property
    def damages(self) -> list[dict[str, Any]]: ...
    @property
    def about(self) -> dict[str, Any]: ...
    @property
    def config(self) -> Config: ...
    def account(self) -> dict[str, Any]: ...
    @property
    def is_whole(self) -> bool: ...
    @property
    def path(self) -> Path: ...
    @property
    def bytes(self) -> int: ...
    def to_pandas(self) -> Any: ...
    def __len__(self) -> int: ...

def list_recordings(folder: _Path) -> list[dict[str, Any]]: ...
def recover(path: _Path) -> dict[str, Any]: ...
def report(
    path: _Path,
    *,
    html: _Path | None = None,
    svg: _Path | None = None,
    csv: _Path | None = None,
) -> dict[str, Any]: ...
def replay(
    paths: _Path | Iterable[_Path], config: Config | str | None = None
) -> dict[str, Any]: ...

@final
class Watcher:
    """Watches the loop of any plant on this machine, by its instance's name."""

    def __new__(cls, instance: str = "fccd") -> Watcher: ...
    def latest(self, timeout_s: float = 1.0) -> np.void | None: ...
    def records(self) -> _Records: ...
    def events(self) -> list[Event]: ...
    def status(self, timeout_s: float = 1.5) -> dict[str, Any] | None: ...
    @property
    def columns(self) -> dict[str, dict[str, Any]]: ...
    @property
    def info(self) -> dict[str, Any]: ...
    @property
    def is_alive(self) -> bool: ...
    def __iter__(self) -> Iterator[np.void]: ...
    def __next__(self) -> np.void: ...

@final
class Commander:
    """Sends commands to the loop of any plant on this machine; each waits until carried out."""

    def __new__(cls, instance: str = "fccd") -> Commander: ...
    def engage(self) -> int: ...
    def disengage(self) -> int: ...
    def stop(self) -> int: ...
    def set(self, **setpoints: float) -> int: ...
    def replace_plan(self, file: _Path, item: int = 1) -> int:
        """Fly another plan, from an item on; refused with all problems of the file.

        The daemon reads it. Refused, too, low over a runway and in a landing.
        """
