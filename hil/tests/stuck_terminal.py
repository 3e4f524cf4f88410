"""A terminal that is held: what is said into it waits, and who says it, too."""

from __future__ import annotations

import contextlib
import fcntl
import os
import signal
import subprocess
from collections.abc import Mapping
from pathlib import Path

from daemon_under_test import wait_until


class StuckTerminal:
    """A daemon whose words go into a pipe that is full, as on a terminal that is held."""

    def __init__(
        self,
        fccd: Path,
        scratch: Path,
        config: str,
        environment: Mapping[str, str] | None = None,
    ) -> None:
        scratch.mkdir()
        path = scratch / "fccd.toml"
        path.write_text(f'[built-in]\nengage_at_s = 1.5\n[guidance]\nmode = "hold"\n{config}')
        self.recordings = scratch / "recordings"
        words = [fccd, "fly", "--config", path, "--recordings", self.recordings]
        # A pipe with a name, so that the daemon's end is another than ours: ours
        # must not wait, and the daemon's must.
        terminal = scratch / "terminal"
        os.mkfifo(terminal)
        self._read = os.open(terminal, os.O_RDONLY | os.O_NONBLOCK)
        self._write = os.open(terminal, os.O_WRONLY | os.O_NONBLOCK)
        fcntl.fcntl(self._write, fcntl.F_SETPIPE_SZ, 4_096)
        with terminal.open("wb") as theirs:
            self._process = subprocess.Popen(
                [*map(str, words), "--seconds", "3600", "--json"],
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=theirs,
                env={**os.environ, **(environment or {})},
            )
        self._said = b""

    def hear(self) -> bytes:
        with contextlib.suppress(BlockingIOError):
            self._said += os.read(self._read, 65_536)
        return self._said

    def hold(self) -> None:
        """Fill the pipe up: the next word of the daemon waits."""
        with contextlib.suppress(BlockingIOError):
            while True:
                os.write(self._write, b".")

    def ends_by_itself(self) -> int:
        """Wait for its end while nobody hears it; return its exit code."""
        wait_until(lambda: self._process.poll() is not None, "it ends unheard", 60.0)
        self._close()
        return self._process.returncode

    def end(self) -> int:
        self._process.send_signal(signal.SIGTERM)

        def is_over() -> bool:
            self.hear()
            return self._process.poll() is not None

        wait_until(is_over, "it ends once it is heard")
        self._close()
        return self._process.returncode

    def _close(self) -> None:
        os.close(self._read)
        os.close(self._write)

    def __enter__(self) -> StuckTerminal:
        return self

    def __exit__(self, *_: object) -> None:
        if self._process.poll() is None:
            self._process.kill()
            self._process.wait()
