"""The settings of the stand-in, and its states.

The defaults are the manners of a real X-Plane: replies from a port of their own, frames of uneven
length, local axes that are not the aircraft's, an altimeter that is not at the standard pressure,
surfaces that take time. `Settings.plain()` is without them, for tests that count frames or compare
values.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from enum import Enum
from pathlib import Path
from typing import Any

from .faults import Address, Faults
from .plant import Weather
from .udp import ReplyPort
from .units import STANDARD_INHG

LARGEST_QUEUE = 140
"""A frame takes about 140 messages (P. Muenzel of Laminar, charlylima/XPlaneUDP pull request 3)."""

_FARTHEST_ORIGIN_DEG = 5.0


class Mode(Enum):
    """The simulator's state."""

    RUNNING = "running"
    PAUSED = "paused"
    """Paused: continues to send, `sim/time/paused` is 1."""
    STALLED = "stalled"
    """A map, a menu or an alert is open: its clock has stopped, and `sim/time/paused` stays 0."""
    REPLAY = "replay"
    """Shows the past: `sim/time/is_in_replay` is 1, the aircraft does not fly on."""
    FROZEN = "frozen"
    """Hung: reads nothing, sends nothing."""


@dataclass(frozen=True)
class Start:
    """Where the aircraft begins: in flight, or on the wheels."""

    latitude_deg: float = 0.0
    longitude_deg: float = 0.0
    runway_elevation_ft: float | None = None
    """Of the runway on which it stands; None in flight."""


@dataclass(frozen=True)
class Settings:
    """The settings of the stand-in."""

    aircraft: str = "c172p"
    seed: int = 1
    host: str = "127.0.0.1"
    """Of IPv4 or of IPv6."""
    port: int = 49_000
    """The port that it listens on; 0 selects a free one."""
    reply_port: ReplyPort = "next"
    """The port that it sends from, as X-Plane sends from 49001."""
    frame_rate_hz: float = 60.0
    frame_rates_hz: tuple[float, float] | None = (20.0, 144.0)
    """Least and greatest rate of frames that vary at random about `frame_rate_hz`; None for
    constant ones."""
    version: int = 115_501
    """The version of X-Plane."""
    start: Start = Start()
    terrain: Path | None = None
    """The folder of elevation tiles that are the ground; None, and where they do not know it, for
    level ground."""
    heading_deg: float = 0.0
    magnetic_variation_deg: float = 0.0
    """Positive where magnetic north lies east of true."""
    weather: Weather = field(default_factory=Weather)
    qnh_inhg: float = 30.12
    """The pressure at sea level. The pilot's altimeter is set to it at first."""
    origin_offset_deg: tuple[float, float] = (0.5, 0.5)
    """Latitude and longitude of the local axes' origin less those of the aircraft at first."""
    origin_moves_after_s: float = 45.0
    """When the origin moves by itself, as at the edge of a scenery tile, in simulated time."""
    surface_rate: float = 2.0
    """How fast the control surfaces move, in full deflections a second."""
    axial_sign: float = 1.0
    """The sign of the axial load in row 4, in which sources differ: 1 is positive when pushed
    forward (ArduPilot), -1 the other way (px4xplane)."""
    sends_while_stalled: bool = True
    """Whether it sends while a map, a menu or an alert is open: no source says so."""
    replays_clock: bool = True
    """Whether the flight time of a replay is that of the past; else it stands still. No source says
    which."""
    queue: int = LARGEST_QUEUE
    """How many of the datagrams that arrived since the last frame are read; the later ones are
    lost."""
    noise: bool = False
    inbound: Faults = field(default_factory=Faults)
    """Faults of datagrams to the simulator."""
    outbound: Faults = field(default_factory=Faults)
    """Faults of datagrams from it, except the beacon."""
    shuffle: bool = True
    """Whether the values in a reply are in random order."""
    beacon: Address | None = None
    """Destination of the beacon, BEACON_GROUP for all; None sends none."""
    data_target: Address | None = None
    """Destination of Data Output, as set in X-Plane's menus."""
    data_rows: tuple[int, ...] = ()
    """The rows selected there."""
    data_rate_hz: float = 20.0
    person: bool = False
    """Whether a person sits at it, who does what `fccd x-plane check --yes` asks for (`person`)."""
    board: str = ""
    """The servo board between the computer and the surfaces (`boarded`): `udp`, or the path that
    is to lead to its serial line; empty for none."""
    phone: tuple[int, int] | None = None
    """The phone aboard (`phoned`): the UDP ports of its fake libandroid, and of the app for its
    positions; None for none."""
    misbehaves_in: tuple[int, ...] = ()
    """The steps of that check in which it misbehaves (`misbehaviour`); needs the person."""

    def __post_init__(self) -> None:
        """Refuse what no simulator has."""
        for name, least, most in (
            ("qnh_inhg", 25.0, 32.0),
            ("surface_rate", 0.01, math.inf),
            ("queue", 1, 100_000),
            ("origin_moves_after_s", 0.0, math.inf),
        ):
            if not least <= getattr(self, name) <= most:
                raise ValueError(f"{name} = {getattr(self, name):g}: give {least:g} to {most:g}")
        if any(not abs(offset) <= _FARTHEST_ORIGIN_DEG for offset in self.origin_offset_deg):
            raise ValueError(
                f"origin_offset_deg = {self.origin_offset_deg}: give two of at most "
                f"{_FARTHEST_ORIGIN_DEG:g} degrees"
            )
        if self.axial_sign not in (1.0, -1.0):
            raise ValueError(f"axial_sign = {self.axial_sign:g}: give 1 or -1")

    @classmethod
    def plain(cls, **changes: Any) -> Settings:
        """Return settings without the manners.

        Constant frames, the standard pressure, local axes that stay level at the aircraft's start,
        surfaces that follow at once.
        """
        plain: dict[str, Any] = {
            "frame_rates_hz": None,
            "qnh_inhg": STANDARD_INHG,
            "origin_offset_deg": (0.0, 0.0),
            "origin_moves_after_s": math.inf,
            "surface_rate": math.inf,
        }
        return cls(**{**plain, **changes})
