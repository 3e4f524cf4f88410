"""The simulated side of the stand-in: aircraft, time, weather, cockpit.

And what a person or the simulator itself does with them. It has no sockets, and a frame is flown
when it is told so.
"""

from __future__ import annotations

import math
import time
from bisect import bisect_left
from dataclasses import dataclass, replace

from .cockpit import (
    ELEVATOR_TRIM,
    FAILED,
    GENERATOR_FAILURE,
    OVERRIDE_JOYSTICK,
    OVERRIDE_THROTTLES,
    SIM_SPEED,
    YOKE_ROLL,
    Cockpit,
)
from .datarefs import getter
from .frames import FrameClock, VaryingRate
from .local_axes import LocalAxes, MeasuredAttitude
from .plant import STEPS_PER_SECOND, Plant
from .protocol import Dialect
from .readout import SLOWEST_TRUE_PERIOD_S, Readout
from .settings import Mode, Settings, Start
from .simulator_autopilot import SimulatorAutopilot
from .state import Controls, State
from .terrain_tiles import Tiles
from .truth import STEPS_PER_ROW, Row, row
from .units import INHG_TO_PA

_QNH_INHG_PER_S = 0.01
"""How fast the pressure at sea level follows a change: about 9 ft/s."""
_SMOOTHING_S = 0.5
"""Of `sim/time/framerate_period`."""
_REMEMBERED_S = 60.0
"""How much flight is kept for a replay, at least if flown."""
_ROUNDING_S = 1e-6
_WRITER_RATIO = 0.3
_WRITER_PERIOD_S = 2.0
_RUNWAY_ELEVATION_FT = 440.0
_RELOCATED_DEG = (0.4, 0.7)
"""Latitude and longitude of another place less those of the present one."""


@dataclass(frozen=True)
class Progress:
    """The progress of the flight."""

    now: Row
    """The truth, in the columns of `truth.COLUMNS`."""
    mode: Mode
    subscriptions: int
    """Number of values subscribed to, by all clients."""
    overridden: bool
    """Whether a client overrides the joystick or the throttles."""

    @property
    def time_s(self) -> float:
        """Return the simulated time."""
        return self.now[0]


class World:
    """The aircraft in its simulator."""

    def __init__(self, settings: Settings) -> None:
        """Set the aircraft up in flight."""
        self.settings = settings
        self.dialect = Dialect(settings.version)
        self.mode = Mode.RUNNING
        self.link_is_cut = False
        """Whether the network carries nothing, in either direction, while the aircraft flies."""
        rate_hz, rates_hz = settings.frame_rate_hz, settings.frame_rates_hz
        varying = rates_hz and VaryingRate(rate_hz, *rates_hz, settings.seed + 2)
        self.clock = FrameClock(rate_hz, varying)
        self._running_time_s = 0.0
        self._began_s = time.monotonic()
        self._hung_s = 0.0
        self.period_s = self._frame_period_s = self._smoothed_period_s = 1.0 / rate_hz
        self._mode_ends: tuple[Mode, float] | None = None
        self._freeze_ends_s = 0.0
        self._cut_ends_s = math.inf
        self._writer_ends_s = 0.0
        self._qnh_inhg = self._qnh_aim_inhg = settings.qnh_inhg
        self.axes = LocalAxes()
        """The local axes, of OpenGL."""
        self._tiles = None if settings.terrain is None else Tiles(settings.terrain)
        self.restart_flight()

    # What a person or the simulator does.

    def enter(self, mode: Mode, seconds: float = math.inf) -> None:
        """Enter a state, for so many seconds. A freeze ends."""
        self.mode = mode
        self._freeze_ends_s = 0.0
        self._mode_ends = (mode, self._running_time_s + seconds)
        if mode is Mode.REPLAY:
            self._replay_from_s = self._history[0].time_s if self._history else 0.0
            self._replayed_s = 0.0

    def freeze(self, seconds: float) -> None:
        """Hang for so many seconds, in whatever state it is."""
        self._freeze_ends_s = self._running_time_s + seconds

    def is_frozen(self) -> bool:
        """Return whether it hangs."""
        return self.mode is Mode.FROZEN or self._running_time_s < self._freeze_ends_s - _ROUNDING_S

    def cut_link(self, seconds: float = math.inf) -> None:
        """Let the network lose everything for so many seconds; 0 mends it."""
        self.link_is_cut = seconds > 0.0
        self._cut_ends_s = self._running_time_s + seconds

    def write_as_plugin(self, seconds: float = math.inf) -> None:
        """Let another plugin write the joystick's roll in every frame for so many seconds."""
        self._writer_ends_s = self._running_time_s + seconds

    def write(self, path: str, value: float) -> float:
        """Set a dataref as a client does; return the simulated time."""
        self.cockpit.write(self.plant.time_s, path, value)
        return self.plant.time_s

    def set_qnh(self, inhg: float) -> None:
        """Let the pressure at sea level change to a value."""
        self._qnh_aim_inhg = inhg

    def shift_origin(self) -> None:
        """Move the origin of the local axes to the other side of the aircraft.

        By at least 1 degree of longitude, as at the edge of a scenery tile.
        """
        self._origin_moved = True
        state = self.plant.state()
        to_origin_rad = math.remainder(self.axes.longitude_rad - state.longitude_rad, math.tau)
        moved_rad = math.copysign(max(abs(2.0 * to_origin_rad), math.radians(1.0)), -to_origin_rad)
        self.axes = LocalAxes(self.axes.latitude_rad, self.axes.longitude_rad + moved_rad)

    def restart_flight(self) -> None:
        """Put the aircraft back to its start: the clock jumps back, everything is off."""
        settings = self.settings
        self._set_up(settings.start, settings.heading_deg)
        self.cockpit = Cockpit(
            replace(self.plant.trim, elevator_trim=self.plant.controls.elevator_trim),
            self.plant.engines,
            settings.version,
            self._qnh_inhg,
        )
        self.truth: list[Row] = [row(self.plant.state(), self.cockpit.controls())]

    def reload(self, *, on_runway: bool, elsewhere: bool, clears_overrides: bool = True) -> None:
        """Load the aircraft again: the clock jumps back.

        The pilot holds what trims it, or idle on a runway. Switches stay as they are, so that a
        client has to notice by itself.
        """
        state = self.plant.state()
        moved_deg = _RELOCATED_DEG if elsewhere else (0.0, 0.0)
        heading_deg = math.degrees(state.heading_rad) + (90.0 if elsewhere else 0.0)
        start = Start(
            math.degrees(state.latitude_rad) + moved_deg[0],
            math.degrees(state.longitude_rad) + moved_deg[1],
            _RUNWAY_ELEVATION_FT if on_runway else None,
        )
        if self._tiles is not None and on_runway:
            place_deg = start.latitude_deg, start.longitude_deg
            runway_ft = self._tiles.runway_ft(*place_deg, _RUNWAY_ELEVATION_FT)
            start = replace(start, runway_elevation_ft=runway_ft)
        self._set_up(start, heading_deg % 360.0)
        if clears_overrides:
            self.cockpit.clear_overrides()
        self.cockpit.set(SIM_SPEED, 1.0)
        self.cockpit.hold(self.plant.trim)
        self.cockpit.set(ELEVATOR_TRIM, self.plant.controls.elevator_trim or 0.0)
        self.truth = [row(self.plant.state(), self.cockpit.controls())]

    def jump(self, seconds: float) -> None:
        """Move the simulator's clock without flying."""
        self._time_offset_s += seconds

    # What a client or a test sees.

    def read(self, path: str) -> float | None:
        """Return a dataref as a client would read it now, without sensor noise; None if unknown."""
        read = getter(path, self.cockpit, self.dialect)
        return None if read is None else read(self.readout(self.shown()))

    def shown(self) -> State:
        """Return the aircraft's state, or in a replay one of the past."""
        if self.mode is not Mode.REPLAY or not self._history:
            return self.plant.state()
        return self._replayed()

    def readout(self, state: State) -> Readout:
        """Return what datarefs are computed from, with a state as it is measured."""
        in_replay = self.mode is Mode.REPLAY and bool(self._history)
        shows_past = in_replay and self.settings.replays_clock
        time_s = self._replayed().time_s if shows_past else self.plant.time_s
        return Readout(
            state=state,
            cockpit=self.cockpit,
            dialect=self.dialect,
            flight_time_s=time_s + self._time_offset_s,
            paused=self._is_paused(),
            frame_period_s=self._frame_period_s,
            smoothed_period_s=self._smoothed_period_s,
            axes=self.axes,
            magnetic_variation_deg=self.settings.magnetic_variation_deg,
            running_time_s=self._running_time_s,
            network_time_s=time.monotonic() - self._began_s,
            in_replay=in_replay,
            speed=0.0 if self._is_paused() else self._speed(),
            qnh_pa=self._qnh_inhg * INHG_TO_PA,
            axial_sign=self.settings.axial_sign,
            surfaces=self.surfaces,
            aircraft=self.settings.aircraft,
        )

    def measured_readout(self, true: State, measured: State) -> Readout:
        """Return what is sent when sensors measure this instead of the true state."""
        turn = self.axes.turn(true.latitude_rad, true.longitude_rad)
        angles = [(s.pitch_rad, s.roll_rad, s.heading_rad) for s in (true, measured)]
        attitude_rad = self._attitude.measure(self.axes, turn, *angles)
        return replace(self.readout(measured), attitude_rad=attitude_rad)

    def overridden(self) -> bool:
        """Return whether a client overrides the joystick or the throttles."""
        return self.cockpit.is_on(OVERRIDE_JOYSTICK) or self.cockpit.is_on(OVERRIDE_THROTTLES)

    # Time.

    def pass_time(self) -> bool:
        """Let a frame's time pass; return whether the simulator runs, and does not hang."""
        self.period_s = period_s = self.clock.begin()
        self._running_time_s += period_s
        self._end_states()
        if self.is_frozen():
            self._hung_s += period_s
            return False
        self._frame_period_s = period_s + self._hung_s
        self._hung_s = 0.0
        share = 1.0 - math.exp(-self._frame_period_s / _SMOOTHING_S)
        self._smoothed_period_s += share * (self._frame_period_s - self._smoothed_period_s)
        return True

    def fly(self) -> None:
        """Fly through a frame; after a hang the aircraft moves by one, as after any slow one."""
        if self._running_time_s < self._writer_ends_s:
            angle = math.tau * self._running_time_s / _WRITER_PERIOD_S
            self.write(YOKE_ROLL, _WRITER_RATIO * math.sin(angle))
        if self.mode is Mode.REPLAY:
            self._replayed_s += self.period_s
        elif self.mode is Mode.RUNNING:
            self._fly(min(self._frame_period_s, SLOWEST_TRUE_PERIOD_S) * self._speed())

    def _fly(self, seconds: float) -> None:
        self._follow_qnh(seconds)
        state = self.plant.state()
        self._autopilot.step(state, self.cockpit)
        failure = self.cockpit.read(GENERATOR_FAILURE)
        self.plant.battery.alternator_fails = failure == FAILED
        self._move_surfaces(self.settings.surface_rate * seconds)
        self.plant.write(self.surfaces, self.cockpit.throttles())
        self._owed_steps += seconds * STEPS_PER_SECOND
        steps = math.floor(self._owed_steps + 1e-9)
        self._owed_steps -= steps
        for _ in range(steps):
            self.plant.step()
            if self.plant.steps % STEPS_PER_ROW == 0:
                self.truth.append(row(self.plant.state(), self.plant.controls))
        if not self._origin_moved and self.plant.time_s >= self.settings.origin_moves_after_s:
            self.shift_origin()
        self._remember(self.plant.state())

    def _set_up(self, at: Start, heading_deg: float) -> None:
        settings = self.settings
        self.plant = plant = Plant(
            settings.aircraft,
            seed=settings.seed,
            heading_deg=heading_deg,
            weather=settings.weather,
            latitude_deg=at.latitude_deg,
            longitude_deg=at.longitude_deg,
            qnh_pa=self._qnh_inhg * INHG_TO_PA,
            runway_elevation_ft=at.runway_elevation_ft,
        )
        if self._tiles is not None:
            plant.fly_over(self._tiles)
        self.enter(Mode.RUNNING)
        self.surfaces = Controls(throttle=plant.trim.throttle)
        start = plant.state()
        offset = self.settings.origin_offset_deg
        self.axes = LocalAxes(
            start.latitude_rad + math.radians(offset[0]),
            start.longitude_rad + math.radians(offset[1]),
        )
        self._origin_moved = False
        self._attitude = MeasuredAttitude()
        self._autopilot = SimulatorAutopilot()
        self._time_offset_s = 0.0
        self._owed_steps = 0.0
        self._history: list[State] = []
        self._replay_from_s = self._replayed_s = 0.0

    def _is_paused(self) -> bool:
        return self.mode is Mode.PAUSED or self._speed() <= 0.0

    def _speed(self) -> float:
        return max(0.0, self.cockpit.read(SIM_SPEED) or 0.0)

    def _end_states(self) -> None:
        if self._mode_ends is not None and self._running_time_s >= self._mode_ends[1] - _ROUNDING_S:
            # A test may have entered another state since.
            if self.mode is self._mode_ends[0]:
                self.mode = Mode.RUNNING
            self._mode_ends = None
        if self._running_time_s >= self._cut_ends_s - _ROUNDING_S:
            self.link_is_cut = False

    def _follow_qnh(self, seconds: float) -> None:
        left_inhg = self._qnh_aim_inhg - self._qnh_inhg
        if left_inhg != 0.0:
            most_inhg = _QNH_INHG_PER_S * seconds
            self._qnh_inhg += min(most_inhg, max(-most_inhg, left_inhg))
            self.plant.set_qnh(self._qnh_inhg * INHG_TO_PA)

    def _move_surfaces(self, most: float) -> None:
        """Move the surfaces towards the controls, by `most` of a full deflection."""
        now, to = self.surfaces, self.cockpit.controls()
        self.surfaces = replace(
            to,
            elevator=now.elevator + min(most, max(-most, to.elevator - now.elevator)),
            aileron=now.aileron + min(most, max(-most, to.aileron - now.aileron)),
            rudder=now.rudder + min(most, max(-most, to.rudder - now.rudder)),
        )

    def _remember(self, state: State) -> None:
        self._history.append(state)
        if state.time_s - self._history[0].time_s > 2.0 * _REMEMBERED_S:
            first = self._remembered(state.time_s - _REMEMBERED_S)
            self._history = self._history[first:]

    def _remembered(self, time_s: float) -> int:
        """Return the index of the first remembered frame from a time on."""
        return bisect_left(self._history, time_s, key=lambda state: state.time_s)

    def _replayed(self) -> State:
        """Return the remembered frame that a replay shows now; it begins anew at its end."""
        length_s = max(self._history[-1].time_s - self._replay_from_s, SLOWEST_TRUE_PERIOD_S)
        index = self._remembered(self._replay_from_s + self._replayed_s % length_s)
        return self._history[min(index, len(self._history) - 1)]
