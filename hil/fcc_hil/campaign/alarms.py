"""The alarms of a flight: what was excluded, and the failsafes, from the events of the autopilot.

This is the only place that knows the autopilot's words. A condition that is in no table here counts
as an exclusion, so that a new one is noticed.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from ..rig import RELEASED, Event

EXCLUSION, FAILSAFE, RELEASE, SURFACE = KINDS = ("exclusion", "failsafe", "release", "surface")

_HARMLESS = (
    "recovering from an upset",
    "oscillation: gain is reduced",
    "the outputs take effect too late for the gains",
    "too little energy: speed is held, height given up",
    "flying on without a lost quantity",
    "the target altitude is limited by the floor or the fence",
    "levelling and trimming before the release",
    "the wing stalls above the configured speed: flying faster",
    "gyroscope is not yet compared with the magnetic field: engage again some seconds later",
    "position is by dead reckoning: satellite navigation is silent",
    "the battery is low, or what limits it in [contingency] is not measured",
)
"""Conditions in which nothing is excluded."""

_WITH_COMMAS = (
    "attitude contradicts body rates, forces and heading and is not used",
    "body rates contradict attitude, forces and heading and are not used",
    "a magnetometer, a barometer or a satellite receiver was wrong and is not used again",
)
"""Events list conditions with commas between them."""

_OF_SURFACES = ("the outputs do not reach the aircraft", "the elevator trim does not follow")

_CHANNELS = (
    *("airspeed", "altitude", "heading", "attitude", "body rates", "acceleration"),
    *("angle of attack", "gyroscope", "magnetometer", "satellite", "inertial unit", "barometer"),
    *("position", "elevator", "aileron", "rudder", "throttle", "output"),
)
"""By the first of these words in a text."""

_SURFACE_NOTICE = re.compile(
    r"not move the aircraft|the (wrong|other) way|reversed|jammed|no effect"
)
_SENSOR_NOTICE = re.compile(r"is not used again|do not count|it is not used|not used any more")
_REASON = re.compile(r"excluded: (.*?)(?:; .*)?$")

_SAME_S = 1.0
"""A condition that returns within this time goes on."""
_REASON_WITHIN_S = 0.1


@dataclass(frozen=True)
class Alarm:
    """Something that was reported; times are since engaging."""

    kind: str
    """One of KINDS."""
    channel: str
    reason: str
    begins_s: float
    ends_s: float | None
    """None if it lasted to the end."""
    ended_s: float
    """The end of the flight."""
    lowest_ft: float = float("nan")
    """The least altitude from its beginning to the end of the flight."""
    into_ground: bool = False

    def goes_on(self, time_s: float) -> bool:
        """Return whether one that begins at a time is the same."""
        return self.ends_s is not None and time_s - self.ends_s < _SAME_S

    @property
    def lasted_s(self) -> float:
        """How long, to the end of the flight at most."""
        return (self.ended_s if self.ends_s is None else self.ends_s) - self.begins_s

    @property
    def words(self) -> str:
        """It in a line."""
        back = "to the end" if self.ends_s is None else f"for {self.lasted_s:.1f} s"
        ground = ", into the ground" if self.into_ground else ""
        return (
            f"{self.begins_s:.1f} s {f'{self.kind} {self.channel}'.strip()} {back}: {self.reason}; "
            f"lowest {self.lowest_ft:.0f} ft{ground}"
        )


def channel_of(text: str) -> str:
    """Return the channel that a text is about."""
    found = [(text.find(name), name) for name in _CHANNELS if name in text]
    return min(found)[1] if found else "other"


def alarms_of(
    events: Sequence[Event], faults: Sequence[tuple[float, frozenset[str]]], ended_s: float
) -> list[Alarm]:
    """Return the alarms, in order, of the events and the changes of the faults since engaging.

    A channel is excluded while any of its conditions holds.
    """
    found: list[Alarm] = []
    running: dict[tuple[str, str], tuple[int, set[str]]] = {}
    signals = sorted([*_of_events(events), *_of_faults(faults)], key=lambda it: it[0])
    for time_s, kind, name, begins in signals:
        key = (kind, channel_of(name) if kind in (EXCLUSION, SURFACE) else "")
        index, names = running.get(key, (None, set()))
        if begins:
            if index is not None and not names and found[index].goes_on(time_s):
                found[index] = replace(found[index], ends_s=None)
            elif not names:
                reason = _reason(events, time_s, kind, name)
                found.append(Alarm(*key, reason, time_s, None, ended_s))
                index = len(found) - 1
            names.add(name)
            running[key] = len(found) - 1 if index is None else index, names
        elif index is not None and names:
            names.discard(name)
            if not names:
                found[index] = replace(found[index], ends_s=time_s)
    return found


_Signal = tuple[float, str, str, bool]
"""Time, kind, text, and whether it begins."""


def _of_events(events: Sequence[Event]) -> Iterator[_Signal]:
    for event in events:
        text, time_s = event.text, event.time_s
        if text == RELEASED or text.startswith("control is given back at once"):
            yield time_s, RELEASE, "", True
        elif "-> failsafe" in text:
            yield time_s, FAILSAFE, "", True
        elif text.startswith("failsafe -> "):
            yield time_s, FAILSAFE, "", False
        elif text.startswith(("now: ", "no longer: ")):
            began, _, ended = text.removeprefix("now: ").partition("no longer: ")
            yield from ((time_s, *_kind(name), True) for name in _names(began))
            yield from ((time_s, *_kind(name), False) for name in _names(ended))
        elif _SURFACE_NOTICE.search(text):
            yield time_s, SURFACE, text, True
        elif _SENSOR_NOTICE.search(text):
            yield time_s, EXCLUSION, text, True


def _names(text: str) -> list[str]:
    """Return the conditions of a list, without the harmless ones."""
    for name in _HARMLESS:
        text = text.replace(name, "")
    for name in _WITH_COMMAS:
        text = text.replace(name, name.replace(",", ""))
    return [name for name in map(str.strip, re.split(", |; ", text)) if name]


def _of_faults(faults: Sequence[tuple[float, frozenset[str]]]) -> Iterator[_Signal]:
    before: frozenset[str] = frozenset()
    for time_s, now in faults:
        for name in sorted(now ^ before):
            if name not in _HARMLESS:
                yield time_s, *_kind(name), name in now
        before = now


def _kind(name: str) -> tuple[str, str]:
    return SURFACE if name in _OF_SURFACES else EXCLUSION, name


def _reason(events: Sequence[Event], time_s: float, kind: str, name: str) -> str:
    near = [event.text for event in events if abs(event.time_s - time_s) < _REASON_WITHIN_S]
    if kind == FAILSAFE:
        return next((text.partition(": ")[2] for text in near if "-> failsafe" in text), "")
    if kind == RELEASE:
        return next((text for text in near if "-> failsafe" in text or "given back" in text), "")
    for text in near:
        reason = _REASON.search(text)
        if reason and channel_of(text) == channel_of(name):
            return reason[1]
    return name
