"""The commands of X-Plane that do something here, as a client runs them by CMND.

The names are those of Commands.txt of 11.50, where they have no descriptions: what they do here is
what their names and public scripts say. `pause_on` and `pause_off` are in public scripts for 12.
"""

from __future__ import annotations

import re
from collections.abc import Callable

from .cockpit import (
    ALTIMETER_SETTING,
    ARTIFICIAL_STABILITY_ON,
    AUTOTHROTTLE_ENABLED,
    AUTOTHROTTLE_ON,
    GENERIC_LIGHTS,
    PROPELLER_MODE,
    SERVOS_ON,
    SIM_SPEED,
    YAW_DAMPER_ON,
)
from .settings import Mode
from .units import STANDARD_INHG
from .world import World

PAUSE_TOGGLE = "sim/operation/pause_toggle"

_CLICK_INHG = 0.01
_FASTEST = 4.0
_GENERIC_LIGHT = re.compile(r"sim/lights/generic_(\d\d)_light_(tog|on|off)")

_Command = Callable[[World], object]


def _toggle(mode: Mode) -> _Command:
    return lambda world: world.enter(Mode.RUNNING if world.mode is mode else mode)


def _leave(mode: Mode) -> _Command:
    return lambda world: world.enter(Mode.RUNNING) if world.mode is mode else None


def _set(value: float, *paths: str) -> _Command:
    def run(world: World) -> None:
        for path in paths:
            world.cockpit.set(path, value)

    return run


def _switch(*paths: str) -> _Command:
    return lambda world: _set(float(not world.cockpit.is_on(paths[0])), *paths)(world)


def _turn_knob(inhg: float) -> _Command:
    def run(world: World) -> None:
        now_inhg = world.cockpit.read(ALTIMETER_SETTING) or 0.0
        world.cockpit.set(ALTIMETER_SETTING, now_inhg + inhg)

    return run


def _change_speed(world: World) -> None:
    now = world.cockpit.read(SIM_SPEED) or 0.0
    world.cockpit.set(SIM_SPEED, 1.0 if now >= _FASTEST else max(1.0, 2.0 * now))


def _toggle_reverse(world: World) -> None:
    world.cockpit.set_reverse(on=world.cockpit.read(PROPELLER_MODE) == 1.0)


def _put_on_runway(world: World) -> None:
    world.reload(on_runway=True, elsewhere=True)


def _reload_aircraft(world: World) -> None:
    world.reload(on_runway=False, elsewhere=False)


_OPERATION = "sim/operation/"
_AUTOPILOT = "sim/autopilot/"
_INSTRUMENTS = "sim/instruments/"
_AUTOTHROTTLE = (AUTOTHROTTLE_ENABLED, AUTOTHROTTLE_ON)

_COMMANDS: dict[str, _Command] = {
    PAUSE_TOGGLE: _toggle(Mode.PAUSED),
    _OPERATION + "pause_on": lambda world: world.enter(Mode.PAUSED),
    _OPERATION + "pause_off": _leave(Mode.PAUSED),
    "sim/map/show_current": _toggle(Mode.STALLED),
    _OPERATION + "toggle_main_menu": _toggle(Mode.STALLED),
    _OPERATION + "toggle_settings_window": _toggle(Mode.STALLED),
    _OPERATION + "close_windows": _leave(Mode.STALLED),
    "sim/replay/replay_toggle": _toggle(Mode.REPLAY),
    "sim/replay/replay_off": _leave(Mode.REPLAY),
    _OPERATION + "reload_aircraft": _reload_aircraft,
    _OPERATION + "reload_aircraft_no_art": _reload_aircraft,
    _OPERATION + "reset_flight": World.restart_flight,
    _OPERATION + "go_to_default": _put_on_runway,
    _OPERATION + "reset_to_runway": _put_on_runway,
    _OPERATION + "go_next_runway": _put_on_runway,
    _OPERATION + "flightmodel_speed_change": _change_speed,
    _INSTRUMENTS + "barometer_up": _turn_knob(_CLICK_INHG),
    _INSTRUMENTS + "barometer_down": _turn_knob(-_CLICK_INHG),
    _INSTRUMENTS + "barometer_2992": _set(STANDARD_INHG, ALTIMETER_SETTING),
    _AUTOPILOT + "servos_on": _set(1.0, SERVOS_ON),
    _AUTOPILOT + "servos_toggle": _switch(SERVOS_ON),
    _AUTOPILOT + "servos_off_any": _set(0.0, SERVOS_ON),
    _AUTOPILOT + "servos_fdir_off": _set(0.0, SERVOS_ON),
    _AUTOPILOT + "autothrottle_on": _set(1.0, *_AUTOTHROTTLE),
    _AUTOPILOT + "autothrottle_off": _set(0.0, *_AUTOTHROTTLE),
    _AUTOPILOT + "autothrottle_toggle": _switch(*_AUTOTHROTTLE),
    "sim/systems/artificial_stability_toggle": _switch(ARTIFICIAL_STABILITY_ON),
    "sim/systems/yaw_damper_on": _set(1.0, YAW_DAMPER_ON),
    "sim/systems/yaw_damper_off": _set(0.0, YAW_DAMPER_ON),
    "sim/systems/yaw_damper_toggle": _switch(YAW_DAMPER_ON),
    "sim/engines/thrust_reverse_toggle": _toggle_reverse,
}


def run_command(world: World, path: str) -> bool:
    """Run a command; return whether there is one of that name here."""
    command = _COMMANDS.get(path) or _light_command(path)
    if command is None:
        return False
    command(world)
    return True


def _light_command(path: str) -> _Command | None:
    """Return the command of a generic light: they count from 01."""
    match = _GENERIC_LIGHT.fullmatch(path)
    if match is None or not 1 <= int(match[1]) <= 64:
        return None
    light = f"{GENERIC_LIGHTS}[{int(match[1]) - 1}]"
    return _switch(light) if match[2] == "tog" else _set(float(match[2] == "on"), light)
