"""`fccd run` on this machine, against the stand-in, in real time."""

from __future__ import annotations

import contextlib
import math
import os
import re
import signal
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from .daemon import Daemon, DaemonError
from .process import StandInError, StandInProcess
from .rig import Event, FlightError
from .standin import Progress, Settings
from .standin_rig import StandInRig

_READY_S = 30.0
_LOOK_S = 0.05

_LINE = re.compile(r"^ *(?P<time_s>\d+\.\d+) s  (?P<text>.+)$")
_STATUS = re.compile(r"^\S+(?: \S+)* +(?:hdg +\d|no measurements yet)")
_NOT_READY = "not ready"


class DaemonRig(StandInRig):
    """A daemon and its stand-in."""

    def __init__(self, fccd: Path, settings: Settings, configuration: str, scratch: Path) -> None:
        """Start both, the daemon with these sections of a configuration.

        Raise FlightError if one cannot be started.
        """
        try:
            simulator = StandInProcess(replace(settings, port=0))
        except StandInError as error:
            raise FlightError(f"the stand-in does not start: {error}") from error
        with contextlib.ExitStack() as undo:
            undo.callback(simulator.stop)
            super().__init__(simulator, f"{settings.aircraft} in real time")
            config = scratch / "fccd.toml"
            self._recordings = scratch / "recordings"
            config.write_text(
                f'[x-plane]\nsimulator = "127.0.0.1:{simulator.port}"\n'
                f"engines = {simulator.status()['engines']}\n"
                f'[recording]\nfolder = "{self._recordings}"\n'
                f'[telemetry]\ninstance = "fccd-test-{os.getpid()}-{simulator.port}"\n'
                f"{configuration}"
            )
            words = [str(fccd), "run", "--config", str(config), "--json"]
            try:
                self.daemon = Daemon(words, scratch / "fccd.err")
            except DaemonError as error:
                raise FlightError(str(error)) from error
            undo.pop_all()
        self._heard = 0
        # Simulated time minus the daemon's: the message received soonest gives the best value.
        self._offset_s = math.inf
        self._is_ready = False

    def prepare(self) -> None:
        """Wait until the daemon sees the aircraft and can engage."""
        give_up_s = time.monotonic() + _READY_S
        while not self._is_ready:
            self._look()
            if time.monotonic() > give_up_s:
                raise FlightError(f"the daemon is not ready to engage; its messages:\n{self.log}")
            time.sleep(_LOOK_S)

    @property
    def log(self) -> str:
        """Return all messages of the daemon."""
        return self.daemon.log

    def save_recording(self, path: Path) -> list[Path]:
        """End the daemon and move its recording to a path, with further parts beside it."""
        self.truth()
        self.set_faults([])
        self.daemon.stop()
        parts = sorted(self._recordings.glob("*.mcap"))
        left = []
        for number, part in enumerate(parts, start=1):
            to = path if number == 1 else path.with_stem(f"{path.stem}-{number}")
            # The temporary folder may be on another file system.
            to.write_bytes(part.read_bytes())
            left.append(to)
        return left

    def close(self) -> None:
        """End the daemon, then the stand-in, which must first see the controls released."""
        if not self._is_closed:
            # A daemon that receives nothing waits long for the release to be confirmed.
            with contextlib.suppress(StandInError):
                self.set_faults([])
        self.daemon.__exit__()
        super().close()

    def _look(self) -> Progress:
        lines = list(self._lines())
        progress = super()._look()
        for time_s, text in lines:
            self._offset_s = min(self._offset_s, progress.time_s - time_s)
            if _STATUS.match(text):
                self._is_ready = text.startswith("standby   hdg") and _NOT_READY not in text
            else:
                at_s = min(progress.time_s, time_s + self._offset_s)
                self.events.append(Event(at_s, text))
        exit_code = self.daemon.exit_code
        if exit_code is not None and not self._is_closed:
            name = f" ({signal.Signals(-exit_code).name})" if exit_code < 0 else ""
            raise FlightError(f"the daemon ended with {exit_code}{name}; its messages:\n{self.log}")
        return progress

    def _lines(self) -> Iterator[tuple[float, str]]:
        """Yield the new complete lines of the daemon that have a time."""
        log = self.log
        for line in log[self._heard :].splitlines(keepends=True):
            if not line.endswith("\n"):
                return
            self._heard += len(line)
            found = _LINE.match(line.rstrip())
            if found is not None:
                yield float(found["time_s"]), found["text"]
