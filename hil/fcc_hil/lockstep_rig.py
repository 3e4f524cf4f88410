"""JSBSim and the daemon's own loop in lockstep: no clock, no network, always the same way."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

import fcc

from .lockstep import measurements
from .noise import SensorNoise
from .plant import STEPS_PER_SECOND, Plant
from .quantities import SENSORS
from .rig import FlightError, Happening
from .sensor_faults import FaultySensors, SensorFault
from .standin import Settings
from .state import Controls
from .truth import Row, Truth, row

_STANDBY_S = 2.0
"""Navigation settles for 1 s before the autopilot may take over."""


class LockstepRig:
    """An aircraft of JSBSim's and a loop that is stepped by hand."""

    failsafe_shows_after_s = 0.0
    left_deflected = ""
    """Centring is the actuator's business, and here is none."""

    def __init__(self, settings: Settings, plant: Plant, machine: fcc.Machine) -> None:
        """Put them together. Raises FlightError if their rates do not fit."""
        steps = machine.period_s * STEPS_PER_SECOND
        if abs(steps - round(steps)) > 1e-6 or round(steps) < 1:
            raise FlightError(
                f"a loop of {1.0 / machine.period_s:g} Hz does not fit JSBSim's "
                f"{STEPS_PER_SECOND} steps a second: choose loop.rate_hz = 20, 40, 60 or 120, "
                "or fly in real time"
            )
        self.name = f"{settings.aircraft} in lockstep"
        self.plant = plant
        self.machine = machine
        self.happenings: list[Happening] = []
        self._steps = round(steps)
        self._noise = SensorNoise(settings.seed) if settings.noise else None
        self._sensors = FaultySensors()
        self._switch = False
        self._rows: list[Row] = [row(plant.state(), plant.controls)]

    @property
    def time_s(self) -> float:
        """Return where the flight is."""
        return self.plant.time_s

    @property
    def holds_control(self) -> bool:
        """Return whether the loop holds the controls."""
        return self.machine.holds_control

    def prepare(self) -> None:
        """Let navigation settle while the trimmed aircraft flies by itself."""
        self.fly_to(self.time_s + _STANDBY_S)

    def throw_switch(self, *, on: bool) -> None:
        """Throw the engage switch; the loop sees it in the next tick."""
        self._switch = on

    def fly_to(self, time_s: float, until: Callable[[], bool] | None = None) -> None:
        """Fly on to a time, or until something holds."""
        while self.plant.time_s < time_s - 1e-6:
            self._fly_a_tick()
            if until is not None and until():
                return

    def set_faults(self, faults: Sequence[SensorFault]) -> None:
        """Put faults into the sensors in place of those that were."""
        self._sensors.set_faults(faults)

    def truth(self) -> Truth:
        """Return what was flown so far, a row each tick."""
        return Truth(self._rows)

    def leave_recording(self, path: Path) -> list[Path]:
        """Write the loop's recording, as the daemon writes one."""
        files = self.machine.record_to(
            path.parent, aircraft=self.name, ending="a requirement was not met"
        )
        return [files[0].rename(path), *files[1:]]

    def close(self) -> None:
        """Do nothing: there is nothing that runs by itself."""

    def _fly_a_tick(self) -> None:
        plant = self.plant
        plant.step(self._steps)
        state = plant.state()
        sensed = self._noise.apply(state) if self._noise else state
        said, channels = self._sensors.read(plant.time_s, sensed)
        if said is None:
            surfaces = self.machine.step(None)
        else:
            stand = plant.controls
            surfaces = self.machine.step(
                measurements(said),
                missing=_sensors_of(channels) if channels else (),
                standing=(stand.throttle, stand.elevator, stand.aileron, stand.rudder),
                switch=self._switch,
            )
        if surfaces is None:
            # The pilot has the controls, and holds the trimmed ones.
            plant.write(plant.trim)
        else:
            plant.write(
                Controls(
                    elevator=surfaces.elevator,
                    aileron=surfaces.aileron,
                    rudder=surfaces.rudder,
                    throttle=surfaces.throttle,
                )
            )
        for event in self.machine.events():
            self.happenings.append(Happening(plant.time_s, event.text))
        self._rows.append(row(state, plant.controls))


def _sensors_of(channels: frozenset[str]) -> list[str]:
    """Return the sensors that lack a channel: what is not whole is not told."""
    return [name for name, parts in SENSORS.items() if not channels.isdisjoint(parts)]
