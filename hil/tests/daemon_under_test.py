"""The real daemon and a stand-in: start both, wait for messages, read the report.

    with flight(fccd, tmp_path) as (simulator, daemon):
        engage(simulator, daemon)
        simulator.set_mode(Mode.FROZEN)
        daemon.wait_for("engaged -> failsafe")
        ending = daemon.end(signal.SIGTERM)

All waits have limits far beyond a healthy machine's times, so that a busy machine makes a test slow
and not wrong.
"""

from __future__ import annotations

import contextlib
import json
import os
import signal
import subprocess
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from fcc_hil.cockpit import OVERRIDE_JOYSTICK, OVERRIDE_THROTTLES, YOKE_PITCH
from fcc_hil.fly import ENGAGE_SWITCH
from fcc_hil.process import StandInProcess
from fcc_hil.standin import Settings

PATIENCE_S = 15.0
_LOOK_S = 0.02
_ATTEMPTS = 5

NOT_READY = "not ready"
"""In a status line: followed by the engage inhibits."""


@dataclass(frozen=True)
class Ending:
    """The end of a daemon."""

    exit_code: int
    """Negative for a signal."""
    report: dict[str, Any]
    """Its JSON; empty if it printed none."""
    log: str
    """All of its messages."""

    @property
    def events(self) -> list[str]:
        return [event["text"] for event in self.report["events"]]

    def when(self, text: str) -> float:
        """Return the time of the first event with this text, in s since the loop's first tick."""
        return next(
            float(event["time_s"]) for event in self.report["events"] if text in event["text"]
        )

    @property
    def states(self) -> list[str]:
        """Return the changes of state, without their reasons."""
        return [text.partition(":")[0] for text in self.events if " -> " in text]


def children_of(pid: int) -> list[int]:
    """Return the process numbers of the programs that a process started, from any thread."""
    children: list[int] = []
    for task in Path(f"/proc/{pid}/task").iterdir():
        # A thread may end meanwhile.
        with contextlib.suppress(FileNotFoundError, ProcessLookupError):
            children += [int(child) for child in (task / "children").read_text().split()]
    return children


def helpers_of(pid: int, command: str = "release-helper") -> list[int]:
    """Return the process numbers of a daemon's helpers that run this command."""

    def runs_it(child: int) -> bool:
        try:
            return command.encode() in Path(f"/proc/{child}/cmdline").read_bytes().split(b"\0")
        except OSError:
            return False

    return [child for child in children_of(pid) if runs_it(child)]


class DaemonUnderTest:
    """A running `fccd`. Its output goes to files, so that it never waits for a reader."""

    def __init__(
        self,
        words: Sequence[str | Path],
        scratch: Path,
        environment: Mapping[str, str] | None = None,
        stdout: int | None = None,
    ) -> None:
        self._out = scratch / "fccd.out"
        self._err = scratch / "fccd.err"
        self._read_to = 0
        with self._out.open("wb") as out, self._err.open("wb") as err:
            self._process = subprocess.Popen(
                [str(word) for word in words],
                stdin=subprocess.DEVNULL,
                stdout=out if stdout is None else stdout,
                stderr=err,
                env={**os.environ, **(environment or {})},
            )
        self.pid = self._process.pid

    def __enter__(self) -> DaemonUnderTest:
        return self

    def __exit__(self, *_: object) -> None:
        if self._process.poll() is None:
            self._process.kill()
            self._process.wait()

    @property
    def is_running(self) -> bool:
        return self._process.poll() is None

    def children(self) -> list[int]:
        """Return the process numbers of the programs that it started, from any thread."""
        return children_of(self.pid)

    def helpers(self, command: str = "release-helper") -> list[int]:
        """Return the process numbers of its helpers that run this command."""
        return helpers_of(self.pid, command)

    @property
    def log(self) -> str:
        """Return its messages so far; the last character may be there in part."""
        return self._err.read_text(errors="replace")

    def wait_for(self, text: str, within_s: float = PATIENCE_S) -> str:
        """Wait for a line with `text`, after the last one waited for, and return it."""
        deadline_s = time.monotonic() + within_s
        while True:
            # It may print its last messages between our reading and its end.
            running = self.is_running
            whole = self.log
            for line in whole[self._read_to :].splitlines(keepends=True):
                if not line.endswith("\n"):
                    break
                self._read_to += len(line)
                if text in line:
                    return line.rstrip()
            assert running, f"it ended without '{text}':\n{whole}"
            assert time.monotonic() < deadline_s, f"no '{text}' in:\n{whole}"
            time.sleep(_LOOK_S)

    def wait_until_ready(self) -> None:
        """Wait for a status line with an aircraft and without engage inhibits."""
        while NOT_READY in self.wait_for("standby   hdg"):
            pass

    def next_state(self, within_s: float = PATIENCE_S) -> str:
        """Return the state that the next status line shows. Engaged, it has set points."""
        line = self.wait_for("  hdg ", within_s)
        return "engaged" if "→" in line else line.split()[2]

    def send(self, number: signal.Signals) -> None:
        """Send a signal to the daemon alone."""
        self._process.send_signal(number)

    def end(self, by: signal.Signals | None = None, within_s: float = PATIENCE_S) -> Ending:
        """Wait for its end, `by` a signal or by itself."""
        if by is not None:
            self.send(by)
        try:
            exit_code = self._process.wait(within_s)
        except subprocess.TimeoutExpired:
            raise AssertionError(f"it does not end; its messages:\n{self.log}") from None
        printed = self._out.read_text()
        return Ending(exit_code, json.loads(printed) if printed else {}, self.log)


def wait_until(
    holds: Callable[[], bool],
    what: str,
    within_s: float = PATIENCE_S,
    *,
    daemons: Sequence[DaemonUnderTest] = (),
) -> None:
    """Wait until a condition is met; `what` describes it, and the daemons' messages why not."""
    deadline_s = time.monotonic() + within_s
    while not holds():
        if time.monotonic() >= deadline_s:
            logs = "\n".join(daemon.log for daemon in daemons)
            raise AssertionError(f"not within {within_s:.0f} s: {what}\n{logs}")
        time.sleep(_LOOK_S)


def open_files(pid: int) -> set[str]:
    """Return what a process has open."""
    files = set()
    for descriptor in Path(f"/proc/{pid}/fd").iterdir():
        # It may close it meanwhile.
        with contextlib.suppress(FileNotFoundError):
            files.add(str(descriptor.readlink()))
    return files


def write_config(
    scratch: Path,
    port: int,
    x_plane: str = "",
    others: str = "",
    guidance: str = 'mode = "hold"',
) -> Path:
    """Write a configuration for the stand-in at `port`, with more lines and sections."""
    path = scratch / "fccd.toml"
    path.write_text(
        f'[x-plane]\nsimulator = "127.0.0.1:{port}"\n{x_plane}\n[guidance]\n{guidance}\n'
        f'[recording]\nfolder = "{scratch}/recordings"\n{others}\n'
    )
    return path


def start(
    fccd: Path, scratch: Path, config: Path, environment: Mapping[str, str] | None = None
) -> DaemonUnderTest:
    """Start `fccd run`, as a user does."""
    return DaemonUnderTest([fccd, "run", "--config", config, "--json"], scratch, environment)


@contextlib.contextmanager
def flight(
    fccd: Path,
    scratch: Path,
    settings: Settings | None = None,
    x_plane: str = "",
    others: str = "",
    environment: Mapping[str, str] | None = None,
) -> Iterator[tuple[StandInProcess, DaemonUnderTest]]:
    """Start a stand-in on a free port, and the daemon connected to it."""
    with StandInProcess(settings or Settings(port=0)) as simulator:
        config = write_config(scratch, simulator.port, x_plane, others)
        with start(fccd, scratch, config, environment) as daemon:
            yield simulator, daemon


def switch_on(simulator: StandInProcess, daemon: DaemonUnderTest) -> None:
    """Move the switch inside the simulator, and wait until the daemon is engaged."""
    for _ in range(_ATTEMPTS):
        daemon.wait_until_ready()
        simulator.write(ENGAGE_SWITCH, 1.0)
        if "not engaged" not in daemon.wait_for("engaged"):
            return
        # On a busy machine it was ready no more when the switch arrived.
        simulator.write(ENGAGE_SWITCH, 0.0)
    raise AssertionError(f"not engaged in {_ATTEMPTS} attempts:\n{daemon.log}")


def engage(simulator: StandInProcess, daemon: DaemonUnderTest) -> None:
    """Engage by the switch, and wait until the daemon has the controls."""
    switch_on(simulator, daemon)
    wait_until(lambda: simulator.read(OVERRIDE_JOYSTICK) == 1.0, "the joystick's override is set")
    wait_until(lambda: simulator.read(OVERRIDE_THROTTLES) == 1.0, "the throttles' override is set")


def assert_released(simulator: StandInProcess) -> None:
    """Both overrides are off, and the surfaces, deflected in flight, were centred before."""
    wait_until(lambda: not simulator.progress().overridden, "the overrides are released")
    releases = simulator.releases()
    assert {release.path for release in releases} == {OVERRIDE_JOYSTICK, OVERRIDE_THROTTLES}
    elevator = [write.value for write in simulator.journal() if write.path == YOKE_PITCH]
    assert any(value != 0.0 for value in elevator)
    joystick = next(release for release in releases if release.path == OVERRIDE_JOYSTICK)
    assert (joystick.elevator, joystick.aileron, joystick.rudder) == (0.0, 0.0, 0.0)
