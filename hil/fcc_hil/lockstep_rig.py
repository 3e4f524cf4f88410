"""JSBSim and the daemon's own loop in lockstep: no clock, no network, deterministic."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import fcc

from .actuation import Actuation, Servos
from .faulty_sensors import FaultySensors, SensorFault
from .lockstep import as_controls, as_surfaces, measurements
from .noise import NoiseLevels, SensorNoise
from .plant import STEPS_PER_SECOND, Plant
from .quantities import READINGS
from .raw_calibration import Calibration
from .raw_sensors import RawSensors
from .receiver import Receiver, ReceiverReadings
from .rig import Event, FlightError
from .standin import Settings
from .state import Controls, State
from .truth import Row, Truth, row
from .units import wrap_heading_rad

_STANDBY_S = 2.0
"""Navigation settles for 1 s before the autopilot may engage."""
_ENGAGES_WITHIN_S = 1.0


_AT_ONCE = Actuation()


@dataclass(frozen=True)
class Conditions:
    """What lies between the aircraft and the autopilot, beyond the settings of the stand-in."""

    levels: NoiseLevels | None = None
    """The noise, if the settings ask for noise; None for the usual levels."""
    sensor_delay_ticks: int = 0
    """The age of the measurements."""
    actuation: Actuation = _AT_ONCE
    receiver: Receiver | None = None
    """None if the velocity over the ground is not measured."""
    gust: Callable[[Plant], None] | None = None
    """Called before each tick, to move the air."""
    raw_sensors: str | None = None
    """The raw sensors that are recorded beside the others: phone or board."""
    calibration: Calibration | None = None
    """That of the raw sensors."""
    raw_fault: Callable[[fcc.Measurements, float], None] | None = None
    """Called in each tick with the raw readings, and the time in s, to falsify them."""
    without: frozenset[str] = frozenset()
    """Readings that there are not, by their names."""
    position: bool = False
    """Whether position and velocity over the ground are measured, without errors."""
    biases: Mapping[str, float] | None = None
    """Constant errors of the sensors, by the fields of `state.State`."""
    trim: bool = True
    """Whether it is measured where the elevator trim stands."""


class LockstepRig:
    """An aircraft of JSBSim and a loop that is stepped by the test."""

    failsafe_shows_after_s = 0.0
    not_centred = ""
    """Centring is done by the actuator; there is none here."""

    def __init__(
        self,
        settings: Settings,
        plant: Plant,
        machine: fcc.Machine,
        conditions: Conditions | None = None,
    ) -> None:
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
        self._conditions = conditions = conditions or Conditions()
        self._noise = SensorNoise(settings.seed, conditions.levels) if settings.noise else None
        self._late: deque[State] = deque(maxlen=conditions.sensor_delay_ticks + 1)
        self._sensors = FaultySensors()
        receiver = conditions.receiver
        self._receiver = None if receiver is None else ReceiverReadings(receiver, settings.seed)
        self._command = plant.controls
        self._servos = (
            None
            if conditions.actuation == _AT_ONCE
            else Servos(conditions.actuation, plant.controls)
        )
        self.raw = (
            RawSensors(plant, conditions.raw_sensors, seed=settings.seed)
            if conditions.raw_sensors
            else None
        )
        self.measured: State | None = None
        """What the sensors showed last; None if nothing came."""
        self.stick: tuple[float, float, float] | None = None
        """Where the pilot holds pitch, roll and yaw, -1 to 1; None if that is not measured."""
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

    def engage(self, *, after_s: float, until: Callable[[], bool] | None = None) -> None:
        """Fly for so long in standby, then engage within a second. Raise FlightError otherwise."""
        self.fly_to(self.time_s + after_s, until)
        self.set_switch(on=True)
        self.fly_to(self.time_s + _ENGAGES_WITHIN_S, until)
        if not self.holds_control:
            raise FlightError(f"not engaged: {', '.join(self.machine.engage_inhibits)}")

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
        """Replace the faults of the sensors. Raise ValueError for one that is not measured."""
        conditions, failed = self._conditions, {fault.sensor for fault in faults}
        measured = {
            "position": conditions.position or conditions.raw_sensors,
            "velocity": conditions.position or conditions.raw_sensors or conditions.receiver,
        }
        for sensor in sorted(
            failed & {name for name, is_measured in measured.items() if not is_measured}
        ):
            raise ValueError(
                f"this flight measures no {sensor}, which cannot fail: fly a plan, "
                '@pytest.mark.autopilot(mode="plan", plan=FILE)'
            )
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
        plant, conditions = self.plant, self._conditions
        if conditions.gust:
            conditions.gust(plant)
        self._move()
        state = plant.state()
        shown = self._noise.apply(state) if self._noise else state
        self._late.append(_biased(shown, conditions.biases) if conditions.biases else shown)
        measured, channels = self._sensors.read(plant.time_s, self._late[0])
        self.measured = measured
        velocity = None if self._receiver is None else self._receiver.read(state)
        if measured is None:
            surfaces = self.machine.step(None)
        else:
            values = measurements(measured)
            ages_s = {} if self.raw is None else self.raw.read(values)
            if conditions.raw_fault is not None:
                conditions.raw_fault(values, plant.time_s)
            if conditions.calibration is not None:
                conditions.calibration.apply(values)
            if conditions.position:
                values.latitude_rad = measured.latitude_rad
                values.longitude_rad = measured.longitude_rad
                values.position_altitude_m = measured.elevation_m
                velocity = (measured.north_mps, measured.east_mps, measured.down_mps)
            if velocity is not None:
                values.north_mps, values.east_mps, values.down_mps = velocity
            if self.stick is not None:
                values.pilot_pitch, values.pilot_roll, values.pilot_yaw = self.stick
            surfaces = self.machine.step(
                values,
                missing=[*conditions.without, *_sensors_of(channels)],
                ages_s=ages_s,
                readback=as_surfaces(self._stand()),
                switch=self._switch,
            )
        if surfaces is None:
            # The pilot has control, and holds the trimmed controls.
            self._write(plant.trim)
        else:
            self._write(as_controls(surfaces))
        for event in self.machine.events():
            self.events.append(Event(plant.time_s, event.text))
        self._rows.append(row(state, plant.controls))

    def _stand(self) -> Controls:
        """Return where the controls stand, as it is measured."""
        stand = self.plant.controls
        return stand if self._conditions.trim else replace(stand, elevator_trim=None)

    def _write(self, controls: Controls) -> None:
        self._command = controls
        if self._servos is None:
            self.plant.write(controls)

    def _move(self) -> None:
        """Advance the aircraft by a tick."""
        if self._servos is None and self.raw is None:
            self.plant.step(self._steps)
            return
        for _ in range(self._steps):
            if self._servos is not None:
                self.plant.write(self._servos.step(self._command))
            self.plant.step()
            if self.raw is not None:
                self.raw.step()


def _biased(state: State, biases: Mapping[str, float]) -> State:
    changed = replace(state)
    for channel, by in biases.items():
        setattr(changed, channel, getattr(changed, channel) + by)
    changed.heading_rad = wrap_heading_rad(changed.heading_rad)
    return changed


def _sensors_of(channels: frozenset[str]) -> list[str]:
    """Return the sensors with a missing channel: an incomplete reading is not passed on."""
    return [name for name, parts in READINGS.items() if not channels.isdisjoint(parts)]
