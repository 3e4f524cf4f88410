"""A stand-in run frame by frame, and a client made of bytes from the layouts."""

from __future__ import annotations

import select
import socket
import struct
from typing import Any

from fcc_hil import actions
from fcc_hil.standin import Settings, StandIn


class Client:
    """Bytes from the layouts, and nothing of the package."""

    def __init__(self, port: int) -> None:
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.simulator = ("127.0.0.1", port)
        self.socket.setblocking(False)
        self.senders: set[int] = set()
        """The ports that datagrams came from."""

    def send(self, datagram: bytes) -> None:
        self.socket.sendto(datagram, self.simulator)

    def subscribe(self, index: int, path: str, frequency_hz: int = 60) -> None:
        self.send(b"RREF\0" + struct.pack("<ii400s", frequency_hz, index, path.encode()))

    def write(self, path: str, value: float) -> None:
        self.send(b"DREF\0" + struct.pack("<f500s", value, path.encode()))

    def command(self, path: str) -> None:
        self.send(b"CMND\0" + path.encode() + b"\0")

    def datagrams(self) -> list[bytes]:
        found = []
        while select.select([self.socket], [], [], 0.0)[0]:
            datagram, sender = self.socket.recvfrom(2048)
            self.senders.add(sender[1])
            found.append(datagram)
        return found

    def values(self) -> dict[int, float]:
        found: dict[int, float] = {}
        for datagram in self.datagrams():
            assert datagram[:4] == b"RREF"
            found.update(dict(struct.iter_unpack("<if", datagram[5:])))
        return found


class Bench:
    """A stand-in without the manners, except those given, and its client."""

    def __init__(self, **changes: Any) -> None:
        self.simulator = StandIn(Settings.plain(**{"port": 0, **changes}))
        self.client = Client(self.simulator.port)

    def frames(self, count: int) -> dict[int, float]:
        """Run frames; return the values of the last one that brought any."""
        latest: dict[int, float] = {}
        for _ in range(count):
            self.simulator.frame()
            latest = self.client.values() or latest
        return latest

    def act(self, action: str) -> None:
        actions.act(self.simulator, action)

    def read(self, path: str) -> float:
        value = self.simulator.read(path)
        assert value is not None, path
        return value

    def close(self) -> None:
        self.simulator.close()
        self.client.socket.close()
