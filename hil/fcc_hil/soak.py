"""A long flight under stress, with the machine's own lateness measured beside.

The daemon flies JSBSim over X-Plane's protocol with everything on (telemetry,
recording, the early wake), while stress-ng works on every CPU and cyclictest runs
at the same rate on the loop's own CPU. cyclictest tells what the machine itself was
late by: a virtual machine that stands still for half a second does so for both.

That the loop never waited for anything but its timer is read from the kernel: a
thread that waits for a lock, a file or a socket gives up its CPU, which the kernel
counts as a voluntary context switch, and so it does once a tick, for the timer.
"""

from __future__ import annotations

import json
import math
import shutil
import subprocess
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from .cockpit import GENERIC_LIGHTS
from .daemon import Daemon, command
from .process import StandInProcess
from .standin import Settings

_SWITCH = f"{GENERIC_LIGHTS}[0]"
_LOOP_THREAD = "fcc-loop"
_PRIORITY = 80
_SUBSCRIBE_S = 15.0
_SETTLE_S = 3.0
_ENGAGE_S = 5.0
_LOOK_S = 0.25
_LONGEST_LATENESS_US = 1_000_000
# Around the flight's ends the thread waits for more than its timer.
_SWITCHES_BESIDE_TICKS = 5


class SoakError(RuntimeError):
    """The flight could not be flown to its end."""


@dataclass(frozen=True)
class Soak:
    """What to fly."""

    fccd: Path
    seconds: float
    rate_hz: int
    stress: bool


@dataclass(frozen=True)
class Machine:
    """What cyclictest saw beside: the machine's own lateness."""

    cycles: int
    max_us: float
    periods_lost: int
    """Whole periods that its wake-ups were late by, all together."""


@dataclass(frozen=True)
class Result:
    """What came of it."""

    ticks: int
    missed: int
    lateness_us: dict[str, float]
    within_2_percent: float
    page_faults: int
    voluntary_switches_per_tick: float
    involuntary_switches: int
    cpu_percent: float
    exit_code: int
    machine: Machine

    def failures(self) -> list[str]:
        """Return what is not as it should be, in words; empty after a good flight."""
        found = []
        if self.page_faults:
            found.append(f"{self.page_faults} page faults")
        lost = self.machine.periods_lost
        # Both see the same machine, but not at the same moments: what each of two
        # counts of rare events may differ by is three times their root.
        if self.missed > lost + 3.0 * math.sqrt(self.missed + lost):
            found.append(f"{self.missed} ticks missed, where the machine lost {lost}")
        if self.voluntary_switches_per_tick > 1.0 + _SWITCHES_BESIDE_TICKS / max(self.ticks, 1):
            found.append(
                f"{self.voluntary_switches_per_tick:.4f} waits in a tick: one is for the timer"
            )
        if self.exit_code:
            found.append(f"the daemon ended with exit code {self.exit_code}")
        return found

    def document(self) -> dict[str, Any]:
        """Return the flight as other tools read it."""
        return {**asdict(self), "failures": self.failures()}


def periods_lost(histogram: dict[str, int], period_us: float) -> int:
    """Return the whole periods in a histogram of lateness, us to how often."""
    return sum(int(float(late) // period_us) * count for late, count in histogram.items())


def soak(order: Soak, say: Callable[[float], None]) -> Result:
    """Fly; `say` hears how many seconds are flown. Raises SoakError."""
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch)
        with StandInProcess(Settings(port=0)) as simulator:
            config = folder / "fccd.toml"
            config.write_text(_config(order, simulator.port, folder / "recordings"))
            with Daemon(command(order.fccd, config), folder / "said") as daemon:
                _engage(simulator, daemon)
                loop = _thread(daemon.pid)
                cpus = _status(loop)["Cpus_allowed_list"]
                with _stress(order.stress), _cyclictest(order, cpus, folder) as measured:
                    _wait(order.seconds, daemon, say)
                switches = _status(loop)
                simulator.write(_SWITCH, 0.0)
                time.sleep(1.0)
                exit_code = daemon.stop()
                report = daemon.report()
                if report is None:
                    raise SoakError(f"the daemon printed no report; it said: {daemon.said}")
        machine = _machine(measured, 1e6 / order.rate_hz)
    return _result(report, switches, exit_code, machine)


def _config(order: Soak, port: int, recordings: Path) -> str:
    return f"""
[x-plane]
simulator = "127.0.0.1:{port}"
engage_switch = "{_SWITCH}"
[loop]
rate_hz = {order.rate_hz}
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


def _engage(simulator: StandInProcess, daemon: Daemon) -> None:
    _await(lambda: simulator.progress().subscriptions > 0, daemon, _SUBSCRIBE_S, "does not ask")
    time.sleep(_SETTLE_S)
    simulator.write(_SWITCH, 1.0)
    _await(lambda: simulator.progress().overridden, daemon, _ENGAGE_S, "does not take the controls")


def _await(arrived: Callable[[], bool], daemon: Daemon, patience_s: float, otherwise: str) -> None:
    deadline_s = time.monotonic() + patience_s
    while not arrived():
        if daemon.exit_code is not None or time.monotonic() > deadline_s:
            raise SoakError(f"the daemon {otherwise}; it said: {daemon.said}")
        time.sleep(_LOOK_S)


def _wait(seconds: float, daemon: Daemon, say: Callable[[float], None]) -> None:
    began_s = time.monotonic()
    while (flown_s := time.monotonic() - began_s) < seconds:
        if daemon.exit_code is not None:
            raise SoakError(
                f"the daemon ended with exit code {daemon.exit_code} after {flown_s:.0f} s; "
                f"it said: {daemon.said}"
            )
        say(flown_s)
        time.sleep(_LOOK_S)


def _thread(pid: int) -> Path:
    for task in Path(f"/proc/{pid}/task").iterdir():
        if (task / "comm").read_text().strip() == _LOOP_THREAD:
            return task
    raise SoakError(f"process {pid} has no thread {_LOOP_THREAD}")


def _status(task: Path) -> dict[str, str]:
    lines = (task / "status").read_text().splitlines()
    return {name: value.strip() for name, _, value in (line.partition(":") for line in lines)}


@contextmanager
def _stress(wanted: bool) -> Iterator[None]:
    if not wanted:
        yield
        return
    # Nice to the simulator and to whoever sits there; to a real-time thread all
    # are alike.
    words = "nice -n 19 stress-ng --quiet --timeout 0 --cpu 0 --io 1 --vm 1 --vm-bytes 128M"
    with _beside(words.split()):
        yield


@contextmanager
def _cyclictest(order: Soak, cpus: str, folder: Path) -> Iterator[Path]:
    """Run cyclictest where the loop runs, under it, until the end."""
    measured = folder / "cyclictest.json"
    words = [
        "cyclictest",
        "--mlockall",
        "--quiet",
        "--threads=1",
        f"--affinity={cpus}",
        f"--interval={1e6 / order.rate_hz:.0f}",
        f"--priority={_PRIORITY - 1}",
        f"--histogram={_LONGEST_LATENESS_US}",
        f"--json={measured}",
    ]
    with _beside(words):
        yield measured


@contextmanager
def _beside(words: list[str]) -> Iterator[None]:
    if shutil.which(words[0]) is None:
        raise SoakError(f"{words[0]} is not there: use `make soak`, which installs it")
    process = subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        yield
    finally:
        # Asked and not killed: it ends its children, and writes what it measured.
        process.terminate()
        try:
            process.wait(30.0)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()


def _machine(measured: Path, period_us: float) -> Machine:
    try:
        thread = json.loads(measured.read_text())["thread"]["0"]
    except (OSError, ValueError, KeyError) as error:
        raise SoakError(f"cyclictest did not measure: {error}") from error
    return Machine(
        cycles=thread["cycles"],
        max_us=thread["max"],
        periods_lost=periods_lost(thread["histogram"], period_us),
    )


def _result(
    report: dict[str, Any], switches: dict[str, str], exit_code: int, machine: Machine
) -> Result:
    timing = report["timing"]
    return Result(
        ticks=timing["ticks"],
        missed=timing["missed"],
        lateness_us=timing["lateness_us"],
        within_2_percent=timing["period_ms"]["within_2_percent"],
        page_faults=timing["page_faults"],
        voluntary_switches_per_tick=int(switches["voluntary_ctxt_switches"]) / timing["ticks"],
        involuntary_switches=int(switches["nonvoluntary_ctxt_switches"]),
        cpu_percent=timing["cpu_percent"],
        exit_code=exit_code,
        machine=machine,
    )
