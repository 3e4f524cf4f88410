"""A link to the stand-in that can be cut in either direction, hold and change what is sent.

It is a separate process, like the stand-in, so that a busy test does not delay a datagram.
"""

from __future__ import annotations

import multiprocessing
import selectors
import signal
import socket
import struct
import time
from collections import deque
from collections.abc import Mapping
from multiprocessing.connection import Connection

from fcc_hil.process import request_real_time

_LARGEST_DATAGRAM = 65_536
_TAG_BYTES = 5
_REQUEST = struct.Struct("<ii")
_PAIR = struct.Struct("<if")
_START_S = 30.0
_STOP_S = 5.0


class _Link:
    """Forwards in its own process, until the pipe is closed."""

    def __init__(self, simulator_port: int, pipe: Connection) -> None:
        self._pipe = pipe
        self._cut = {"to": False, "from": False}
        self._says: dict[str, float] = {}
        self._held_s = 0.0
        self._waiting: deque[tuple[float, bytes]] = deque()
        self._paths: dict[int, str] = {}
        self._daemon: tuple[str, int] | None = None
        self._outside = self._open()
        self._inside = self._open()
        self._simulator = ("127.0.0.1", simulator_port)
        self._over = False

    @property
    def port(self) -> int:
        port: int = self._outside.getsockname()[1]
        return port

    @staticmethod
    def _open() -> socket.socket:
        opened = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        opened.bind(("127.0.0.1", 0))
        return opened

    def run(self) -> None:
        with selectors.DefaultSelector() as selector:
            selector.register(self._outside, selectors.EVENT_READ, self._inwards)
            selector.register(self._inside, selectors.EVENT_READ, self._outwards)
            selector.register(self._pipe, selectors.EVENT_READ, self._obey)
            while not self._over:
                for key, _ in selector.select(self._pass_on()):
                    # An ended program, at either end, is not an error of the link.
                    try:
                        key.data()
                    except ConnectionError:
                        continue

    def _obey(self) -> None:
        try:
            self._cut, self._says, datagram, self._held_s = self._pipe.recv()
            if datagram and self._daemon is not None:
                self._outside.sendto(datagram, self._daemon)
            self._pipe.send(None)
        except (EOFError, OSError):
            self._over = True

    def _inwards(self) -> None:
        datagram, self._daemon = self._outside.recvfrom(_LARGEST_DATAGRAM)
        if datagram.startswith(b"RREF"):
            _, index = _REQUEST.unpack_from(datagram, _TAG_BYTES)
            path = datagram[_TAG_BYTES + _REQUEST.size :].partition(b"\0")[0]
            self._paths[index] = path.decode()
        if not self._cut["to"]:
            self._inside.sendto(datagram, self._simulator)

    def _outwards(self) -> None:
        datagram = self._inside.recv(_LARGEST_DATAGRAM)
        if self._daemon is not None and not self._cut["from"]:
            self._waiting.append((time.monotonic(), self._tampered(datagram)))
            self._pass_on()

    def _pass_on(self) -> float | None:
        """Pass on what has waited for long enough; return until when the next one waits."""
        while self._waiting and self._daemon is not None:
            came_s, datagram = self._waiting[0]
            left_s = came_s + self._held_s - time.monotonic()
            if left_s > 0.0:
                return left_s
            self._waiting.popleft()
            self._outside.sendto(datagram, self._daemon)
        return None

    def _tampered(self, datagram: bytes) -> bytes:
        if not self._says or not datagram.startswith(b"RREF"):
            return datagram
        pairs = _PAIR.iter_unpack(datagram[_TAG_BYTES:])
        return datagram[:_TAG_BYTES] + b"".join(
            _PAIR.pack(index, self._says.get(self._paths.get(index, ""), value))
            for index, value in pairs
        )


def _serve(simulator_port: int, pipe: Connection) -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    link = _Link(simulator_port, pipe)
    request_real_time()
    pipe.send(link.port)
    link.run()


class TamperedLink:
    """Between a daemon and a stand-in; a context manager."""

    def __init__(self, simulator_port: int) -> None:
        context = multiprocessing.get_context("spawn")
        self._pipe, theirs = context.Pipe()
        self._process = context.Process(
            target=_serve, args=(simulator_port, theirs), name="tampered-link", daemon=True
        )
        self._process.start()
        theirs.close()
        self.port: int = self._answer()
        """The port for the daemon."""

    def __enter__(self) -> TamperedLink:
        return self

    def __exit__(self, *_: object) -> None:
        self._pipe.close()
        self._process.join(_STOP_S)
        if self._process.is_alive():
            self._process.kill()

    def cut(self, *, to_simulator: bool = False, from_simulator: bool = False) -> None:
        """Cut these directions, and restore the others."""
        self._command({"to": to_simulator, "from": from_simulator}, {})

    def replace_values(self, values: Mapping[str, float]) -> None:
        """Replace the values of these datarefs; nothing is cut."""
        self._command({"to": False, "from": False}, dict(values))

    def send(self, datagram: bytes) -> None:
        """Send the daemon a datagram as the simulator would, and cut and replace nothing."""
        self._command({"to": False, "from": False}, {}, datagram)

    def hold(self, seconds: float) -> None:
        """Deliver what the simulator sends so much later, in order; nothing is cut or replaced."""
        self._command({"to": False, "from": False}, {}, held_s=seconds)

    def restore(self) -> None:
        """Forward everything unchanged."""
        self.replace_values({})

    def _command(
        self,
        cut: dict[str, bool],
        says: dict[str, float],
        send: bytes = b"",
        held_s: float = 0.0,
    ) -> None:
        self._pipe.send((cut, says, send, held_s))
        self._answer()

    def _answer(self) -> int:
        assert self._pipe.poll(_START_S), "the link does not answer"
        answer: int = self._pipe.recv()
        return answer
