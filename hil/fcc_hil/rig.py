"""The interface of what a flight under test is flown on: lockstep or real time.

All times are simulated ones, in s since the aircraft was set up.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from .faulty_sensors import SensorFault
from .truth import Truth

ENGAGED = "standby -> engaged"
FAILSAFE = "engaged -> failsafe"
RELEASED = "release sent to the actuators"


class FlightError(RuntimeError):
    """The flight could not be flown: no verdict on the autopilot."""


@dataclass(frozen=True)
class Event:
    """An event that the autopilot reported or showed."""

    time_s: float
    text: str


class Rig(Protocol):
    """An aircraft with an autopilot, flown on request."""

    name: str
    """Aircraft and method, for titles."""

    failsafe_shows_after_s: float
    """How long after its beginning a failsafe can be detected: 0 if the state is reported."""

    @property
    def time_s(self) -> float:
        """The time of the flight."""

    @property
    def events(self) -> Sequence[Event]:
        """The events so far."""

    @property
    def holds_control(self) -> bool:
        """Whether the autopilot has control."""

    @property
    def not_centred(self) -> str:
        """The surfaces not centred at the last release; empty if all were."""

    def prepare(self) -> None:
        """Fly until the autopilot is ready to engage."""

    def set_switch(self, *, on: bool) -> None:
        """Move the engage switch."""

    def fly_to(self, time_s: float, until: Callable[[], bool] | None = None) -> None:
        """Fly to a time, or until a condition is met."""

    def set_faults(self, faults: Sequence[SensorFault]) -> None:
        """Replace the faults of the sensors."""

    def truth(self) -> Truth:
        """Return the truth so far."""

    def save_recording(self, path: Path) -> list[Path]:
        """Save the autopilot's recording under a path, `.mcap`; return the files."""

    def close(self) -> None:
        """End the flight; may be called again."""
