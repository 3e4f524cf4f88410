"""The flight control computer: its autopilot, stepped by hand. SI and radians."""

from typing import final

@final
class Measurements:
    """What the sensors measure at one instant."""

    pitch_rad: float
    roll_rad: float
    heading_rad: float
    roll_rate_radps: float
    pitch_rate_radps: float
    yaw_rate_radps: float
    specific_force_x_mps2: float
    specific_force_y_mps2: float
    specific_force_z_mps2: float
    airspeed_mps: float
    altitude_m: float
    def __new__(
        cls,
        *,
        pitch_rad: float,
        roll_rad: float,
        heading_rad: float,
        roll_rate_radps: float,
        pitch_rate_radps: float,
        yaw_rate_radps: float,
        specific_force_x_mps2: float,
        specific_force_y_mps2: float,
        specific_force_z_mps2: float,
        airspeed_mps: float,
        altitude_m: float,
    ) -> Measurements: ...

@final
class Surfaces:
    """Throttle 0..1; elevator (nose up), aileron (right), rudder (right) -1..1."""

    @property
    def throttle(self) -> float: ...
    @property
    def elevator(self) -> float: ...
    @property
    def aileron(self) -> float: ...
    @property
    def rudder(self) -> float: ...

@final
class Setpoints:
    """What the autopilot aims for."""

    @property
    def airspeed_mps(self) -> float: ...
    @property
    def heading_rad(self) -> float: ...
    @property
    def altitude_m(self) -> float: ...
    @property
    def roll_rad(self) -> float: ...
    @property
    def climb_rate_mps(self) -> float: ...
    @property
    def pitch_rad(self) -> float: ...

@final
class Autopilot:
    """The autopilot: `observe`, then `engage` once, then `step` for each tick."""

    def __new__(cls, config: str = "") -> Autopilot: ...
    def observe(self, measurements: Measurements, dt: float = 0.025) -> None: ...
    def engage(
        self,
        measurements: Measurements,
        dt: float = 0.025,
        *,
        throttle: float,
        elevator: float = 0.0,
        aileron: float = 0.0,
        rudder: float = 0.0,
    ) -> None: ...
    def step(self, measurements: Measurements, dt: float = 0.025) -> Surfaces: ...
    def order(
        self,
        *,
        airspeed_mps: float | None = None,
        heading_rad: float | None = None,
        altitude_m: float | None = None,
    ) -> None: ...
    @property
    def setpoints(self) -> Setpoints: ...
