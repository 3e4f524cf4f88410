"""Output that cannot be written: ended readers, full disks, closed terminals."""

from __future__ import annotations

import contextlib
import fcntl
import os
import pty
import signal
import subprocess
import termios
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from daemon_under_test import Ending, wait_until
from fault_flights import ENGAGED, FAILSAFE, Flown, assert_regular, at_once

SUCCESS = 0
FAILURE = 1
RATE_HZ = 1_000
ENGAGE_AT_S = 1.5
RING_TICKS = 4_096
"""The ring's capacity: a main thread that waited would lose the rest."""
FLOWN_S = 2.0 * RING_TICKS / RATE_HZ
PATIENCE_S = 60.0

CONFIG = f"""
[built-in]
engage_at_s = {ENGAGE_AT_S}
[guidance]
mode = "hold"
[loop]
rate_hz = {RATE_HZ}
[telemetry]
enabled = false
"""


class Output:
    """Both outputs of a daemon, and our end of them."""

    def __init__(self, ours: int, theirs: int) -> None:
        self.ours, self.theirs = ours, theirs
        os.set_blocking(ours, False)
        self._heard = b""

    def hear(self) -> bytes:
        with contextlib.suppress(BlockingIOError):
            self._heard += os.read(self.ours, 65_536)
        return self._heard

    def leave(self) -> None:
        os.close(self.ours)


def fly(
    fccd: Path,
    scratch: Path,
    theirs: int,
    seconds: float,
    prepare: Callable[[], object] | None = None,
) -> subprocess.Popen[bytes]:
    """Start a flight of the built-in aircraft that prints into `theirs`."""
    scratch.mkdir()
    config = scratch / "fccd.toml"
    config.write_text(CONFIG)
    words = [fccd, "fly", "--config", config, "--recordings", scratch / "recordings"]
    return subprocess.Popen(
        [*map(str, words), "--seconds", str(seconds)],
        stdin=subprocess.DEVNULL,
        stdout=theirs,
        stderr=theirs,
        preexec_fn=prepare,  # noqa: PLW1509
    )


@contextlib.contextmanager
def flying(process: subprocess.Popen[bytes]) -> Iterator[subprocess.Popen[bytes]]:
    try:
        yield process
    finally:
        if process.poll() is None:
            process.kill()
            process.wait()


def ended(process: subprocess.Popen[bytes], scratch: Path) -> Flown:
    code = process.wait(PATIENCE_S)
    return Flown.of(Ending(code, {}, ""), scratch / "recordings")


def unwritable(
    fccd: Path, scratch: Path, output: Output, spoil: Callable[[Output], object]
) -> Flown:
    """Fly, and let the output fail once engaged."""
    with flying(fly(fccd, scratch, output.theirs, FLOWN_S)) as process:
        os.close(output.theirs)
        wait_until(lambda: b"standby -> engaged" in output.hear(), "it is engaged")
        spoil(output)
        return ended(process, scratch)


def a_full_disk(fccd: Path, scratch: Path) -> Flown:
    full = os.open("/dev/full", os.O_WRONLY)
    with flying(fly(fccd, scratch, full, FLOWN_S)) as process:
        os.close(full)
        return ended(process, scratch)


def a_held_terminal(fccd: Path, scratch: Path) -> Flown:
    """Fly with a full output that is not read, so that printing blocks."""
    ours, theirs = os.pipe()
    fcntl.fcntl(theirs, fcntl.F_SETPIPE_SZ, 4_096)
    output = Output(ours, theirs)
    with flying(fly(fccd, scratch, theirs, FLOWN_S)) as process:
        wait_until(lambda: b"standby -> engaged" in output.hear(), "it is engaged")
        # Opened anew: this end must not wait, and the daemon's must.
        filling = os.open(f"/proc/self/fd/{theirs}", os.O_WRONLY | os.O_NONBLOCK)
        with contextlib.suppress(BlockingIOError):
            while True:
                os.write(filling, b".")
        os.close(filling)
        os.close(theirs)
        # Until the flight has ended; then the output is read, and the program can end.
        time.sleep(FLOWN_S)

        def is_over() -> bool:
            output.hear()
            return process.poll() is not None

        wait_until(is_over, "it ends once it is heard", 30.0)
        return ended(process, scratch)


def _terminal_of_its_own() -> None:
    os.setsid()
    fcntl.ioctl(1, termios.TIOCSCTTY, 0)


def _as_by_nohup() -> None:
    """As nohup does, except for the output, which it would redirect to a file."""
    _terminal_of_its_own()
    signal.signal(signal.SIGHUP, signal.SIG_IGN)


def a_terminal_that_hangs_up(
    fccd: Path, scratch: Path, seconds: float, prepare: Callable[[], object]
) -> Flown:
    """Cut the line: the kernel sends SIGHUP, too."""
    output = Output(*pty.openpty())
    process = fly(fccd, scratch, output.theirs, seconds, prepare)
    with flying(process):
        os.close(output.theirs)
        wait_until(lambda: b"standby -> engaged" in output.hear(), "it is engaged")
        output.leave()
        return ended(process, scratch)


@pytest.fixture(scope="module")
def flights(fccd: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Flown]:
    """All flights, side by side."""
    scratch = tmp_path_factory.mktemp("output")
    return at_once(
        {
            "a reader that leaves": lambda: unwritable(
                fccd, scratch / "reader", Output(*os.pipe()), Output.leave
            ),
            "a terminal that is gone": lambda: unwritable(
                fccd, scratch / "gone", Output(*pty.openpty()), Output.leave
            ),
            "a full disk": lambda: a_full_disk(fccd, scratch / "full"),
            "a held terminal": lambda: a_held_terminal(fccd, scratch / "held"),
            "hung up under nohup": lambda: a_terminal_that_hangs_up(
                fccd, scratch / "nohup", FLOWN_S, _as_by_nohup
            ),
            "hung up": lambda: a_terminal_that_hangs_up(
                fccd, scratch / "up", 3_600.0, _terminal_of_its_own
            ),
        }
    )


def assert_whole(flown: Flown) -> None:
    assert_regular(flown.records, 1_000_000_000 // RATE_HZ)
    assert flown.records[-1].records_dropped == 0
    assert all(record.state.phase != FAILSAFE for record in flown.records)
    assert any("released" in event.kind.WhichOneof("kind") for event in flown.events)


@pytest.mark.parametrize(
    "name",
    [
        "a reader that leaves",
        "a terminal that is gone",
        "a full disk",
        "a held terminal",
        "hung up under nohup",
    ],
)
def test_output_that_cannot_be_written_has_no_effect_on_the_flight(
    flights: dict[str, Flown], name: str
) -> None:
    flown = flights[name]
    assert_whole(flown)
    # Its result could not be printed.
    assert flown.ending.exit_code == (FAILURE if name == "a full disk" else SUCCESS)
    engaged = [record for record in flown.records if record.state.phase == ENGAGED]
    # Missed ticks have no record.
    missed = sum(record.tick.missed for record in engaged)
    assert len(engaged) + missed >= FLOWN_S * RATE_HZ


def test_a_terminal_that_hangs_up_ends_the_flight_properly(
    flights: dict[str, Flown],
) -> None:
    assert_whole(flights["hung up"])
    assert flights["hung up"].ending.exit_code == SUCCESS
