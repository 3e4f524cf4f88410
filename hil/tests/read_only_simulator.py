"""A link to the stand-in that forwards requests and drops writes.

As X-Plane 12 with "Accept incoming connections" partly enabled, or a firewall: it sends its data,
and receives no writes.
"""

from __future__ import annotations

import selectors
import socket
import threading

_LARGEST_DATAGRAM = 65_536
_LOOK_S = 0.1
_WRITES = (b"DREF", b"DATA")


class ReadOnlySimulator:
    """Between a daemon and a stand-in; a context manager."""

    def __init__(self, simulator_port: int) -> None:
        self.dropped = 0
        """The number of writes dropped."""
        self._daemon: tuple[str, int] | None = None
        self._outside = self._open()
        self._inside = self._open()
        self._simulator = ("127.0.0.1", simulator_port)
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._forward, name="read-only-simulator")

    @property
    def port(self) -> int:
        """Return the port for the daemon."""
        port: int = self._outside.getsockname()[1]
        return port

    def __enter__(self) -> ReadOnlySimulator:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._over.set()
        self._thread.join()
        self._outside.close()
        self._inside.close()

    @staticmethod
    def _open() -> socket.socket:
        opened = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        opened.bind(("127.0.0.1", 0))
        return opened

    def _forward(self) -> None:
        with selectors.DefaultSelector() as selector:
            selector.register(self._outside, selectors.EVENT_READ, self._inwards)
            selector.register(self._inside, selectors.EVENT_READ, self._outwards)
            while not self._over.is_set():
                for key, _ in selector.select(_LOOK_S):
                    key.data()

    def _inwards(self) -> None:
        datagram, self._daemon = self._outside.recvfrom(_LARGEST_DATAGRAM)
        if datagram.startswith(_WRITES):
            self.dropped += 1
        else:
            self._inside.sendto(datagram, self._simulator)

    def _outwards(self) -> None:
        datagram = self._inside.recv(_LARGEST_DATAGRAM)
        if self._daemon is not None:
            self._outside.sendto(datagram, self._daemon)
