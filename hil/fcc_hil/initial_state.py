"""The state of flight in which the autopilot engages.

A separate autopilot, which knows the true state, flies before; the one under test observes its
sensors meanwhile, as the daemon does in standby.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from enum import Enum

import fcc

from .plant import Plant
from .state import Controls, State
from .truth import STEPS_PER_ROW, TRUTH_HZ
from .units import FT_TO_M, KT_TO_MPS

SETTLING_S = 5.0
"""Sensors are observed for this time before engaging, as by the daemon in standby."""

_TURN_RAD = 3.0
_CLIMB_FT = 2_000.0
_ENGINE_OFF_S = 3.0
_BOTH_MAGNETOS = 3


class InitialState(Enum):
    """The state of the aircraft when the autopilot engages."""

    TRIMMED = "trimmed"
    """Straight and level, as trimmed."""
    IN_A_TURN = "in a turn"
    """At the bank limit, with the turn unfinished."""
    IN_A_CLIMB = "in a climb"
    ABOVE_TRIM = "above trim"
    """12 % above the trimmed speed, elevator fixed."""
    BELOW_TRIM = "below trim"
    """The same, below the trimmed speed."""
    AT_IDLE = "at idle"
    """The throttle was closed 4 s earlier."""
    AT_FULL_THROTTLE = "at full throttle"
    """The throttle was opened 4 s earlier."""
    ENGINE_RESTARTED = "engine restarted"
    """The magnetos were off for 3 s; the starter has just been released."""


@dataclass(frozen=True)
class _Way:
    """How to fly to that state."""

    seconds: float
    turn_rad: float = 0.0
    climb_ft: float = 0.0
    airspeed_ratio: float = 1.0
    throttle: float | None = None
    """Fixed at this value in the last 4 s."""
    restart: bool = False


_WAYS = {
    InitialState.IN_A_TURN: _Way(6.0, turn_rad=_TURN_RAD),
    InitialState.IN_A_CLIMB: _Way(6.0, climb_ft=_CLIMB_FT),
    InitialState.ABOVE_TRIM: _Way(20.0, airspeed_ratio=1.12),
    InitialState.BELOW_TRIM: _Way(20.0, airspeed_ratio=0.88),
    InitialState.AT_IDLE: _Way(6.0, throttle=0.0),
    InitialState.AT_FULL_THROTTLE: _Way(6.0, throttle=1.0),
    InitialState.ENGINE_RESTARTED: _Way(8.0, restart=True),
}
_THROTTLE_HELD_S = 4.0

Watch = Callable[[State], object]
"""Called with every state."""


def begin(
    plant: Plant,
    how: InitialState,
    config: str,
    see: Callable[[State], fcc.Measurements],
    watch: Watch,
) -> Controls:
    """Fly the plant to a state; return the positions of the controls then.

    `see` makes the first autopilot's measurements of a state; `watch` is called with each state.
    """
    if how is InitialState.TRIMMED:
        for _ in range(round(SETTLING_S * TRUTH_HZ)):
            watch(plant.state())
            plant.step(STEPS_PER_ROW)
        return plant.controls
    return _fly(plant, _WAYS[how], config, see, watch)


def _fly(
    plant: Plant, way: _Way, config: str, see: Callable[[State], fcc.Measurements], watch: Watch
) -> Controls:
    pilot = fcc.Autopilot(config)
    for _ in range(round(SETTLING_S * TRUTH_HZ)):
        state = plant.state()
        pilot.observe(see(state))
        watch(state)
        plant.step(STEPS_PER_ROW)
    start = plant.state()
    pilot.engage(see(start), throttle=plant.controls.throttle)
    # Any command ends the pattern.
    pilot.command(
        heading_rad=start.heading_rad + way.turn_rad,
        altitude_m=start.altitude_m + way.climb_ft * FT_TO_M,
        airspeed_mps=plant.aircraft.airspeed_kt * way.airspeed_ratio * KT_TO_MPS,
    )
    ticks = round(way.seconds * TRUTH_HZ)
    for tick in range(ticks):
        state = plant.state()
        watch(state)
        surfaces = pilot.step(see(state))
        controls = Controls(
            elevator=surfaces.elevator,
            aileron=surfaces.aileron,
            rudder=surfaces.rudder,
            throttle=surfaces.throttle,
        )
        left_s = (ticks - 1 - tick) / TRUTH_HZ
        if way.throttle is not None and left_s < _THROTTLE_HELD_S:
            controls = replace(controls, throttle=way.throttle)
        plant.write(controls)
        if way.restart:
            _restart(plant, left_s)
        plant.step(STEPS_PER_ROW)
    return plant.controls


def _restart(plant: Plant, left_s: float) -> None:
    """Switch the magnetos off, then restart the engine with the starter until the time is up."""
    off = _ENGINE_OFF_S < left_s <= 2.0 * _ENGINE_OFF_S
    plant.fdm["propulsion/magneto_cmd"] = 0 if off else _BOTH_MAGNETOS
    plant.fdm["propulsion/starter_cmd"] = 1 if 0.0 < left_s <= _ENGINE_OFF_S else 0
