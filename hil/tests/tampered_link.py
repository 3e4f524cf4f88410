"""A way to the stand-in that can be cut in either direction, and says other values."""

from __future__ import annotations

import selectors
import socket
import struct
import threading

_LARGEST_DATAGRAM = 65_536
_LOOK_S = 0.1
_TAG_BYTES = 5
_REQUEST = struct.Struct("<ii")
_PAIR = struct.Struct("<if")


class TamperedLink:
    """Stands between one daemon and a stand-in; a context manager."""

    def __init__(self, simulator_port: int) -> None:
        self.cut_to_simulator = False
        self.cut_from_simulator = False
        self.says: dict[str, float] = {}
        """What a dataref is said to be, in place of what it is."""
        self._paths: dict[int, str] = {}
        self._daemon: tuple[str, int] | None = None
        self._outside = self._open()
        self._inside = self._open()
        self._inside.connect(("127.0.0.1", simulator_port))
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._forward, name="tampered-link")

    @property
    def port(self) -> int:
        """Return the port that the daemon is to be told."""
        port: int = self._outside.getsockname()[1]
        return port

    def __enter__(self) -> TamperedLink:
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
                    # Whoever is gone, at either end, is no fault of the link.
                    try:
                        key.data()
                    except ConnectionError:
                        continue

    def _inwards(self) -> None:
        datagram, self._daemon = self._outside.recvfrom(_LARGEST_DATAGRAM)
        if datagram.startswith(b"RREF"):
            _, index = _REQUEST.unpack_from(datagram, _TAG_BYTES)
            path = datagram[_TAG_BYTES + _REQUEST.size :].partition(b"\0")[0]
            self._paths[index] = path.decode()
        if not self.cut_to_simulator:
            self._inside.send(datagram)

    def _outwards(self) -> None:
        datagram = self._inside.recv(_LARGEST_DATAGRAM)
        if self._daemon is not None and not self.cut_from_simulator:
            self._outside.sendto(self._tampered(datagram), self._daemon)

    def _tampered(self, datagram: bytes) -> bytes:
        says = dict(self.says)
        if not says or not datagram.startswith(b"RREF"):
            return datagram
        pairs = _PAIR.iter_unpack(datagram[_TAG_BYTES:])
        return datagram[:_TAG_BYTES] + b"".join(
            _PAIR.pack(index, says.get(self._paths.get(index, ""), value)) for index, value in pairs
        )
