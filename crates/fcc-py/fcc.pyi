"""The flight control computer: its autopilot, stepped by hand. SI and radians."""

from collections.abc import Sequence
from os import PathLike
from pathlib import Path
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

@final
class Event:
    """Something that happened in the loop, in the words of a recording."""

    @property
    def time_s(self) -> float:
        """When, on the loop's clock."""

    @property
    def tick(self) -> int: ...
    @property
    def text(self) -> str: ...

@final
class Machine:
    """The daemon's loop, one call one tick, on a clock that stands still between calls.

    `config` is the text of a configuration file without `[x-plane]` and `[built-in]`:
    Python is the aircraft. Raises ValueError with every problem in it.
    """

    def __new__(cls, config: str = "") -> Machine: ...
    def step(
        self,
        measurements: Measurements | None = None,
        *,
        missing: Sequence[str] = (),
        standing: tuple[float, float, float, float] | None = None,
        switch: bool | None = None,
    ) -> Surfaces | None:
        """One tick: the surfaces to set, or None while the controls are somebody else's.

        `measurements` is what the sensors say, None if nothing comes at all; `missing`
        names those that say nothing in this tick: attitude, heading, body_rates,
        specific_force, airspeed, altitude. `standing` is where throttle (0..1),
        elevator, aileron and rudder (-1..1) stand, None if the aircraft does not tell;
        `switch` the engage switch, None if there is none.
        """

    def engage(self) -> None:
        """Order the loop to take over in the next tick, if nothing blocks it."""

    def disengage(self) -> None:
        """Order the loop to let go in the next tick."""

    def stop(self) -> None:
        """Order the loop to let go and end in the next tick."""

    def order(
        self,
        *,
        airspeed_mps: float | None = None,
        heading_rad: float | None = None,
        altitude_m: float | None = None,
    ) -> None:
        """Order other set points; ends a pattern."""

    def events(self) -> list[Event]:
        """Return what happened since the last call."""

    def record_to(
        self,
        folder: str | PathLike[str],
        *,
        aircraft: str = "lockstep",
        ending: str = "recorded so far",
    ) -> list[Path]:
        """Write every tick and event so far as the daemon records; return the files.

        Raises OSError if the folder cannot be written to.
        """

    @property
    def state(self) -> str:
        """One of standby, engaged, failsafe, stopped."""

    @property
    def blockers(self) -> list[str]:
        """Why the loop may not engage, in words."""

    @property
    def faults(self) -> list[str]:
        """What makes going on unsafe, in words."""

    @property
    def holds_control(self) -> bool: ...
    @property
    def setpoints(self) -> Setpoints: ...
    @property
    def tick(self) -> int:
        """The number of the last tick; 0 before the first."""

    @property
    def time_s(self) -> float:
        """The loop's clock at the last tick."""

    @property
    def period_s(self) -> float: ...
