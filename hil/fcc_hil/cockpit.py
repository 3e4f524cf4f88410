"""Datarefs that a client can set in the simulator: overrides, joystick, throttles, switches.

As in X-Plane, the joystick datarefs belong to the pilot until `override_joystick` is 1: a value
written before is lost by the next frame. The pilot here holds the trimmed controls. DATA rows 8 and
25 set the same datarefs and obey the same overrides. Sources differ on whether row 8 alone
overrides X-Plane's joystick; a client that sets the override first is right in either case.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from .protocol import UNUSED
from .state import Controls

OVERRIDE_JOYSTICK = "sim/operation/override/override_joystick"
OVERRIDE_THROTTLES = "sim/operation/override/override_throttles"
YOKE_PITCH = "sim/joystick/yoke_pitch_ratio"
YOKE_ROLL = "sim/joystick/yoke_roll_ratio"
YOKE_HEADING = "sim/joystick/yoke_heading_ratio"
THROTTLE_USE = "sim/flightmodel/engine/ENGN_thro_use"
GENERIC_LIGHTS = "sim/cockpit2/switches/generic_lights_switch"
SERVOS_ON = "sim/cockpit2/autopilot/servos_on"

YOKE = (YOKE_PITCH, YOKE_ROLL, YOKE_HEADING)
_SIZES = {THROTTLE_USE: 8, GENERIC_LIGHTS: 64}
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


def split(path: str) -> Element | None:
    """Return a dataref's name and element; the first element without brackets; None if invalid."""
    match = _ELEMENT.fullmatch(path)
    return None if match is None else (match[1], int(match[2] or 0))


class Cockpit:
    """The writable datarefs and their effects."""

    def __init__(self, pilot: Controls, engines: int = 1) -> None:
        """Set the controls held by the pilot, and the number of engines."""
        self.pilot = pilot
        self.engines = engines
        self.journal: list[Write] = []
        self.releases: list[Release] = []
        self._values: dict[Element, float] = {
            (OVERRIDE_JOYSTICK, 0): 0.0,
            (OVERRIDE_THROTTLES, 0): 0.0,
            (SERVOS_ON, 0): 0.0,
            (YOKE_PITCH, 0): pilot.elevator,
            (YOKE_ROLL, 0): pilot.aileron,
            (YOKE_HEADING, 0): pilot.rudder,
        }
        for name, size in _SIZES.items():
            start = pilot.throttle if name == THROTTLE_USE else 0.0
            self._values.update({(name, i): start for i in range(size)})

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
        """Set a dataref. Return whether that had an effect."""
        element = self.element(path)
        if element is None:
            return False
        name = element[0]
        took = True
        if name in YOKE:
            took = self.is_on(OVERRIDE_JOYSTICK)
            value = min(1.0, max(-1.0, value))
        elif name == THROTTLE_USE:
            took = self.is_on(OVERRIDE_THROTTLES)
            value = min(1.0, max(0.0, value))
        self.journal.append(Write(time_s, path, value, took))
        if not took:
            return False
        was_on = self.is_on(path)
        self._values[element] = value
        if name in (OVERRIDE_JOYSTICK, OVERRIDE_THROTTLES) and was_on and not self.is_on(path):
            self._release(time_s, name)
        return True

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

    def controls(self) -> Controls:
        """Return the controls in effect."""
        return Controls(
            elevator=self._values[YOKE_PITCH, 0],
            aileron=self._values[YOKE_ROLL, 0],
            rudder=self._values[YOKE_HEADING, 0],
            throttle=self._values[THROTTLE_USE, 0],
        )

    def throttles(self) -> list[float]:
        """Return the throttle of each engine."""
        return [self._values[THROTTLE_USE, i] for i in range(self.engines)]

    def _release(self, time_s: float, name: str) -> None:
        held = self.controls()
        self.releases.append(Release(time_s, name, held.elevator, held.aileron, held.rudder))
        if name == OVERRIDE_JOYSTICK:
            self._values[YOKE_PITCH, 0] = self.pilot.elevator
            self._values[YOKE_ROLL, 0] = self.pilot.aileron
            self._values[YOKE_HEADING, 0] = self.pilot.rudder
        else:
            for i in range(_SIZES[THROTTLE_USE]):
                self._values[THROTTLE_USE, i] = self.pilot.throttle
