"""Flights among datagrams of others: whether they disturb the daemon, and what they cost it.

    with flood(("127.0.0.1", 49071), per_second=100_000) as sender:
        ...
    sender.sent

Another address of this machine, 127.0.0.2, sends to the daemon's port: to the daemon that is
another host. The kernel cuts each large datagram into many (UDP_SEGMENT, udp(7)), so that one
process sends as many as a fast network.
"""

from __future__ import annotations

import multiprocessing
import os
import socket
import struct
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing.synchronize import Event
from pathlib import Path
from typing import Protocol

from .daemon import Daemon, command
from .fly import await_subscriptions, switch_on
from .process import StandInProcess
from .rig import FlightError
from .standin import Settings
from .udp import free_port

FOREIGN = "127.0.0.2"
_UDP_SEGMENT = 103
_BATCH = 64
"""Datagrams in one call: the most that the kernel cuts."""
_INDEX = 0
_VALUE = 1e6
_SETTLE_S = 3.0


class Counter(Protocol):
    """A number shared by processes."""

    value: int


@dataclass
class Sent:
    """What was sent, once the flood is over."""

    datagrams: int = 0
    seconds: float = 0.0

    @property
    def per_second(self) -> float:
        """Return the rate."""
        return self.datagrams / self.seconds if self.seconds else 0.0


def _send(
    target: tuple[str, int], per_second: float, cpu: int | None, over: Event, sent: Counter
) -> None:
    """Send until it is over; in a process of its own."""
    if cpu is not None:
        os.sched_setaffinity(0, {cpu})
    # A reply of X-Plane with a value for the first index.
    datagram = b"RREF," + struct.pack("<if", _INDEX, _VALUE)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
        sender.bind((FOREIGN, 0))
        sender.setsockopt(socket.IPPROTO_UDP, _UDP_SEGMENT, len(datagram))
        batch = datagram * _BATCH
        began_s = time.monotonic()
        while not over.is_set():
            due = (time.monotonic() - began_s) * per_second
            while sent.value < due and not over.is_set():
                # A port that is closed is reported to the next call.
                try:
                    sender.sendto(batch, target)
                except ConnectionRefusedError:
                    continue
                sent.value += _BATCH
            time.sleep(0.001)


@contextmanager
def flood(target: tuple[str, int], per_second: float, cpu: int | None = None) -> Iterator[Sent]:
    """Send datagrams from another address, from the CPU `cpu` if it is given."""
    context = multiprocessing.get_context("spawn")
    over, count = context.Event(), context.Value("q", 0)
    process = context.Process(
        target=_send, args=(target, per_second, cpu, over, count), name="flood", daemon=True
    )
    process.start()
    sent = Sent()
    while count.value == 0 and process.is_alive():
        time.sleep(0.001)
    before, began_s = count.value, time.monotonic()
    try:
        yield sent
    finally:
        sent.datagrams = count.value - before
        sent.seconds = time.monotonic() - began_s
        over.set()
        process.join(5.0)
        if process.is_alive():
            process.kill()


def cpu_s(pid: int) -> float:
    """Return the CPU time that all threads of a process have taken, s (proc_pid_schedstat)."""
    tasks = Path(f"/proc/{pid}/task").iterdir()
    return sum(int((task / "schedstat").read_text().split()[0]) for task in tasks) * 1e-9


@dataclass(frozen=True)
class Plan:
    """A flight: first without, then with the datagrams of others."""

    fccd: Path
    seconds: float = 30.0
    per_second: float = 100_000.0


@dataclass(frozen=True)
class Result:
    """What it was."""

    per_second: float
    """Datagrams that were sent."""
    quiet_percent: float
    """CPU time of the daemon, of one core, without."""
    flooded_percent: float
    """And with them."""
    missed: int
    exit_code: int
    disturbed: list[str]
    """Events in which it left the state engaged before the end, or did not hear the simulator."""

    def failures(self, most_percent: float = 3.0, least_per_second: float = 99_000.0) -> list[str]:
        """Return what is not as it must be."""
        found = []
        if self.per_second < least_per_second:
            found.append(
                f"only {self.per_second:,.0f} datagrams a second were sent: "
                "keep the second CPU free, and repeat"
            )
        if self.missed:
            found.append(f"{self.missed} ticks missed")
        more = self.flooded_percent - self.quiet_percent
        if more > most_percent:
            found.append(f"{more:.2f} % of a core more, at most {most_percent} % are permitted")
        if self.exit_code != 0:
            found.append(f"the daemon ended with {self.exit_code}")
        found += self.disturbed
        return found


def fly(plan: Plan) -> Result:
    """Fly on one CPU; the sender has another one, if there is one."""
    cpus = sorted(os.sched_getaffinity(0))
    port = free_port()
    with tempfile.TemporaryDirectory() as scratch, StandInProcess(Settings(port=0)) as simulator:
        config = Path(scratch, "fccd.toml")
        config.write_text(
            f'[x-plane]\nsimulator = "127.0.0.1:{simulator.port}"\nlocal_port = {port}\n'
            f'[guidance]\nmode = "hold"\n[recording]\nfolder = "{scratch}/recordings"\n'
        )
        words = ["taskset", "--cpu-list", str(cpus[0]), *command(plan.fccd, config)]
        with Daemon(words, Path(scratch, "said")) as daemon:
            await_subscriptions(simulator, daemon)
            time.sleep(_SETTLE_S)
            switch_on(simulator, daemon)
            time.sleep(_SETTLE_S)
            quiet = _percent(daemon.pid, plan.seconds)
            with flood(("127.0.0.1", port), plan.per_second, cpus[-1]) as sent:
                flooded = _percent(daemon.pid, plan.seconds)
            exit_code = daemon.stop()
            report = daemon.report()
            if report is None:
                raise FlightError(f"the daemon printed no report; its messages: {daemon.log}")
    events = [event["text"] for event in report["events"]]
    missed = int(report["timing"]["missed"])
    return Result(sent.per_second, quiet, flooded, missed, exit_code, disturbed(events))


def disturbed(events: list[str]) -> list[str]:
    """Return the events of a flight that what others send must not cause."""
    return [
        text
        for text in events
        if (text.startswith("engaged -> ") and "stopped" not in text)
        or "link lost" in text
        or "does not answer" in text
    ]


def _percent(pid: int, seconds: float) -> float:
    before, began_s = cpu_s(pid), time.monotonic()
    time.sleep(seconds)
    return 100.0 * (cpu_s(pid) - before) / (time.monotonic() - began_s)
