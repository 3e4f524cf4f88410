"""A daemon that flies the stand-in in real time: what is the same wherever it runs.

Everything here is known by the simulator itself. What a daemon tells of itself is known
where it runs on this machine (`daemon_rig`), and not on another host (`remote_rig`).
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from pathlib import Path

from .cockpit import OVERRIDE_JOYSTICK
from .fly import ENGAGE_SWITCH
from .process import StandInProcess
from .rig import FlightError, Happening
from .sensor_faults import SensorFault
from .standin import Progress
from .truth import Row, Truth

_LOOK_S = 0.02
# Real time may run so much longer than the simulated flight before we give up.
_PATIENCE = 2.0
_PATIENCE_MORE_S = 20.0


class StandInRig:
    """A stand-in in a process of its own, flown by a daemon."""

    failsafe_shows_after_s = 0.0

    def __init__(self, simulator: StandInProcess, name: str) -> None:
        """Watch a stand-in that runs."""
        self.simulator = simulator
        self.name = name
        self.happenings: list[Happening] = []
        self.switch_is_on = False
        self.progress: Progress = simulator.progress()
        self._rows: list[Row] = []
        self._is_closed = False

    @property
    def time_s(self) -> float:
        """Return where the flight is now: it flies on by itself."""
        return self._look().time_s

    @property
    def holds_control(self) -> bool:
        """Return whether the daemon holds the joystick or the throttles."""
        return self.progress.overridden

    @property
    def left_deflected(self) -> str:
        """Return in words what was not centred when the joystick was last released."""
        releases = [r for r in self.simulator.releases() if r.path == OVERRIDE_JOYSTICK]
        if not releases:
            return ""
        last = releases[-1]
        stand = {"elevator": last.elevator, "aileron": last.aileron, "rudder": last.rudder}
        off = [f"{name} {value:+.2f}" for name, value in stand.items() if value != 0.0]
        return f"released with {', '.join(off)}" if off else ""

    def throw_switch(self, *, on: bool) -> None:
        """Throw the engage switch inside the simulator, as a person would."""
        self.switch_is_on = on
        self.simulator.write(ENGAGE_SWITCH, float(on))

    def fly_to(self, time_s: float, until: Callable[[], bool] | None = None) -> None:
        """Wait until the flight is at a time, or something holds."""
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
        """Put faults into what the stand-in replies."""
        self.simulator.set_sensor_faults(faults)

    def truth(self) -> Truth:
        """Return what was flown so far, 40 rows a second."""
        if not self._is_closed:
            self._rows += self.simulator.rows(len(self._rows))
        return Truth(self._rows)

    def leave_recording(self, path: Path) -> list[Path]:  # noqa: ARG002
        """Leave nothing: the recording is where the daemon is."""
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
        """Look at the simulator, and take note of what happened."""
        if not self._is_closed:
            self.progress = self.simulator.progress()
        return self.progress
