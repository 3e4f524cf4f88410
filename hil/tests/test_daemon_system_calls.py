"""The loop's system calls in flight: its timer, its socket, its page faults.

The daemon runs under `strace`, engaged with the stand-in. Every system call between the first and
the last wake-up of the loop's thread is checked: an allocation that grows the heap, a lock that
waits, a log line or a file would appear.
"""

from __future__ import annotations

import collections
import contextlib
import itertools
import os
import re
import shutil
import signal
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

import pytest
from daemon_under_test import DaemonUnderTest, engage, wait_until, write_config

from fcc_hil.process import StandInProcess
from fcc_hil.standin import Settings

LOOP_THREAD = "fcc-loop"
# Under the tracer a tick takes 1 to 2 ms on a busy machine.
RATE_HZ = 200

_CALL = re.compile(r"(\w+)\((.*)")
_START_S = 30.0
# Ticks whose mark is cut in two by the end of what was read so far.
_MARGIN = 100
# Tracing may slow the loop down many times on a busy machine.
_TRACE_S = 300.0


@dataclass(frozen=True)
class Clock:
    """How a timer waits, as the kernel sees it."""

    name: str
    waits_by: str
    """The call that returns at each tick."""
    waits_on: str
    """In that call's arguments."""

    moves_by: str = ""
    """The call that sets the timer anew, when the early wake's margin is another."""


COUNTS_PAGE_FAULTS = "getrusage"
"""Once a tick, after its last write."""
TELLS_OF_CONTROL = frozenset({"pwrite64", "write"})
"""Once when control is taken, before the first write to the plant: to the plant's file, and to the
release helper through a pipe that never waits."""
# The early wake's margin is looked at once in so many ticks.
REVIEW_TICKS = 32

TIMERFD = Clock("timerfd", "read", "[timerfd]", moves_by="timerfd_settime")
POSIX = Clock(
    "posix",
    "rt_sigtimedwait",
    "SI_TIMER",
    moves_by="timer_settime",
)
NANOSLEEP = Clock("nanosleep", "clock_nanosleep", "TIMER_ABSTIME")


@pytest.mark.parametrize(
    ("clock", "ticks"),
    [(TIMERFD, 10_000), (POSIX, 1_000), (NANOSLEEP, 1_000)],
    ids=lambda value: getattr(value, "name", None),
)
def test_only_the_timers_and_the_sockets_calls(
    fccd: Path, tmp_path: Path, clock: Clock, ticks: int
) -> None:
    late = "[loop.early_wake]\nenabled = false\n"
    calls = between_ticks(traced_flight(fccd, tmp_path, clock, ticks, late), clock)
    counts = collections.Counter(name for name, _ in calls)
    # On machines where it is no system call at all, it does not show.
    counts.pop("clock_gettime", 0)
    allowed = {clock.waits_by, "recvfrom", "sendto", COUNTS_PAGE_FAULTS}
    assert [counts.pop(name) for name in TELLS_OF_CONTROL] == [1, 1]
    assert set(counts) == allowed

    flown = counts[COUNTS_PAGE_FAULTS]
    assert flown >= ticks
    # At most once a tick: one that took longer than its period, as the tracer makes some, is
    # followed by the next at once.
    assert counts[clock.waits_by] <= 1.01 * flown
    assert all(clock.waits_on in words for name, words in calls if name == clock.waits_by)
    # Nothing of the tick is left to do when page faults are counted.
    following = [after for (name, _), (after, _) in itertools.pairwise(calls) if is_count(name)]
    assert clock.waits_by in following
    assert set(following) <= {clock.waits_by, "recvfrom", "clock_gettime"}
    # Each tick reads until there is nothing left, and writes all controls, the trim among them, at
    # one go once engaged (one by one where the kernel cannot cut them apart). X-Plane takes 60
    # datagrams in a frame of 50 ms: five every 4.2 ms, and a tick that would be earlier writes
    # nothing. Here the tracer makes ticks uneven and frames longer.
    emptied = [words for name, words in calls if name == "recvfrom" and "EAGAIN" in words]
    assert len(emptied) == flown
    taken = max(at for at, (name, _) in enumerate(calls) if name in TELLS_OF_CONTROL)
    controlled = collections.Counter(name for name, _ in calls[taken:])
    assert 2 * controlled["sendto"] >= controlled[COUNTS_PAGE_FAULTS] >= ticks / 2
    sockets = {words.partition(",")[0] for name, words in calls if name in ("recvfrom", "sendto")}
    assert len(sockets) == 1


@pytest.mark.parametrize("clock", [TIMERFD, POSIX, NANOSLEEP], ids=lambda clock: clock.name)
def test_waking_early_adds_only_the_warm_up(fccd: Path, tmp_path: Path, clock: Clock) -> None:
    early = "[loop.early_wake]\nenabled = true\n"
    calls = between_ticks(traced_flight(fccd, tmp_path, clock, 1_000, early), clock)
    counts = collections.Counter(name for name, _ in calls)
    counts.pop("clock_gettime", 0)
    moved = counts.pop(clock.moves_by, 0)
    assert [counts.pop(name) for name in TELLS_OF_CONTROL] == [1, 1]
    assert set(counts) == {clock.waits_by, "recvfrom", "sendto", COUNTS_PAGE_FAULTS}
    assert moved <= counts[COUNTS_PAGE_FAULTS] / REVIEW_TICKS + 1
    # The simulator's socket, and the one on which a warm-up sends to itself.
    sockets = {words.partition(",")[0] for name, words in calls if name in ("recvfrom", "sendto")}
    assert len(sockets) <= 2
    # The margin is moved between ticks, too.
    following = {after for (name, _), (after, _) in itertools.pairwise(calls) if is_count(name)}
    # A tick that took longer than its period is followed by the next at once.
    assert following <= {clock.waits_by, clock.moves_by, "recvfrom", "clock_gettime"}


def is_count(name: str) -> bool:
    return name == COUNTS_PAGE_FAULTS


def traced_flight(
    fccd: Path, scratch: Path, clock: Clock, ticks: int, more: str = ""
) -> list[tuple[str, str]]:
    """Fly until the loop has ticked so often while engaged; return its thread's calls."""
    strace = shutil.which("strace")
    assert strace, "strace is missing: `apt-get install strace`"
    trace = scratch / "trace"
    tracer: list[str | Path] = [strace, "-ff", "-y", "-s", "0", "-o", trace]
    with StandInProcess(Settings(port=0)) as simulator:
        # The tracer takes longer than a period.
        overload = "[overload]\nskip_after_ms = 0\nstop_after_s = 0.0\n"
        loop = f'[loop]\nrate_hz = {RATE_HZ}\ntimer = "{clock.name}"\n{more}{overload}'
        config = write_config(scratch, simulator.port, others=loop)
        words = [*tracer, fccd, "run", "--config", config, "--json"]
        with DaemonUnderTest(words, scratch) as traced:
            wait_until(
                lambda: loop_thread(traced.pid) is not None or not traced.is_running,
                f"a thread named {LOOP_THREAD} under strace",
                _START_S,
            )
            found = loop_thread(traced.pid)
            assert found, f"no thread to trace: {traced.log}"
            daemon, thread = found
            path = Path(f"{trace}.{thread}")
            try:
                engage(simulator, traced)
                with path.open("rb") as so_far:
                    so_far.seek(0, os.SEEK_END)
                    wakes = WakeCounter(so_far, clock)
                    wait_until(lambda: wakes.count() >= ticks + _MARGIN, f"{ticks} ticks", _TRACE_S)
                os.kill(daemon, signal.SIGTERM)
                ending = traced.end()
            finally:
                # If only strace were killed, the daemon would continue.
                if traced.is_running:
                    os.kill(daemon, signal.SIGKILL)
    assert ending.exit_code == 0, ending.log
    assert ending.states == ["standby -> engaged", "engaged -> stopped"]
    return [
        (call[1], call[2]) for line in path.read_text().splitlines() if (call := _CALL.match(line))
    ]


class WakeCounter:
    """Counts the wake-ups in a trace that is still being written."""

    def __init__(self, trace: BinaryIO, clock: Clock) -> None:
        self._trace = trace
        self._mark = f"{clock.waits_by}(".encode()
        self._counted = 0

    def count(self) -> int:
        self._counted += self._trace.read().count(self._mark)
        return self._counted


def loop_thread(tracer: int) -> tuple[int, int] | None:
    """Return process and thread of the loop that `tracer` traces, if it runs yet."""
    for status in Path("/proc").glob("[0-9]*/task/[0-9]*/status"):
        # Processes start and end meanwhile.
        with contextlib.suppress(OSError):
            fields = dict(
                line.split(":\t", 1) for line in status.read_text().splitlines() if ":\t" in line
            )
            if fields["Name"] == LOOP_THREAD and fields["TracerPid"] == str(tracer):
                return int(fields["Tgid"]), int(fields["Pid"])
    return None


def between_ticks(calls: list[tuple[str, str]], clock: Clock) -> list[tuple[str, str]]:
    """Return the calls from the first wake-up on to right before the last."""
    wakes = [
        place
        for place, (name, words) in enumerate(calls)
        if name == clock.waits_by and clock.waits_on in words
    ]
    return calls[wakes[0] : wakes[-1]]
