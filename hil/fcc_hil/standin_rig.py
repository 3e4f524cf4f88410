"""A daemon that flies the stand-in in real time: the part common to this and another host.

Everything here is observed in the simulator. The daemon's own messages are available on this
machine (`daemon_rig`), and not from another host (`remote_rig`).
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from pathlib import Path

from .cockpit import OVERRIDE_JOYSTICK
from .faulty_sensors import SensorFault
from .fly import ENGAGE_SWITCH
from .process import StandInProcess
from .rig import Event, FlightError
from .standin import Progress
from .truth import Row, Truth

_LOOK_S = 0.02
# Real time may exceed the simulated flight by this before giving up.
_PATIENCE = 2.0
_PATIENCE_MORE_S = 20.0


class StandInRig:
    """A stand-in in a separate process, flown by a daemon."""

    failsafe_shows_after_s = 0.0

    def __init__(self, simulator: StandInProcess, name: str) -> None:
        """Observe a running stand-in."""
        self.simulator = simulator
        self.name = name
        self.events: list[Event] = []
        self.switch_is_on = False
        self.progress: Progress = simulator.progress()
        self._rows: list[Row] = []
        self._is_closed = False

    @property
    def time_s(self) -> float:
        """Return the present time of the flight, which runs by itself."""
        return self._look().time_s

    @property
    def holds_control(self) -> bool:
        """Return whether the daemon overrides the joystick or the throttles."""
        return self.progress.overridden

    @property
    def not_centred(self) -> str:
        """Describe the surfaces that were not centred when the joystick was last released."""
        releases = [r for r in self.simulator.releases() if r.path == OVERRIDE_JOYSTICK]
        if not releases:
            return ""
        last = releases[-1]
        stand = {"elevator": last.elevator, "aileron": last.aileron, "rudder": last.rudder}
        off = [f"{name} {value:+.2f}" for name, value in stand.items() if value != 0.0]
        return f"released with {', '.join(off)}" if off else ""

    def set_switch(self, *, on: bool) -> None:
        """Move the engage switch inside the simulator, as a person would."""
        self.switch_is_on = on
        self.simulator.write(ENGAGE_SWITCH, float(on))

    def fly_to(self, time_s: float, until: Callable[[], bool] | None = None) -> None:
        """Wait until a time of the flight, or until a condition is met."""
        progress = self._look()
        give_up_s = (
            time.monotonic() + _PATIENCE * max(0.0, time_s - progress.time_s) + _PATIENCE_MORE_S
        )
        while progress.time_s < time_s and not (until is not None and until()):
            if time.monotonic() > give_up_s:
                raise FlightError(
                    f"simulated time runs too slowly or not at all: it is at "
                    f"{progress.time_s:.1f} s and not at {time_s:.1f} s; is the machine overloaded?"
                )
            time.sleep(_LOOK_S)
            progress = self._look()

    def set_faults(self, faults: Sequence[SensorFault]) -> None:
        """Put faults into the stand-in's replies."""
        self.simulator.set_sensor_faults(faults)

    def truth(self) -> Truth:
        """Return the truth so far, 40 rows a second."""
        if not self._is_closed:
            self._rows += self.simulator.rows(len(self._rows))
        return Truth(self._rows)

    def save_recording(self, path: Path) -> list[Path]:  # noqa: ARG002
        """Save nothing: the recording is on the daemon's host."""
        return []

    def close(self) -> None:
        """End the stand-in; may be called again."""
        if not self._is_closed:
            self.truth()
            self._is_closed = True
            self.simulator.stop()

    def _await_subscriptions(self, patience_s: float, otherwise: str) -> None:
        give_up_s = time.monotonic() + patience_s
        while self._look().subscriptions == 0:
            if time.monotonic() > give_up_s:
                raise FlightError(otherwise)
            time.sleep(_LOOK_S)

    def _look(self) -> Progress:
        """Query the simulator, and note events."""
        if not self._is_closed:
            self.progress = self.simulator.progress()
        return self.progress
