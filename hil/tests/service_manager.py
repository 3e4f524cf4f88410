"""A stand-in for systemd: receives a service's notifications (sd_notify(3))."""

from __future__ import annotations

import contextlib
import socket
import tempfile
import time
from pathlib import Path

from daemon_under_test import PATIENCE_S


class ServiceManager:
    """Listens at a socket; a context manager that closes it."""

    def __init__(self) -> None:
        # A socket's path has to be short, which pytest's folders are not.
        self._folder = tempfile.TemporaryDirectory(prefix="fccd-")
        self.path = str(Path(self._folder.name) / "notify")
        self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        self._socket.bind(self.path)
        self.status = ""

    def __enter__(self) -> ServiceManager:
        return self

    def __exit__(self, *_: object) -> None:
        self._socket.close()
        self._folder.cleanup()

    def environment(self, watchdog_s: float) -> dict[str, str]:
        """Return the environment that systemd would set."""
        return {"NOTIFY_SOCKET": self.path, "WATCHDOG_USEC": f"{watchdog_s * 1e6:.0f}"}

    def has_received(self, word: str, within_s: float = PATIENCE_S) -> bool:
        """Return whether a line that begins with `word` arrives in time."""
        deadline_s = time.monotonic() + within_s
        while (left_s := deadline_s - time.monotonic()) > 0.0:
            lines = self._next(left_s)
            if any(line.startswith(word) for line in lines):
                return True
        return False

    def forget(self) -> None:
        """Discard all received notifications."""
        while self._next(0.0):
            pass

    def _next(self, within_s: float) -> list[str]:
        self._socket.settimeout(within_s)
        with contextlib.suppress(TimeoutError, BlockingIOError):
            lines = self._socket.recv(4096).decode().splitlines()
            for line in lines:
                if line.startswith("STATUS="):
                    self.status = line.removeprefix("STATUS=")
            return lines
        return []
