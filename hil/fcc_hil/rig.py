"""What a flight under test is flown on: lockstep or real time, behind one set of calls.

All times are simulated ones, in s since the aircraft was set up.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from .sensor_faults import SensorFault
from .truth import Truth

ENGAGED = "standby -> engaged"
FAILSAFE = "engaged -> failsafe"
RELEASED = "actuators released"


class FlightError(RuntimeError):
    """The flight could not be flown as it was asked for: no verdict on the autopilot."""


@dataclass(frozen=True)
class Happening:
    """Something that the autopilot said, or showed, of itself."""

    time_s: float
    text: str


class Rig(Protocol):
    """An aircraft with an autopilot, flown on when it is asked for."""

    name: str
    """What flies, how: for titles."""

    failsafe_shows_after_s: float
    """How long after it a failsafe can be seen: 0 where its state is told."""

    @property
    def time_s(self) -> float:
        """Where the flight is."""

    @property
    def happenings(self) -> Sequence[Happening]:
        """What happened so far."""

    @property
    def holds_control(self) -> bool:
        """Whether the autopilot holds the controls."""

    @property
    def left_deflected(self) -> str:
        """What was not centred when the controls were last released; empty if nothing."""

    def prepare(self) -> None:
        """Fly by hand until the autopilot is ready to take over."""

    def throw_switch(self, *, on: bool) -> None:
        """Throw the engage switch."""

    def fly_to(self, time_s: float, until: Callable[[], bool] | None = None) -> None:
        """Fly on to a time, or until something holds."""

    def set_faults(self, faults: Sequence[SensorFault]) -> None:
        """Put faults into the sensors in place of those that were."""

    def truth(self) -> Truth:
        """Return what was flown so far."""

    def leave_recording(self, path: Path) -> list[Path]:
        """Leave the autopilot's recording at a path, `.mcap`; return what there is."""

    def close(self) -> None:
        """End the flight; may be called again."""
