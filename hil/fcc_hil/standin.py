"""A stand-in for X-Plane: JSBSim behind X-Plane's UDP protocol, in real time.

One thread runs one frame after another, as X-Plane does: read received datagrams, step the flight
model, send replies. Frames have absolute deadlines; within one, JSBSim takes its own steps of 1/120
s. The truth is kept in memory for the score.
"""

from __future__ import annotations

import math
import socket
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass, field
from enum import Enum
from typing import Any

from .cockpit import OVERRIDE_JOYSTICK, OVERRIDE_THROTTLES, Cockpit
from .datarefs import Readout, getter, withheld
from .faults import Address, Faults, FaultyLink
from .frames import FrameClock
from .noise import SensorNoise
from .plant import STEPS_PER_SECOND, Plant, Weather
from .protocol import (
    Dialect,
    ProtocolError,
    RequestPosition,
    RunCommand,
    SelectRows,
    Subscribe,
    WriteDataref,
    WriteRows,
    beacon,
    data_rows,
    parse,
)
from .rows import row_values
from .sensor_faults import FaultySensors
from .state import State
from .subscriptions import Subscriptions
from .truth import STEPS_PER_ROW, Row, row

SLOWEST_TRUE_FPS = 20.0
"""Below this frame rate X-Plane's time runs slower than the wall clock."""

BEACON_GROUP: Address = ("239.255.1.1", 49707)
PAUSE_TOGGLE = "sim/operation/pause_toggle"

_BEACON_PERIOD_S = 1.0
_LARGEST_DATAGRAM = 65_536
_LAST_REFUSALS = 20


class Mode(Enum):
    """The simulator's state."""

    RUNNING = "running"
    PAUSED = "paused"
    """Paused: continues to send, `sim/time/paused` is 1."""
    STALLED = "stalled"
    """Its clock has stopped, without a report."""
    FROZEN = "frozen"
    """Hung: reads nothing, sends nothing."""


@dataclass(frozen=True)
class Settings:
    """The settings of the stand-in."""

    aircraft: str = "c172p"
    seed: int = 1
    host: str = "127.0.0.1"
    """Of IPv4 or of IPv6."""
    port: int = 49_000
    """0 selects a free port."""
    frame_rate_hz: float = 60.0
    version: int = 115_501
    """The version of X-Plane."""
    heading_deg: float = 0.0
    magnetic_variation_deg: float = 0.0
    """Positive where magnetic north lies east of true."""
    weather: Weather = field(default_factory=Weather)
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


class StandIn:
    """The simulator. Use it from one thread only."""

    def __init__(self, settings: Settings) -> None:
        """Set the aircraft up in flight and open the port; raise OSError if that fails."""
        self.settings = settings
        self.dialect = Dialect(settings.version)
        self.mode = Mode.RUNNING
        self.messages: dict[str, int] = {}
        """Number of accepted datagrams of each kind."""
        self.refused = 0
        self.last_refusals: list[str] = []
        """Why datagrams were refused, newest last."""
        self.unsent = 0
        """Datagrams that the kernel would not send."""
        self._set_up_aircraft()
        self._subscriptions = Subscriptions(
            self.dialect, shuffle=settings.shuffle, seed=settings.seed
        )
        self._selected = set(settings.data_rows)
        self._inbound: FaultyLink[Address] = FaultyLink(settings.inbound, settings.seed)
        self._outbound: FaultyLink[Address] = FaultyLink(settings.outbound, settings.seed + 1)
        self._noise = SensorNoise(settings.seed) if settings.noise else None
        self.sensors = FaultySensors()
        """The faults between the true state and the sent values."""
        self._frame_time_s = 0.0
        self._next_beacon_s = 0.0
        self._next_data_s = 0.0
        self._socket = self._open()
        self.clock = FrameClock(settings.frame_rate_hz)

    @property
    def port(self) -> int:
        """Return the port that it listens on."""
        port: int = self._socket.getsockname()[1]
        return port

    def close(self) -> None:
        """Close the port."""
        self._socket.close()

    def run(self, each_frame: Callable[[], bool]) -> None:
        """Run frames in real time until `each_frame`, called before each, returns False."""
        self.clock.set_rate(self.clock.rate_hz)
        while each_frame():
            self.clock.wait()
            self.frame()
            self.clock.done()

    def frame(self) -> None:
        """Run one frame, regardless of the time."""
        if self.mode is Mode.FROZEN:
            return
        self._frame_time_s += self.clock.period_s
        self._receive()
        if self.mode is Mode.RUNNING:
            self._advance()
        self._send()

    # Actions of a person at the simulator.

    def read(self, path: str) -> float | None:
        """Return a dataref as a client would read it now, without sensor noise; None if unknown."""
        read = getter(path, self.cockpit, self.dialect)
        return None if read is None else read(self._readout(self.plant.state()))

    def write(self, path: str, value: float) -> float:
        """Set a dataref from inside the simulator; return the simulated time."""
        self.cockpit.write(self.plant.time_s, path, value)
        return self.plant.time_s

    def restart_flight(self) -> None:
        """Put the aircraft back to its start: the clock jumps back, overrides are off."""
        self._set_up_aircraft()

    def jump(self, seconds: float) -> None:
        """Move the simulator's clock without flying."""
        self._time_offset_s += seconds

    def progress(self) -> Progress:
        """Return the progress of the flight; fast enough to be called every frame."""
        return Progress(
            now=row(self.plant.state(), self.cockpit.controls()),
            mode=self.mode,
            subscriptions=sum(len(paths) for paths in self._subscriptions.paths().values()),
            overridden=self.cockpit.is_on(OVERRIDE_JOYSTICK)
            or self.cockpit.is_on(OVERRIDE_THROTTLES),
        )

    def status(self) -> dict[str, Any]:
        """Return the status: clients, received messages, statistics of frames."""
        clients = self._subscriptions.paths()
        return {
            "mode": self.mode.value,
            "clients": {f"{host}:{port}": paths for (host, port), paths in clients.items()},
            "unknown_datarefs": dict(self._subscriptions.unknown),
            "messages": dict(self.messages),
            "refused": self.refused,
            "unsent": self.unsent,
            "last_refusals": list(self.last_refusals),
            "inbound": asdict(self._inbound.counts),
            "outbound": asdict(self._outbound.counts),
            "frames": self.clock.report(),
            "engines": self.plant.engines,
        }

    def _set_up_aircraft(self) -> None:
        settings = self.settings
        self.plant = Plant(
            settings.aircraft,
            seed=settings.seed,
            heading_deg=settings.heading_deg,
            weather=settings.weather,
        )
        self.cockpit = Cockpit(self.plant.trim, self.plant.engines)
        start = self.plant.state()
        self._origin = (start.latitude_rad, start.longitude_rad)
        self._time_offset_s = 0.0
        self._owed_steps = 0.0
        self.truth: list[Row] = [row(start, self.cockpit.controls())]

    def _open(self) -> socket.socket:
        settings = self.settings
        is_ipv6 = ":" in settings.host
        family = socket.AF_INET6 if is_ipv6 else socket.AF_INET
        opened = socket.socket(family, socket.SOCK_DGRAM)
        try:
            opened.bind((settings.host, settings.port))
        except OSError as error:
            opened.close()
            raise OSError(
                f"cannot listen on {settings.host}:{settings.port} ({error.strerror}); "
                "is X-Plane or another stand-in running? Choose another with --port"
            ) from error
        opened.setblocking(False)
        if is_ipv6:
            return opened  # The beacon is of IPv4.
        opened.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 1)
        opened.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_LOOP, 1)
        if settings.host != "0.0.0.0":
            interface = socket.inet_aton(socket.gethostbyname(settings.host))
            opened.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, interface)
        return opened

    def _receive(self) -> None:
        now_s = time.monotonic()
        while True:
            try:
                datagram, sender = self._socket.recvfrom(_LARGEST_DATAGRAM)
            except BlockingIOError:
                break
            except ConnectionError:
                # The kernel reports that a client has ended; nothing is lost.
                continue
            # Of IPv6 there are four parts.
            self._inbound.offer(now_s, sender[:2], datagram)
        for sender, datagram in self._inbound.due(now_s):
            try:
                self._handle(sender, datagram)
            except ProtocolError as error:
                self.refused += 1
                self.last_refusals = [*self.last_refusals, str(error)][-_LAST_REFUSALS:]

    def _handle(self, sender: Address, datagram: bytes) -> None:
        message = parse(datagram)
        kind = type(message).__name__
        self.messages[kind] = self.messages.get(kind, 0) + 1
        now_s = self.plant.time_s
        match message:
            case Subscribe():
                self._subscriptions.subscribe(self._frame_time_s, sender, message, self.cockpit)
            case RequestPosition():
                self._subscriptions.request_position(self._frame_time_s, sender, message)
            case WriteDataref(value, path):
                self.cockpit.write(now_s, path, value)
            case WriteRows(rows):
                for index, values in rows:
                    self.cockpit.write_row(now_s, index, values)
            case SelectRows(rows, on):
                self._selected = self._selected | set(rows) if on else self._selected - set(rows)
            case RunCommand(path):
                self._run_command(path)

    def _run_command(self, path: str) -> None:
        if path == PAUSE_TOGGLE:
            self.mode = Mode.RUNNING if self.mode is Mode.PAUSED else Mode.PAUSED

    def _advance(self) -> None:
        self.plant.write(self.cockpit.controls(), self.cockpit.throttles())
        frame_s = min(self.clock.period_s, 1.0 / SLOWEST_TRUE_FPS)
        self._owed_steps += frame_s * STEPS_PER_SECOND
        steps = math.floor(self._owed_steps + 1e-9)
        self._owed_steps -= steps
        for _ in range(steps):
            self.plant.step()
            if self.plant.steps % STEPS_PER_ROW == 0:
                self.truth.append(row(self.plant.state(), self.plant.controls))

    def _readout(self, state: State) -> Readout:
        return Readout(
            state=state,
            cockpit=self.cockpit,
            dialect=self.dialect,
            flight_time_s=self.plant.time_s + self._time_offset_s,
            paused=self.mode is Mode.PAUSED,
            frame_period_s=self.clock.period_s,
            origin_latitude_rad=self._origin[0],
            origin_longitude_rad=self._origin[1],
            magnetic_variation_deg=self.settings.magnetic_variation_deg,
        )

    def _send(self) -> None:
        now_s = time.monotonic()
        state = self.plant.state()
        sensed = self._noise.apply(state) if self._noise else state
        measured, missing = self.sensors.read(self.plant.time_s, sensed)
        if measured is not None:
            readout = self._readout(measured)
            paths = withheld(missing)
            for client, datagram in self._subscriptions.due(self._frame_time_s, readout, paths):
                self._outbound.offer(now_s, client, datagram)
            self._offer_data_output(now_s, readout)
        for client, datagram in self._outbound.due(now_s):
            self._transmit(client, datagram)
        target = self.settings.beacon
        if target is not None and self._frame_time_s >= self._next_beacon_s:
            self._next_beacon_s = self._frame_time_s + _BEACON_PERIOD_S
            self._transmit(target, beacon(self.dialect, self.port, socket.gethostname()))

    def _offer_data_output(self, now_s: float, readout: Readout) -> None:
        target = self.settings.data_target
        if target is None or not self._selected or self._frame_time_s < self._next_data_s:
            return
        self._next_data_s = self._frame_time_s + 1.0 / self.settings.data_rate_hz - 1e-6
        rows = [(index, row_values(index, readout)) for index in sorted(self._selected)]
        known = [(index, values) for index, values in rows if values is not None]
        if known:
            self._outbound.offer(now_s, target, data_rows(known, self.dialect))

    def _transmit(self, client: Address, datagram: bytes) -> None:
        try:
            self._socket.sendto(datagram, client)
        except OSError:
            # No route, or a client that has ended: X-Plane continues, and so does this.
            self.unsent += 1
