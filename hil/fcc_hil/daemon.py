"""The flight control computer under test, as a subprocess: start, stop, read its report."""

from __future__ import annotations

import contextlib
import json
import signal
import subprocess
import tempfile
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from .rig import FlightError

_STOP_S = 5.0
_LOOK_S = 0.05


class DaemonError(RuntimeError):
    """The daemon could not be started."""


def command(fccd: Path, config: Path | None) -> list[str]:
    """Return the command line that runs the daemon against a simulator with a report in JSON."""
    words = [str(fccd), "run"]
    if config is not None:
        words += ["--config", str(config)]
    return [*words, "--json"]


class Daemon:
    """A running daemon; a context manager that ends it."""

    def __init__(self, words: Sequence[str], log_to: Path | None = None) -> None:
        """Start it. Its messages (stderr) go to a file, or to our stderr."""
        self._log_to = log_to
        # A file, not a pipe: it never blocks, and nothing has to read it meanwhile.
        self._output = tempfile.TemporaryFile()  # noqa: SIM115 - closed in __exit__
        try:
            with contextlib.ExitStack() as stack:
                log = None if log_to is None else stack.enter_context(log_to.open("wb"))
                self._process = subprocess.Popen(
                    list(words), stdout=self._output, stderr=log, stdin=subprocess.DEVNULL
                )
        except OSError as error:
            self._output.close()
            raise DaemonError(
                f"cannot start {words[0]}: {error.strerror}; build it with `cargo build --release` "
                "or give its path with --fccd"
            ) from error

    def __enter__(self) -> Daemon:
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()
        self._output.close()

    @property
    def exit_code(self) -> int | None:
        """Return its exit code, negative for a signal, or None while it runs."""
        return self._process.poll()

    def require_running(self) -> None:
        """Raise FlightError if it has ended."""
        if self.exit_code is not None:
            raise FlightError(self._with_log(f"the daemon ended with exit code {self.exit_code}"))

    def wait_until(self, arrived: Callable[[], bool], within_s: float, otherwise: str) -> None:
        """Wait until something has arrived; raise FlightError if it ends, or it is too late."""
        deadline_s = time.monotonic() + within_s
        while not arrived():
            self.require_running()
            if time.monotonic() > deadline_s:
                raise FlightError(self._with_log(f"{otherwise} within {within_s:.0f} s"))
            time.sleep(_LOOK_S)

    def _with_log(self, words: str) -> str:
        return f"{words}; its messages: {self.log}" if self.log else words

    @property
    def pid(self) -> int:
        """Return its process id."""
        return self._process.pid

    @property
    def log(self) -> str:
        """Return its messages so far, if they go to a file."""
        return "" if self._log_to is None else self._log_to.read_text("utf-8", "replace")

    def stop(self, by: signal.Signals = signal.SIGTERM) -> int:
        """Send a signal and wait; after 5 s kill it. Return its exit code."""
        if self._process.poll() is None:
            self._process.send_signal(by)
            try:
                self._process.wait(_STOP_S)
            except subprocess.TimeoutExpired:
                self._process.kill()
                self._process.wait()
        return self._process.returncode

    def report(self) -> dict[str, Any] | None:
        """Return the JSON object on its standard output: all of it, or the last line with one.

        None if there is none.
        """
        self._output.seek(0)
        text = self._output.read().decode("utf-8", "replace")
        for candidate in (text, *reversed(text.splitlines())):
            try:
                found = json.loads(candidate)
            except ValueError:
                continue
            if isinstance(found, dict):
                return found
        return None
