"""A stand-in for X-Plane: JSBSim behind X-Plane's UDP protocol, in real time.

One thread runs one frame after another, as X-Plane does: read received datagrams, step the flight
model, send replies. Frames have absolute deadlines; within one, JSBSim takes its own steps of 1/120
s. The truth is kept in memory for the score.
"""

from __future__ import annotations

import socket
import time
from collections.abc import Callable
from dataclasses import asdict
from typing import Any

from .datarefs import withheld
from .faults import Address, FaultyLink
from .faulty_sensors import FaultySensors
from .noise import SensorNoise
from .protocol import (
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
from .readout import Readout
from .rows import row_values
from .settings import Mode, Settings
from .subscriptions import Subscriptions
from .truth import row
from .udp import address_of, open_ports, port_of, send_beacons_from
from .world import Progress, World
from .xplane_commands import PAUSE_TOGGLE, run_command

__all__ = ["BEACON_GROUP", "PAUSE_TOGGLE", "Mode", "Progress", "Settings", "StandIn"]

BEACON_GROUP: Address = ("239.255.1.1", 49707)

_BEACON_PERIOD_S = 1.0
_LARGEST_DATAGRAM = 65_536
_LAST_REFUSALS = 20


class StandIn(World):
    """The simulator. Use it from one thread only."""

    def __init__(self, settings: Settings) -> None:
        """Set the aircraft up in flight and open the ports; raise OSError if that fails."""
        super().__init__(settings)
        self.scheduling = ""
        """What the kernel granted its process."""
        self.messages: dict[str, int] = {}
        """Number of accepted datagrams of each kind."""
        self.refused = 0
        self.last_refusals: list[str] = []
        """Why datagrams were refused, newest last."""
        self.unsent = 0
        """Datagrams that the kernel would not send."""
        self.unknown_commands: dict[str, int] = {}
        """Commands without an effect here, with their number."""
        self.overflowed = 0
        """Datagrams lost because too many arrived for one frame."""
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
        self._listens, self._replies = open_ports(settings.host, settings.port, settings.reply_port)
        if ":" not in settings.host:
            # The beacon is of IPv4.
            send_beacons_from(self._replies, settings.host)

    @property
    def port(self) -> int:
        """Return the port that it listens on."""
        return port_of(self._listens)

    @property
    def reply_port(self) -> int:
        """Return the port that it sends from."""
        return port_of(self._replies)

    def close(self) -> None:
        """Close the ports."""
        self._listens.close()
        self._replies.close()

    def run(self, each_frame: Callable[[], bool]) -> None:
        """Run frames in real time until `each_frame`, called before each, returns False."""
        self.clock.restart()
        while each_frame():
            self.clock.wait()
            self.frame()
            self.clock.done()

    def frame(self) -> None:
        """Run one frame, regardless of the time."""
        if not self.pass_time():
            return
        self._frame_time_s += self.period_s
        self._receive()
        self.fly()
        self._send()

    def progress(self) -> Progress:
        """Return the progress of the flight; fast enough to be called every frame."""
        return Progress(
            now=row(self.plant.state(), self.cockpit.controls()),
            mode=Mode.FROZEN if self.is_frozen() else self.mode,
            subscriptions=sum(len(paths) for paths in self._subscriptions.paths().values()),
            overridden=self.overridden(),
        )

    def status(self) -> dict[str, Any]:
        """Return the status: clients, received messages, statistics of frames."""
        clients = self._subscriptions.paths()
        return {
            "mode": self.mode.value,
            "port": self.port,
            "reply_port": self.reply_port,
            "clients": {f"{host}:{port}": paths for (host, port), paths in clients.items()},
            "unknown_datarefs": dict(self._subscriptions.unknown),
            "unknown_commands": dict(self.unknown_commands),
            "messages": dict(self.messages),
            "refused": self.refused,
            "overflowed": self.overflowed,
            "unsent": self.unsent,
            "last_refusals": list(self.last_refusals),
            "inbound": asdict(self._inbound.counts),
            "outbound": asdict(self._outbound.counts),
            "frames": self.clock.report(),
            "engines": self.plant.engines,
            "scheduling": self.scheduling,
        }

    def at_board(self, action: str, *_: float) -> object:
        """Raise ValueError: a stand-in with a servo board does something there (`boarded`)."""
        raise ValueError(f"{action}: there is no servo board: set Settings.board")

    def _receive(self) -> None:
        now_s = time.monotonic()
        arrived = 0
        while True:
            try:
                datagram, sender = self._listens.recvfrom(_LARGEST_DATAGRAM)
            except BlockingIOError:
                break
            except ConnectionError:
                # The kernel reports that a client has ended; nothing is lost.
                continue
            if self.link_is_cut:
                continue
            arrived += 1
            if arrived > self.settings.queue:
                self.overflowed += 1
                continue
            self._inbound.offer(now_s, address_of(sender), datagram)
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
                if not run_command(self, path):
                    self.unknown_commands[path] = self.unknown_commands.get(path, 0) + 1

    def _send(self) -> None:
        now_s = time.monotonic()
        state = self.shown()
        sensed = self._noise.apply(state) if self._noise else state
        measured, missing = self.sensors.read(self.plant.time_s, sensed)
        silent = self.mode is Mode.STALLED and not self.settings.sends_while_stalled
        if measured is not None and not silent:
            readout = self.measured_readout(state, measured)
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
        if self.link_is_cut:
            return
        try:
            self._replies.sendto(datagram, client)
        except OSError:
            # No route, or a client that has ended: X-Plane continues, and so does this.
            self.unsent += 1
