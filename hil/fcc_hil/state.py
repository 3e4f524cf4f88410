"""The values exchanged between the plant and its pilot: state and controls, in SI."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(slots=True)
class State:
    """The aircraft at one instant, SI units and radians.

    Body axes are x forward, y right, z down. Heading is clockwise from true north.
    """

    time_s: float
    """Simulated time since the plant was set up."""
    pitch_rad: float
    """Nose above the horizon."""
    roll_rad: float
    """Right wing down."""
    heading_rad: float
    """True, 0..2 pi."""
    roll_rate_radps: float
    """P, right wing down."""
    pitch_rate_radps: float
    """Q, nose up."""
    yaw_rate_radps: float
    """R, nose right."""
    specific_force_x_mps2: float
    """Specific force, forward."""
    specific_force_y_mps2: float
    """To the right."""
    specific_force_z_mps2: float
    """Down: -9.81 in level flight."""
    airspeed_mps: float
    """Calibrated airspeed: the reading of an ideal indicator."""
    true_airspeed_mps: float
    mach: float
    altitude_m: float
    """Pressure altitude, above the standard pressure level."""
    pressure_pa: float
    """Static, at the aircraft."""
    temperature_k: float
    """Of the air at the aircraft."""
    angle_of_attack_rad: float
    """Positive when the air comes from below the nose."""
    sideslip_rad: float
    """Positive when the air comes from the right of the nose."""
    latitude_rad: float
    longitude_rad: float
    elevation_m: float
    """Geometric, above mean sea level."""
    height_m: float
    """Above the ground."""
    north_mps: float
    """Velocity over the ground."""
    east_mps: float
    down_mps: float
    wind_north_mps: float
    """Velocity of the air over the ground, gusts included."""
    wind_east_mps: float
    wind_down_mps: float
    on_ground: bool
    engine_speed_radps: float = 0.0
    """Of the first engine."""
    battery_voltage_v: float = 0.0


@dataclass(slots=True)
class Controls:
    """The commands of the pilot or the autopilot, with the project's signs."""

    elevator: float = 0.0
    """-1..1, positive raises the nose."""
    aileron: float = 0.0
    """-1..1, positive rolls right."""
    rudder: float = 0.0
    """-1..1, positive yaws right."""
    throttle: float = 0.0
    """0 idle .. 1 full, all engines."""
    elevator_trim: float | None = None
    """-1..1, positive raises the nose; None leaves it where it is."""
    flaps: float | None = None
    """0 up .. 1 full; None leaves them as they are."""
    left_brake: float | None = None
    """0 released .. 1 full; None leaves it as it is."""
    right_brake: float | None = None
    nose_wheel: float | None = None
    """-1..1, positive to the right; None: it is steered with the rudder."""
    gear: float | None = None
    """0 up .. 1 down; None leaves it as it is."""
