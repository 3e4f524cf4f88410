"""What a person at the simulator, or the simulator itself, does during a flight.

An action is written as `NAME` or `NAME:ARGUMENT`: `pause`, `freeze:1.5`, `knob:30.22`. The command
line takes a time before it (`--at 30:freeze:1.5`), a test calls `StandInProcess.act`.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

from .cockpit import (
    ALTIMETER_SETTING,
    ARTIFICIAL_STABILITY_ON,
    AUTOTHROTTLE_ENABLED,
    AUTOTHROTTLE_ON,
    PITOT_ICE,
    SERVOS_ON,
    SIM_SPEED,
    YAW_DAMPER_ON,
)
from .settings import Mode
from .world import World


@dataclass(frozen=True)
class Argument:
    """What may stand after an action's name."""

    name: str
    least: float
    most: float
    otherwise: float | None = None
    """What holds without it; None if it must be given."""

    def read(self, action: str, text: str) -> float:
        """Return its value, or raise ValueError."""
        if not text and self.otherwise is not None:
            return self.otherwise
        try:
            value = float(text)
        except ValueError:
            value = math.nan
        if not self.least <= value <= self.most:
            raise ValueError(
                f"'{action}:{text}': give {action}:{self.name} with {self.least:g} to {self.most:g}"
            )
        return value

    def __str__(self) -> str:
        """Return it as it is written after a name."""
        if not self.name:
            return ""
        return f":{self.name}" if self.otherwise is None else f"[:{self.name}]"


_FOREVER = Argument("SECONDS", 0.0, 86_400.0, math.inf)
_SECONDS = Argument("SECONDS", 0.0, 86_400.0)
_INHG = Argument("INHG", 20.0, 32.0)
_RATIO = Argument("RATIO", 0.0, 1.0)
_SWITCH = Argument("0|1", 0.0, 1.0, 1.0)
_NONE = Argument("", math.nan, math.nan, 0.0)


@dataclass(frozen=True)
class Action:
    """An action by its name."""

    does: str
    """For the command line's help."""
    run: Callable[[World, float], object]
    argument: Argument = _NONE


def _set_reverse(world: World, on: float) -> None:
    world.cockpit.set_reverse(on=round(on) == 1)


def _set_autothrottle(world: World, on: float) -> None:
    world.cockpit.set(AUTOTHROTTLE_ENABLED, on)
    world.cockpit.set(AUTOTHROTTLE_ON, on)


def _move_lever(world: World, ratio: float) -> None:
    world.cockpit.hold(replace(world.cockpit.pilot, throttle=ratio))


def _stop_time(world: World, seconds: float) -> None:
    world.enter(Mode.STALLED, seconds)


def _setter(path: str) -> Callable[[World, float], object]:
    return lambda world, value: world.cockpit.set(path, value)


ACTIONS: dict[str, Action] = {
    "run": Action(
        "end a pause, a window, a replay or a freeze", lambda w, _: w.enter(Mode.RUNNING)
    ),
    "pause": Action("pause", lambda w, t: w.enter(Mode.PAUSED, t), _FOREVER),
    "map": Action("open the map: time stops, `paused` stays 0", _stop_time, _FOREVER),
    "menu": Action("open the menu: likewise", _stop_time, _FOREVER),
    "alert": Action("show an alert: likewise", _stop_time, _FOREVER),
    "replay": Action("replay the past minute", lambda w, t: w.enter(Mode.REPLAY, t), _FOREVER),
    "freeze": Action(
        "hang: nothing is read or sent, the aircraft stands still",
        lambda w, t: w.freeze(t),
        _FOREVER,
    ),
    "cut": Action("cut the network; the aircraft flies on", lambda w, t: w.cut_link(t), _FOREVER),
    "restart": Action("put the flight back to its start", lambda w, _: w.restart_flight()),
    "reload": Action(
        "load the aircraft again onto a runway elsewhere, overrides cleared",
        lambda w, _: w.reload(on_runway=True, elsewhere=True),
    ),
    "reload-air": Action(
        "load it again where it flies, overrides cleared",
        lambda w, _: w.reload(on_runway=False, elsewhere=False),
    ),
    "relocate": Action(
        "put it elsewhere in the air; overrides stay",
        lambda w, _: w.reload(on_runway=False, elsewhere=True, clears_overrides=False),
    ),
    "jump": Action("move the clock without flying", lambda w, t: w.jump(t), _SECONDS),
    "origin": Action("move the origin of the local axes", lambda w, _: w.shift_origin()),
    "knob": Action("set the pilot's altimeter", _setter(ALTIMETER_SETTING), _INHG),
    "qnh": Action(
        "change the pressure at sea level, by 0.01 inHg a second",
        lambda w, inhg: w.set_qnh(inhg),
        _INHG,
    ),
    "ice": Action("ice up the pitot tube", _setter(PITOT_ICE), _RATIO),
    "servos": Action("switch X-Plane's autopilot on or off", _setter(SERVOS_ON), _SWITCH),
    "autothrottle": Action("switch its autothrottle", _set_autothrottle, _SWITCH),
    "artstab": Action("switch its artificial stability", _setter(ARTIFICIAL_STABILITY_ON), _SWITCH),
    "damper": Action("switch its yaw damper", _setter(YAW_DAMPER_ON), _SWITCH),
    "writer": Action(
        "let another plugin write the joystick", lambda w, t: w.write_as_plugin(t), _FOREVER
    ),
    "speed": Action(
        "run so many times as fast as real time",
        _setter(SIM_SPEED),
        Argument("RATIO", 0.0, 16.0),
    ),
    "fps": Action(
        "make so many frames a second, all of one length",
        lambda w, rate: w.clock.set_rate(rate),
        Argument("HZ", 1.0, 1_000.0),
    ),
    "reverse": Action("select reverse thrust or forward", _set_reverse, _SWITCH),
    "lever": Action("move the throttle levers", _move_lever, _RATIO),
}


def parse(text: str) -> tuple[Action, float]:
    """Return an action and its argument; raise ValueError with what can be given."""
    name, colon, rest = text.partition(":")
    action = ACTIONS.get(name)
    if action is None:
        raise ValueError(f"'{name}' is no action: give one of {', '.join(ACTIONS)}")
    if action.argument is _NONE and colon:
        raise ValueError(f"'{text}': {name} takes nothing after it")
    return action, action.argument.read(name, rest)


def act(world: World, text: str) -> None:
    """Do what an action says; raise ValueError for one that is none."""
    action, argument = parse(text)
    action.run(world, argument)
