"""The reference servo board at work: on a pseudo-terminal, a serial line or a UDP port.

    board = RunningBoard(serial_link=Path("/tmp/ttyBOARD"))
    board.readings = Readings(airspeed_mps=30.0, engage_switch=True)
    board.drive(otherwise=Controls())

A thread runs it every 2 ms by its own clock. Its cable can be pulled out and put back, its bits
disturbed, and the board started again.
"""

from __future__ import annotations

import contextlib
import math
import os
import pty
import random
import socket
import threading
import time
import tty
from dataclasses import dataclass
from pathlib import Path

from .rig import FlightError
from .servo_board import Control, Decoder, Readings, ServoBoard, encode
from .state import Controls

_PASS_S = 0.002
_PRIORITY = 6
_LONGEST = 65_536


@dataclass(frozen=True)
class Change:
    """Control changed."""

    time_s: float
    """By the board's clock, `time.monotonic`."""
    control: Control
    driven: Controls
    """Where the servos go from now on; what nobody holds is centred here."""
    silent_s: float
    """How long nothing had been written."""
    silent_before_s: float
    """The same, in the pass before."""


def disturbed(data: bytes, bit_errors: float, rng: random.Random) -> bytes:
    """Return bytes of which each bit is wrong with this probability."""
    if bit_errors <= 0.0 or not data:
        return data
    received = bytearray(data)
    # The gap to the next wrong bit is geometrically distributed.
    at = -1
    while True:
        at += 1 + int(math.log(1.0 - rng.random()) / math.log1p(-bit_errors))
        if at >= 8 * len(received):
            return bytes(received)
        received[at // 8] ^= 1 << at % 8


def _is_terminal_link(path: Path) -> bool:
    """Return whether a path is a link to a pseudo-terminal, as of an earlier board."""
    return path.is_symlink() and str(path.readlink()).startswith("/dev/pts/")


class _Serial:
    """Frames on a pseudo-terminal, to which a symbolic link leads."""

    def __init__(self, link: Path, rng: random.Random) -> None:
        self._link = link
        self._rng = rng
        self._master = -1
        self.bit_errors = 0.0
        self.put_back()

    def put_back(self) -> None:
        if self._master < 0:
            if self._link.exists() and not _is_terminal_link(self._link):
                raise FlightError(
                    f"{self._link}: it is no link of a board: choose a name that is not taken"
                )
            master, slave = pty.openpty()
            tty.setraw(slave)
            os.set_blocking(master, False)
            fresh = self._link.with_name(f".{self._link.name}.{os.getpid()}")
            fresh.unlink(missing_ok=True)
            fresh.symlink_to(os.ttyname(slave))
            fresh.replace(self._link)
            os.close(slave)
            self._master = master
        self.start_again()

    def pull(self) -> None:
        if self._master >= 0:
            os.close(self._master)
        self._master = -1

    def start_again(self) -> None:
        self.decoder = Decoder()
        self._sequence = 0

    def receive(self) -> list[tuple[str, bytes]]:
        received = b""
        if self._master >= 0:
            # Nothing has arrived, or nobody has the other end open.
            with contextlib.suppress(OSError):
                received = os.read(self._master, _LONGEST)
        return [("line", message) for message in self.decoder.push(self._disturbed(received))]

    def send(self, message: bytes, _: object) -> None:
        frame = self._disturbed(encode(self._sequence, message))
        self._sequence = (self._sequence + 1) % 256
        if self._master >= 0:
            # What does not fit is lost, as on a line.
            with contextlib.suppress(OSError):
                os.write(self._master, frame)

    def close(self) -> None:
        self.pull()
        if self._link.is_symlink():
            self._link.unlink(missing_ok=True)

    def _disturbed(self, data: bytes) -> bytes:
        return disturbed(data, self.bit_errors, self._rng)


class _Udp:
    """Datagrams; what is out of range is lost."""

    def __init__(self) -> None:
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.bind(("127.0.0.1", 0))
        self._socket.setblocking(False)
        self._is_there = True
        self.bit_errors = 0.0
        """Without effect: UDP has a checksum of its own."""
        self.decoder = Decoder()

    @property
    def port(self) -> int:
        return int(self._socket.getsockname()[1])

    def put_back(self) -> None:
        self._is_there = True

    def pull(self) -> None:
        self._is_there = False

    def start_again(self) -> None:
        """Do nothing: a datagram needs no state."""

    def receive(self) -> list[tuple[object, bytes]]:
        received: list[tuple[object, bytes]] = []
        while True:
            try:
                message, sender = self._socket.recvfrom(_LONGEST)
            except BlockingIOError:
                return received
            except ConnectionError:
                continue
            if self._is_there:
                received.append((sender, message))

    def send(self, message: bytes, to: object) -> None:
        if self._is_there and isinstance(to, tuple):
            with contextlib.suppress(OSError):
                self._socket.sendto(message, to)

    def close(self) -> None:
        self._socket.close()


class RunningBoard:
    """A board that runs."""

    def __init__(self, serial_link: Path | None = None, seed: int = 1) -> None:
        """Start it: at a serial line, to which `serial_link` will lead, or at a UDP port."""
        self.readings = Readings()
        self.changes: list[Change] = []
        self._end: _Serial | _Udp = (
            _Udp() if serial_link is None else _Serial(serial_link, random.Random(seed))
        )
        self._lock = threading.Lock()
        self._board = ServoBoard()
        self._last = Control.FREE
        self._silent_s = 0.0
        self._runs = True
        self._thread = threading.Thread(target=self._run, name="servo-board", daemon=True)
        self._thread.start()

    @property
    def port(self) -> int:
        """Return the UDP port; 0 on a serial line."""
        return self._end.port if isinstance(self._end, _Udp) else 0

    def drive(self, otherwise: Controls) -> Controls:
        """Return where the servos go; what nobody holds goes where `otherwise` says."""
        with self._lock:
            return self._board.drive(otherwise)

    def counts(self) -> dict[str, int]:
        """Return how many frames were received, corrupt and lost."""
        decoder = self._end.decoder
        return {"received": decoder.received, "corrupt": decoder.corrupt, "lost": decoder.lost}

    def pull(self) -> None:
        """Pull the cable out, or fly out of range."""
        with self._lock:
            self._end.pull()

    def put_back(self) -> None:
        """Put the cable back."""
        with self._lock:
            self._end.put_back()

    def disturb(self, bit_errors: float) -> None:
        """Let each bit be wrong with this probability, in both directions."""
        with self._lock:
            self._end.bit_errors = bit_errors

    def reboot(self) -> None:
        """Start it again: it has forgotten everything."""
        with self._lock:
            self._board = ServoBoard()
            self._end.start_again()
            # Before what waits to be received, which may take control at once.
            self._note_change(time.monotonic())

    def close(self) -> None:
        """End it."""
        self._runs = False
        self._thread.join()
        self._end.close()

    def _run(self) -> None:
        # A microcontroller has nothing else to do: above the simulator, if that is granted.
        with contextlib.suppress(OSError):
            os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(_PRIORITY))
        while self._runs:
            with self._lock:
                now_s = time.monotonic()
                board = self._board
                for sender, message in self._end.receive():
                    board.receive(now_s, sender, message)
                reply = board.poll(now_s, self.readings)
                if reply is not None:
                    self._end.send(reply, board.peer)
                self._note_change(now_s)
            time.sleep(_PASS_S)

    def _note_change(self, now_s: float) -> None:
        board = self._board
        if board.control is not self._last:
            self._last = board.control
            driven = board.drive(Controls())
            change = Change(now_s, board.control, driven, board.silent_s, self._silent_s)
            self.changes.append(change)
        self._silent_s = board.silent_s
