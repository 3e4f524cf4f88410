"""Another user of X-Plane's machine answers in its place while it is silent."""

from __future__ import annotations

import contextlib
import json
import signal
import subprocess
import sys
import threading
from collections.abc import Iterator
from pathlib import Path

import pytest
from daemon_under_test import DaemonUnderTest, engage, flight, wait_until
from other_user import NOBODY, as_user, needs_two_users

from fcc_hil.fly import ENGAGE_SWITCH
from fcc_hil.process import StandInProcess
from fcc_hil.standin import Mode, Settings

SUCCESS = 0
NOT_RELEASED = 5
ADOPTED_AFTER_S = 2.0
"""After such a silence another port is used while nothing is held."""

pytestmark = needs_two_users

# Sends to the ports of each line every 5 ms: 0 in every value that is requested, so a switch
# that is off, and overrides that are cleared, also to who only releases (9001, 9002).
IMPOSTOR = """
import json, select, socket, struct, sys, time
s = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
s.bind(("127.0.0.1", 0))
indices = [*range(64), 9001, 9002]
lie = b"RREF," + b"".join(struct.pack("<if", index, 0.0) for index in indices)
ports = []
while True:
    if select.select([sys.stdin], [], [], 0.005)[0]:
        line = sys.stdin.readline()
        if not line:
            break
        ports = json.loads(line)
    for port in ports:
        s.sendto(lie, ("127.0.0.1", port))
"""

# Opens sockets of the simulator's port at other loopback addresses: the kernel lists the latest
# first.
CROWD = """
import resource, socket, sys
port, first, last = map(int, sys.argv[1:])
_, most = resource.getrlimit(resource.RLIMIT_NOFILE)
resource.setrlimit(resource.RLIMIT_NOFILE, (most, most))
opened = []
for number in range(first, last):
    s = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    s.bind((f"127.1.{number // 250}.{2 + number % 250}", port))
    opened.append(s)
print(len(opened), flush=True)
sys.stdin.read()
"""
CROWD_SOCKETS = 16_000
"""More rows than fccd reads of that list."""
CROWD_PROCESSES = 4
"""Each opens as many as a process usually may."""


@contextlib.contextmanager
def crowd(port: int) -> Iterator[None]:
    """Let another user push this port's row out of what is read of the list of sockets."""
    each = CROWD_SOCKETS // CROWD_PROCESSES
    with contextlib.ExitStack() as stack:
        processes = []
        for first in range(0, CROWD_SOCKETS, each):
            numbers = [str(number) for number in (port, first, first + each)]
            words = [*as_user(NOBODY), sys.executable, "-I", "-u", "-c", CROWD, *numbers]
            process = subprocess.Popen(
                words, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, cwd="/"
            )
            processes.append(stack.enter_context(process))
            stack.callback(process.kill)
        for process in processes:
            assert process.stdout is not None
            assert int(process.stdout.readline()) == each
        yield


def ports_of(*processes: int) -> list[int]:
    """Return the UDP ports of these processes."""
    sockets = set()
    for pid in processes:
        with contextlib.suppress(OSError):
            for descriptor in Path(f"/proc/{pid}/fd").iterdir():
                with contextlib.suppress(OSError):
                    sockets.add(str(descriptor.readlink()))
    rows = [row.split() for row in Path("/proc/net/udp").read_text().splitlines()[1:]]
    return [int(row[1].partition(":")[2], 16) for row in rows if f"socket:[{row[9]}]" in sockets]


@contextlib.contextmanager
def impostor(daemon: DaemonUnderTest) -> Iterator[None]:
    """Let another user send to every port of the daemon and of its helper, also to new ones."""
    helpers = daemon.helpers()
    words = as_user(NOBODY)
    over = threading.Event()
    with subprocess.Popen(
        [*words, sys.executable, "-I", "-u", "-c", IMPOSTOR],
        stdin=subprocess.PIPE,
        text=True,
        cwd="/",
    ) as process:
        assert process.stdin is not None
        lines = process.stdin

        def tell() -> None:
            while not over.wait(0.02):
                lines.write(json.dumps(ports_of(daemon.pid, *helpers)) + "\n")
                lines.flush()

        telling = threading.Thread(target=tell)
        telling.start()
        try:
            yield
        finally:
            over.set()
            telling.join()
            process.kill()


def is_over_within(daemon: DaemonUnderTest, seconds: float) -> bool:
    """Return whether the flight ends, or is disengaged, within this time."""
    with contextlib.suppress(AssertionError):
        wait_until(lambda: "engaged -> " in daemon.log, "", seconds)
    return "engaged -> " in daemon.log


def test_nobody_takes_the_place_of_a_flown_simulator_that_is_silent(
    fccd: Path, tmp_path: Path
) -> None:
    with flight(fccd, tmp_path) as (simulator, daemon):
        engage(simulator, daemon)
        helpers = daemon.helpers()
        with impostor(daemon):
            simulator.set_mode(Mode.FROZEN)
            assert not is_over_within(daemon, 1.5 * ADOPTED_AFTER_S)
            simulator.set_mode(Mode.RUNNING)
            # It continues as the one that it was.
            daemon.wait_for("the simulator stood still for")
            assert daemon.next_state() == "engaged"
            # Nobody else confirms a release.
            simulator.set_mode(Mode.FROZEN)
            ending = daemon.end(signal.SIGTERM)
            assert ending.exit_code == NOT_RELEASED, ending.log
            assert "did not confirm the release" in ending.log
            assert ending.report["released"] is False
            assert ending.states == ["standby -> engaged", "engaged -> stopped"]
            assert "now, before from" not in ending.log
            # The helper does not believe it, either.
            assert all(Path(f"/proc/{pid}").exists() for pid in helpers)
            simulator.write(ENGAGE_SWITCH, 0.0)
            simulator.set_mode(Mode.RUNNING)
            wait_until(lambda: not simulator.progress().overridden, "the helper releases")


@pytest.mark.fault(
    "Simulator and link",
    "flown simulator restarted, on another port",
    "its old port is closed; else 30 s after release",
    "0.2 s, other machine 3 s",
    "event; given back",
)
def test_a_simulator_that_is_started_again_in_flight_is_flown_again(
    fccd: Path, tmp_path: Path
) -> None:
    with flight(fccd, tmp_path) as (simulator, daemon):
        engage(simulator, daemon)
        with impostor(daemon):
            simulator.kill()
            with StandInProcess(Settings(port=simulator.port)) as again:
                answers = (
                    f"X-Plane at 127.0.0.1:{again.port} answers from UDP port {again.reply_port}"
                )
                daemon.wait_for(answers, 30.0)
                wait_until(lambda: "engaged -> standby" in daemon.log, "what it flew is gone")
                engage(again, daemon)
                ending = daemon.end(signal.SIGTERM)
                assert not again.progress().overridden
    assert ending.exit_code == SUCCESS, ending.log
    assert ending.report["released"] is True


def test_sockets_of_another_user_hide_no_port_of_the_simulator(fccd: Path, tmp_path: Path) -> None:
    with flight(fccd, tmp_path) as (simulator, daemon):
        engage(simulator, daemon)
        with crowd(simulator.reply_port):
            assert not is_over_within(daemon, 2.0 * ADOPTED_AFTER_S)
            assert "nothing arrives" not in daemon.log
            ending = daemon.end(signal.SIGTERM)
        assert ending.exit_code == SUCCESS, ending.log
        assert ending.report["released"] is True
        assert not simulator.progress().overridden
