"""Datarefs that a client can set in the simulator: overrides, joystick, throttles, switches.

As in X-Plane, the joystick datarefs belong to the pilot until `override_joystick` is 1: a value
written before is lost by the next frame. The pilot here holds the trimmed controls. DATA rows 8 and
25 set the same datarefs and obey the same overrides. Sources differ on whether row 8 alone
overrides X-Plane's joystick; a client that sets the override first is right in either case.

The flight controls are the sum of the yoke, the autopilot's servo and the artificial stability. The
throttle in use is the lever's until `override_throttles` is 1, and the lever's again after it.
Names, types, sizes and which of them can be written are those of Laminar's DataRefs.txt of 12.10.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

from .protocol import UNUSED
from .state import Controls
from .units import STANDARD_INHG

_JOYSTICK = "sim/joystick/"
_OVERRIDE = "sim/operation/override/"
_LEVERS = "sim/cockpit2/engine/actuators/"

OVERRIDE_JOYSTICK = _OVERRIDE + "override_joystick"
OVERRIDE_THROTTLES = _OVERRIDE + "override_throttles"
OVERRIDE_ARTSTAB = _OVERRIDE + "override_artstab"
OVERRIDE_AUTOPILOT = _OVERRIDE + "override_autopilot"
YOKE_PITCH = _JOYSTICK + "yoke_pitch_ratio"
YOKE_ROLL = _JOYSTICK + "yoke_roll_ratio"
YOKE_HEADING = _JOYSTICK + "yoke_heading_ratio"
ELEVATOR_TRIM = "sim/flightmodel/controls/elv_trim"
"""-1 full nose down .. 1 full nose up; needs no override."""
FLAPS = "sim/cockpit2/controls/flap_ratio"
"""0 up .. 1 full; needs no override."""
GEAR = "sim/cockpit2/controls/gear_handle_down"
"""The handle, an int: 0 up, 1 down; needs no override."""
OVERRIDE_BRAKES = _OVERRIDE + "override_toe_brakes"
LEFT_BRAKE = "sim/cockpit2/controls/left_brake_ratio"
RIGHT_BRAKE = "sim/cockpit2/controls/right_brake_ratio"
SERVO_PITCH = _JOYSTICK + "servo_pitch_ratio"
SERVO_ROLL = _JOYSTICK + "servo_roll_ratio"
SERVO_HEADING = _JOYSTICK + "servo_heading_ratio"
ARTSTAB_PITCH = _JOYSTICK + "artstab_pitch_ratio"
ARTSTAB_ROLL = _JOYSTICK + "artstab_roll_ratio"
ARTSTAB_HEADING = _JOYSTICK + "artstab_heading_ratio"
THROTTLE_USE = "sim/flightmodel/engine/ENGN_thro_use"
THROTTLE_LEVER = _LEVERS + "throttle_ratio"
PROPELLER_MODE = "sim/flightmodel/engine/ENGN_propmode"
"""0 feathered, 1 normal, 2 beta, 3 reverse."""
GENERIC_LIGHTS = "sim/cockpit2/switches/generic_lights_switch"
ENGAGE_SWITCH = f"{GENERIC_LIGHTS}[56]"
"""The daemon's default."""
SERVOS_ON = "sim/cockpit2/autopilot/servos_on"
"""X-Plane's own autopilot moves the controls; read-only."""
AUTOTHROTTLE_ENABLED = "sim/cockpit2/autopilot/autothrottle_enabled"
AUTOTHROTTLE_ON = "sim/cockpit2/autopilot/autothrottle_on"
"""Read-only."""
ARTIFICIAL_STABILITY_ON = "sim/cockpit2/switches/artificial_stability_on"
YAW_DAMPER_ON = "sim/cockpit2/switches/yaw_damper_on"
ALTIMETER_SETTING = "sim/cockpit2/gauges/actuators/barometer_setting_in_hg_pilot"
PITOT_ICE = "sim/flightmodel/failures/pitot_ice"
"""0 none .. 1 blocked."""
GENERATOR_FAILURE = "sim/operation/failures/rel_genera0"
"""Of the first engine's: 6 has failed."""
FAILED = 6.0
SIM_SPEED = "sim/time/sim_speed"
"""1 real time, 2 twice as fast; 0 stops."""

YOKE = (YOKE_PITCH, YOKE_ROLL, YOKE_HEADING)
_SERVO = (SERVO_PITCH, SERVO_ROLL, SERVO_HEADING)
_ARTSTAB = (ARTSTAB_PITCH, ARTSTAB_ROLL, ARTSTAB_HEADING)
_ENGINES = 16
_NORMAL, _REVERSE = 1.0, 3.0
_MORE_LIGHTS_SINCE = 111_000
_FULL = (-1.0, 1.0)

_RANGES = {
    **dict.fromkeys((*YOKE, *_SERVO, *_ARTSTAB, ELEVATOR_TRIM), _FULL),
    THROTTLE_USE: (-1.0, 1.2),
    **dict.fromkeys((THROTTLE_LEVER, FLAPS, LEFT_BRAKE, RIGHT_BRAKE, GEAR), (0.0, 1.0)),
    PITOT_ICE: (0.0, 1.0),
}
_NEEDS = {
    **dict.fromkeys(YOKE, OVERRIDE_JOYSTICK),
    **dict.fromkeys(_SERVO, OVERRIDE_AUTOPILOT),
    **dict.fromkeys(_ARTSTAB, OVERRIDE_ARTSTAB),
    **dict.fromkeys((LEFT_BRAKE, RIGHT_BRAKE), OVERRIDE_BRAKES),
    THROTTLE_USE: OVERRIDE_THROTTLES,
}
"""The override without which a control belongs to the simulator."""
_READ_ONLY = (SERVOS_ON, AUTOTHROTTLE_ON)
_JOYSTICK_ROW = 8
_THROTTLE_ROW = 25

_ELEMENT = re.compile(r"([^\[\]]+)(?:\[(\d{1,3})\])?")


@dataclass(frozen=True)
class Write:
    """A value that was written to the simulator."""

    time_s: float
    """Simulated time."""
    path: str
    value: float
    took: bool
    """Whether it had an effect; without its override a control has none."""


@dataclass(frozen=True)
class Release:
    """An override that went from 1 to 0, and the controls at that moment."""

    time_s: float
    """Simulated time."""
    path: str
    elevator: float
    aileron: float
    rudder: float


Element = tuple[str, int]
"""A dataref's name and the index of its element."""


@lru_cache(maxsize=4_096)
def split(path: str) -> Element | None:
    """Return a dataref's name and element; the first element without brackets; None if invalid."""
    match = _ELEMENT.fullmatch(path)
    return None if match is None else (match[1], int(match[2] or 0))


class Cockpit:
    """The writable datarefs and their effects."""

    def __init__(
        self,
        pilot: Controls,
        engines: int = 1,
        version: int = 115_501,
        altimeter_inhg: float = STANDARD_INHG,
    ) -> None:
        """Set the controls held by the pilot, the number of engines and X-Plane's version."""
        self.pilot = pilot
        self.engines = engines
        self.journal: list[Write] = []
        self.releases: list[Release] = []
        values: dict[str, float] = {
            OVERRIDE_JOYSTICK: 0.0,
            OVERRIDE_THROTTLES: 0.0,
            OVERRIDE_ARTSTAB: 0.0,
            OVERRIDE_AUTOPILOT: 0.0,
            OVERRIDE_BRAKES: 0.0,
            FLAPS: 0.0,
            GEAR: 1.0,
            LEFT_BRAKE: 0.0,
            RIGHT_BRAKE: 0.0,
            SERVOS_ON: 0.0,
            AUTOTHROTTLE_ENABLED: 0.0,
            AUTOTHROTTLE_ON: 0.0,
            ARTIFICIAL_STABILITY_ON: 0.0,
            YAW_DAMPER_ON: 0.0,
            ALTIMETER_SETTING: altimeter_inhg,
            PITOT_ICE: 0.0,
            GENERATOR_FAILURE: 0.0,
            ELEVATOR_TRIM: pilot.elevator_trim or 0.0,
            SIM_SPEED: 1.0,
            **dict.fromkeys((*YOKE, *_SERVO, *_ARTSTAB), 0.0),
        }
        self._values: dict[Element, float] = {(path, 0): value for path, value in values.items()}
        lights = 128 if version >= _MORE_LIGHTS_SINCE else 64
        for name, size, value in (
            (GENERIC_LIGHTS, lights, 0.0),
            (THROTTLE_USE, _ENGINES, pilot.throttle),
            (THROTTLE_LEVER, _ENGINES, pilot.throttle),
            (PROPELLER_MODE, _ENGINES, _NORMAL),
        ):
            self._values.update({(name, i): value for i in range(size)})
        self._moves_flaps = False
        self._moves_gear = False
        self._return_yoke()

    def element(self, path: str) -> Element | None:
        """Return the writable dataref of that name, or None."""
        element = split(path)
        return element if element in self._values else None

    def value(self, element: Element) -> float:
        """Return the value of an element."""
        return self._values[element]

    def read(self, path: str) -> float | None:
        """Return a writable dataref's value, or None if there is none with that name."""
        element = self.element(path)
        return None if element is None else self._values[element]

    def is_on(self, path: str) -> bool:
        """Return whether a switch or an override is set."""
        value = self.read(path)
        return value is not None and round(value) == 1

    def write(self, time_s: float, path: str, value: float) -> bool:
        """Set a dataref as a client does. Return whether that had an effect."""
        element = self.element(path)
        if element is None:
            return False
        name = element[0]
        needs = _NEEDS.get(name)
        took = name not in _READ_ONLY and (needs is None or self.is_on(needs))
        least, most = _RANGES.get(name, (value, value))
        value = min(most, max(least, value))
        self.journal.append(Write(time_s, path, value, took))
        if took:
            self._take(time_s, element, value)
        return took

    def set(self, path: str, value: float) -> None:
        """Set a dataref as the simulator itself does: also one that a client can only read."""
        element = self.element(path)
        if element is None:
            raise ValueError(f"no writable dataref '{path}'")
        self._values[element] = value

    def write_row(self, time_s: float, row: int, values: Sequence[float]) -> bool:
        """Set the controls of DATA row 8 or 25; columns of -999 are unchanged."""
        if row == _JOYSTICK_ROW:
            paths = list(YOKE)
        elif row == _THROTTLE_ROW:
            paths = [f"{THROTTLE_USE}[{i}]" for i in range(len(values))]
        else:
            return False
        took = [
            self.write(time_s, path, value)
            for path, value in zip(paths, values, strict=False)
            if value != UNUSED
        ]
        return any(took)

    def hold(self, pilot: Controls) -> None:
        """Move the pilot's stick, pedals and levers; they have no effect under an override."""
        self.pilot = pilot
        if not self.is_on(OVERRIDE_JOYSTICK):
            self._return_yoke()
        for i in range(_ENGINES):
            self._values[THROTTLE_LEVER, i] = pilot.throttle
        self._follow_levers()

    def set_reverse(self, *, on: bool) -> None:
        """Select reverse thrust on every engine, or the normal one."""
        for i in range(_ENGINES):
            self._values[PROPELLER_MODE, i] = _REVERSE if on else _NORMAL
        self._follow_levers()

    def yoke(self) -> Controls:
        """Return the deflection of the joystick, and the throttle in use."""
        return self._sum(YOKE)

    def controls(self) -> Controls:
        """Return the controls in effect: joystick, servo and artificial stability together."""
        return self._sum(YOKE, _SERVO, _ARTSTAB)

    def stabilised(self) -> Controls:
        """Return joystick and artificial stability together."""
        return self._sum(YOKE, _ARTSTAB)

    def throttles(self) -> list[float]:
        """Return the throttle in use of each engine."""
        return [self._values[THROTTLE_USE, i] for i in range(self.engines)]

    def clear_overrides(self) -> None:
        """Clear every override, as loading an aircraft does: that is not a release by a client."""
        for name, index in self._values:
            if name.startswith(_OVERRIDE):
                self._values[name, index] = 0.0
        self._return_yoke()
        self._follow_levers()

    def _sum(self, *parts: tuple[str, str, str]) -> Controls:
        pitch, roll, heading = (
            min(1.0, max(-1.0, sum(self._values[part[axis], 0] for part in parts)))
            for axis in range(3)
        )
        held = self.is_on(OVERRIDE_BRAKES)
        return Controls(
            pitch,
            roll,
            heading,
            self._values[THROTTLE_USE, 0],
            self._values[ELEVATOR_TRIM, 0],
            flaps=self._values[FLAPS, 0] if self._moves_flaps else None,
            # Otherwise they are as the pilot has set them.
            left_brake=self._values[LEFT_BRAKE, 0] if held else None,
            right_brake=self._values[RIGHT_BRAKE, 0] if held else None,
            gear=self._values[GEAR, 0] if self._moves_gear else None,
        )

    def _take(self, time_s: float, element: Element, value: float) -> None:
        name = element[0]
        was_on = self.is_on(name)
        # An int takes the integer part of what is written.
        self._values[element] = float(int(value)) if name == GEAR else value
        self._moves_flaps |= name == FLAPS
        self._moves_gear |= name == GEAR
        if name in (OVERRIDE_JOYSTICK, OVERRIDE_THROTTLES) and was_on and not self.is_on(name):
            self._release(time_s, name)
        elif name == THROTTLE_LEVER:
            self._follow_levers()
        elif name == AUTOTHROTTLE_ENABLED:
            self._values[AUTOTHROTTLE_ON, 0] = float(value > 0.0)

    def _release(self, time_s: float, name: str) -> None:
        held = self.yoke()
        self.releases.append(Release(time_s, name, held.elevator, held.aileron, held.rudder))
        if name == OVERRIDE_JOYSTICK:
            self._return_yoke()
        else:
            self._follow_levers()

    def _return_yoke(self) -> None:
        self._values[YOKE_PITCH, 0] = self.pilot.elevator
        self._values[YOKE_ROLL, 0] = self.pilot.aileron
        self._values[YOKE_HEADING, 0] = self.pilot.rudder

    def _follow_levers(self) -> None:
        if self.is_on(OVERRIDE_THROTTLES):
            return
        for i in range(_ENGINES):
            sign = -1.0 if self._values[PROPELLER_MODE, i] == _REVERSE else 1.0
            self._values[THROTTLE_USE, i] = sign * self._values[THROTTLE_LEVER, i]
