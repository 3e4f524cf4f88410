"""A long flight under stress, with the machine's own delays measured at the same time.

The daemon flies JSBSim over X-Plane's protocol with telemetry, recording and early wake, while
stress-ng runs on every CPU and cyclictest runs at the same rate on the loop's own CPU. cyclictest
measures the delays of the machine itself: a virtual machine that pauses for half a second affects
both.

The kernel's counts show that the loop waited only for its timer: a thread that waits for a lock, a
file or a socket gives up its CPU, which the kernel counts as a voluntary context switch, and so it
does once per tick, for the timer.

The other programs are checked like the daemon: if the stress or cyclictest ends, the flight ends
with the reason.
"""

from __future__ import annotations

import json
import math
import shutil
import subprocess
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import Any

from .daemon import Daemon, command
from .fly import ENGAGE_SWITCH, await_subscriptions, switch_on
from .process import StandInProcess
from .rig import FlightError
from .standin import Settings

_LOOP_THREAD = "fcc-loop"
_PRIORITY = 80
_SETTLE_S = 3.0
_ENGAGE_S = 15.0
_LOOK_S = 0.25
_LONGEST_LATENESS_US = 1_000_000
# The measured window begins and ends within a tick, and time is read shortly before or after the
# counts.
_SWITCHES_BESIDE_TICKS = 5
_CYCLICTEST = "cyclictest"
_STRESS = "stress-ng"


@dataclass(frozen=True)
class Soak:
    """A flight to be flown."""

    fccd: Path
    seconds: float
    rate_hz: int
    stress: bool


@dataclass(frozen=True)
class Machine:
    """The machine's own lateness, measured by cyclictest."""

    cycles: int
    max_us: float
    periods_lost: int
    """Whole periods that all wake-ups together were late by."""
    longest_periods: int
    """Whole periods that the latest wake-up was late by."""


@dataclass(frozen=True)
class Result:
    """The result."""

    ticks: int
    missed: int
    overruns: int
    lateness_us: dict[str, float]
    within_2_percent: float
    page_faults: int
    memory_locked: bool
    watched_ticks: int
    """Ticks between the two readings of the kernel's counts of switches."""
    voluntary_switches_per_tick: float
    involuntary_switches: int
    cpu_percent: float
    exit_code: int
    cpus: str
    """The CPUs that the loop may run on, in the kernel's notation: one if it was bound."""
    machine: Machine

    @property
    def has_own_cpu(self) -> bool:
        """Whether the loop was bound to one CPU, so that cyclictest ran on the same."""
        return self.cpus.isdigit()

    def failures(self) -> list[str]:
        """Return the failures, as text; empty after a good flight."""
        found = []
        if not self.memory_locked:
            found.append("the memory was not locked: `fccd doctor` prints what to allow")
        elif self.page_faults:
            found.append(f"{self.page_faults} page faults")
        # Both measure the same machine, but at different times: two counts of rare events may
        # differ by three times their root. One pause of the machine is one event, however many
        # periods it takes.
        lost, longest = self.machine.periods_lost, self.machine.longest_periods
        if self.missed > lost + 3.0 * max(math.sqrt(self.missed + lost), longest):
            found.append(f"{self.missed} ticks missed, where the machine lost {lost}")
        if self.voluntary_switches_per_tick > 1.0 + _SWITCHES_BESIDE_TICKS / self.watched_ticks:
            found.append(
                f"{self.voluntary_switches_per_tick:.6f} waits in a tick: one is for the timer"
            )
        if self.exit_code:
            found.append(f"the daemon ended with exit code {self.exit_code}")
        return found

    def document(self) -> dict[str, Any]:
        """Return the flight for other programs."""
        return {**asdict(self), "failures": self.failures()}


@dataclass(frozen=True)
class _Watched:
    """The kernel's counts for the loop's thread within a window."""

    ticks: int
    waits: int
    displaced: int


class _BackgroundProgram:
    """A program that runs during the flight."""

    def __init__(self, words: list[str], name: str, folder: Path) -> None:
        self._name = name
        self._log = folder / f"{name}.said"
        with self._log.open("wb") as log:
            self._process = subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=log)

    def look(self) -> None:
        """Raise FlightError if it has ended."""
        code = self._process.poll()
        if code is not None:
            log = self._log.read_text("utf-8", "replace").strip()
            raise FlightError(f"{self._name} ended with {code}: {log}")

    def end(self) -> None:
        # With a signal and not killed: it ends its children, and writes its result.
        self._process.terminate()
        try:
            self._process.wait(30.0)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()


def periods_lost(histogram: dict[str, int], max_us: float, period_us: float) -> int:
    """Return the whole periods in cyclictest's histogram of lateness, us to how often.

    Lateness beyond the histogram is not in it; `max_us` accounts for that.
    """
    lost = sum(int(float(late) // period_us) * count for late, count in histogram.items())
    return lost + (int(max_us // period_us) if max_us >= _LONGEST_LATENESS_US else 0)


def soak(plan: Soak, notify: Callable[[float], None]) -> Result:
    """Fly; `say` is called with the seconds flown. Raises FlightError."""
    for name in (_CYCLICTEST, _STRESS) if plan.stress else (_CYCLICTEST,):
        if shutil.which(name) is None:
            raise FlightError(f"{name} is missing: use `make soak`, which installs it")
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch)
        measured = folder / "cyclictest.json"
        with StandInProcess(Settings(port=0)) as simulator:
            config = folder / "fccd.toml"
            config.write_text(_config(plan, simulator.port, folder / "recordings"))
            with Daemon(command(plan.fccd, config), folder / "said") as daemon:
                await_subscriptions(simulator, daemon)
                loop = _thread(daemon.pid)
                cpus = _status(loop)["Cpus_allowed_list"]
                # From before control is taken until the daemon has ended: missed ticks and lost
                # periods are from the same time.
                with _background(plan, cpus, measured) as background:
                    look = partial(_look, daemon, *background)
                    _fly(_SETTLE_S, look)
                    switch_on(simulator, daemon, within_s=_ENGAGE_S)
                    watched = _watch(plan, loop, look, notify)
                    simulator.write(ENGAGE_SWITCH, 0.0)
                    time.sleep(1.0)
                    look()
                    exit_code = daemon.stop()
                report = daemon.report()
                if report is None:
                    raise FlightError(f"the daemon printed no report; its messages: {daemon.log}")
        machine = _machine(measured, 1e6 / plan.rate_hz)
    return _result(report, watched, exit_code, cpus, machine)


def _config(plan: Soak, port: int, recordings: Path) -> str:
    return f"""
[x-plane]
simulator = "127.0.0.1:{port}"
[loop]
rate_hz = {plan.rate_hz}
[loop.early_wake]
enabled = true
[realtime]
cpu = "auto"
priority = {_PRIORITY}
[telemetry]
instance = "soak-{port}"
[recording]
folder = "{recordings}"
[budget]
failsafe_after = 0
"""


def _fly(
    seconds: float, look: Callable[[], None], notify: Callable[[float], None] | None = None
) -> None:
    began_s = time.monotonic()
    while (flown_s := time.monotonic() - began_s) < seconds:
        look()
        if notify is not None:
            notify(flown_s)
        time.sleep(_LOOK_S)


def _look(daemon: Daemon, *background: _BackgroundProgram) -> None:
    """Raise FlightError if anything that is to run has ended."""
    daemon.require_running()
    for beside in background:
        beside.look()


def _watch(
    plan: Soak, loop: Path, look: Callable[[], None], notify: Callable[[float], None]
) -> _Watched:
    """Fly, and count what the loop's thread waited."""
    # Time is read outside of the counts: a reader that is held up between the two
    # must not find waits too many.
    began_s = time.monotonic()
    before = _status(loop)
    _fly(plan.seconds, look, notify)
    after = _status(loop)
    seconds = time.monotonic() - began_s

    def counted(name: str) -> int:
        return int(after[name]) - int(before[name])

    return _Watched(
        ticks=max(round(seconds * plan.rate_hz), 1),
        waits=counted("voluntary_ctxt_switches"),
        displaced=counted("nonvoluntary_ctxt_switches"),
    )


def _thread(pid: int) -> Path:
    for task in Path(f"/proc/{pid}/task").iterdir():
        if (task / "comm").read_text().strip() == _LOOP_THREAD:
            return task
    raise FlightError(f"process {pid} has no thread {_LOOP_THREAD}")


def _status(task: Path) -> dict[str, str]:
    lines = (task / "status").read_text().splitlines()
    return {name: value.strip() for name, _, value in (line.partition(":") for line in lines)}


@contextmanager
def _background(plan: Soak, cpus: str, measured: Path) -> Iterator[list[_BackgroundProgram]]:
    """Run cyclictest where the loop runs, under it, and the stress if it is wanted."""
    cyclictest = [
        _CYCLICTEST,
        "--mlockall",
        "--quiet",
        "--threads=1",
        f"--affinity={cpus}",
        f"--interval={1e6 / plan.rate_hz:.0f}",
        f"--priority={_PRIORITY - 1}",
        f"--histogram={_LONGEST_LATENESS_US}",
        f"--json={measured}",
    ]
    # Nice to the simulator and to whoever sits there; to a real-time thread all
    # are alike.
    stress = f"nice -n 19 {_STRESS} --quiet --timeout 0 --cpu 0 --io 1 --vm 1 --vm-bytes 128M"
    wanted = [(_CYCLICTEST, cyclictest), *([(_STRESS, stress.split())] if plan.stress else [])]
    with ExitStack() as stack:
        background = []
        for name, words in wanted:
            beside = _BackgroundProgram(words, name, measured.parent)
            stack.callback(beside.end)
            background.append(beside)
        yield background


def _machine(measured: Path, period_us: float) -> Machine:
    try:
        thread = json.loads(measured.read_text())["thread"]["0"]
        return Machine(
            cycles=thread["cycles"],
            max_us=thread["max"],
            periods_lost=periods_lost(thread["histogram"], thread["max"], period_us),
            longest_periods=int(thread["max"] // period_us),
        )
    except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
        raise FlightError(f"cyclictest did not measure: {error!r}") from error


def _result(
    report: dict[str, Any], watched: _Watched, exit_code: int, cpus: str, machine: Machine
) -> Result:
    timing = report["timing"]
    return Result(
        ticks=timing["ticks"],
        missed=timing["missed"],
        overruns=report["overruns"],
        lateness_us=timing["lateness_us"],
        within_2_percent=timing["period_ms"]["within_2_percent"],
        page_faults=timing["page_faults"],
        memory_locked=timing["realtime"]["memory_locked"],
        watched_ticks=watched.ticks,
        voluntary_switches_per_tick=watched.waits / watched.ticks,
        involuntary_switches=watched.displaced,
        cpu_percent=timing["cpu_percent"],
        exit_code=exit_code,
        cpus=cpus,
        machine=machine,
    )
