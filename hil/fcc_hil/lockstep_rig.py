"""JSBSim and the daemon's own loop in lockstep: no clock, no network, deterministic."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

import fcc

from .lockstep import measurements
from .noise import SensorNoise
from .plant import STEPS_PER_SECOND, Plant
from .quantities import SENSORS
from .rig import Event, FlightError
from .sensor_faults import FaultySensors, SensorFault
from .standin import Settings
from .state import Controls
from .truth import Row, Truth, row

_STANDBY_S = 2.0
"""Navigation settles for 1 s before the autopilot may engage."""


class LockstepRig:
    """An aircraft of JSBSim and a loop that is stepped by the test."""

    failsafe_shows_after_s = 0.0
    not_centred = ""
    """Centring is done by the actuator; there is none here."""

    def __init__(self, settings: Settings, plant: Plant, machine: fcc.Machine) -> None:
        """Combine them. Raise FlightError if their rates do not fit."""
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
        self.events: list[Event] = []
        self._steps = round(steps)
        self._noise = SensorNoise(settings.seed) if settings.noise else None
        self._sensors = FaultySensors()
        self._switch = False
        self._rows: list[Row] = [row(plant.state(), plant.controls)]

    @property
    def time_s(self) -> float:
        """Return the time of the flight."""
        return self.plant.time_s

    @property
    def holds_control(self) -> bool:
        """Return whether the loop has control."""
        return self.machine.holds_control

    def prepare(self) -> None:
        """Let navigation settle while the trimmed aircraft flies."""
        self.fly_to(self.time_s + _STANDBY_S)

    def set_switch(self, *, on: bool) -> None:
        """Move the engage switch; the loop reads it in the next tick."""
        self._switch = on

    def fly_to(self, time_s: float, until: Callable[[], bool] | None = None) -> None:
        """Fly to a time, or until a condition is met."""
        while self.plant.time_s < time_s - 1e-6:
            self._fly_a_tick()
            if until is not None and until():
                return

    def set_faults(self, faults: Sequence[SensorFault]) -> None:
        """Replace the faults of the sensors."""
        self._sensors.set_faults(faults)

    def truth(self) -> Truth:
        """Return the truth so far, a row per tick."""
        return Truth(self._rows)

    def save_recording(self, path: Path) -> list[Path]:
        """Write the loop's recording in the daemon's format."""
        files = self.machine.record_to(
            path.parent, aircraft=self.name, ending="a requirement was not met"
        )
        return [files[0].rename(path), *files[1:]]

    def close(self) -> None:
        """Do nothing: nothing runs in the background."""

    def _fly_a_tick(self) -> None:
        plant = self.plant
        plant.step(self._steps)
        state = plant.state()
        sensed = self._noise.apply(state) if self._noise else state
        measured, channels = self._sensors.read(plant.time_s, sensed)
        if measured is None:
            surfaces = self.machine.step(None)
        else:
            stand = plant.controls
            surfaces = self.machine.step(
                measurements(measured),
                missing=_sensors_of(channels) if channels else (),
                readback=(stand.throttle, stand.elevator, stand.aileron, stand.rudder),
                switch=self._switch,
            )
        if surfaces is None:
            # The pilot has control, and holds the trimmed controls.
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
            self.events.append(Event(plant.time_s, event.text))
        self._rows.append(row(state, plant.controls))


def _sensors_of(channels: frozenset[str]) -> list[str]:
    """Return the sensors with a missing channel: an incomplete reading is not passed on."""
    return [name for name, parts in SENSORS.items() if not channels.isdisjoint(parts)]
