"""The release helper: stopped, killed, or not to be started, the controls are released."""

from __future__ import annotations

import contextlib
import ctypes
import os
import random
import resource
import signal
import subprocess
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from daemon_under_test import (
    DaemonUnderTest,
    Ending,
    assert_released,
    engage,
    flight,
    helpers_of,
    open_files,
    start,
    wait_until,
    write_config,
)

from fcc_hil.cockpit import OVERRIDE_JOYSTICK
from fcc_hil.fly import ENGAGE_SWITCH
from fcc_hil.process import StandInProcess
from fcc_hil.standin import Settings

SUCCESS = 0
CUT_OFF = "an earlier flight was cut off and may have left the controls held"
KILLS = int(os.environ.get("FCCD_KILLS", "4"))
"""How many flights are killed; 100 take ten minutes: `make test-attacks`."""
PR_SET_CHILD_SUBREAPER = 36
"""See prctl(2)."""


@pytest.mark.parametrize("by", ["signal", "switch"])
def test_no_exit_waits_for_a_helper_that_is_stopped(fccd: Path, tmp_path: Path, by: str) -> None:
    with flight(fccd, tmp_path, others='[engage]\nswitch_off = "stop"') as (simulator, daemon):
        engage(simulator, daemon)
        (helper,) = daemon.helpers()
        os.kill(helper, signal.SIGSTOP)
        if by == "switch":
            simulator.write(ENGAGE_SWITCH, 0.0)
        ending = daemon.end(signal.SIGTERM if by == "signal" else None, within_s=8.0)
        assert_released(simulator)
        wait_until(lambda: not Path(f"/proc/{helper}").exists(), "it has ended, too")
    assert ending.exit_code == SUCCESS


def test_a_helper_that_is_stopped_releases_when_the_daemon_is_killed(
    fccd: Path, tmp_path: Path
) -> None:
    """Also if the process that adopts it is of its session, as the first one of a container."""
    libc = ctypes.CDLL(None, use_errno=True)
    with contextlib.ExitStack() as after:
        after.callback(libc.prctl, PR_SET_CHILD_SUBREAPER, 0, 0, 0, 0)
        assert libc.prctl(PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0) == 0
        with flight(fccd, tmp_path) as (simulator, daemon):
            engage(simulator, daemon)
            (helper,) = daemon.helpers()
            os.kill(helper, signal.SIGSTOP)
            daemon.end(signal.SIGKILL)
            after.callback(os.waitpid, helper, 0)
            after.callback(os.kill, helper, signal.SIGKILL)
            assert_released(simulator)


def test_a_helper_that_could_not_be_started_is_started_later(fccd: Path, tmp_path: Path) -> None:
    """Descriptors are short when it ends."""
    with flight(fccd, tmp_path) as (simulator, daemon):
        engage(simulator, daemon)
        most = resource.prlimit(daemon.pid, resource.RLIMIT_NOFILE)
        resource.prlimit(daemon.pid, resource.RLIMIT_NOFILE, (0, most[1]))
        (helper,) = daemon.helpers()
        os.kill(helper, signal.SIGKILL)
        words = daemon.wait_for("no release helper (")
        assert "Too many open files" in words
        assert "its start is tried again each second" in words
        resource.prlimit(daemon.pid, resource.RLIMIT_NOFILE, most)
        daemon.wait_for("the release helper, which could not be started before, was started")
        assert len(daemon.helpers()) == 1
        daemon.end(signal.SIGKILL)
        wait_until(lambda: not simulator.progress().overridden, "it releases")


def test_a_helper_that_can_open_nothing_any_more_releases(fccd: Path, tmp_path: Path) -> None:
    """As if other programs had taken all ports: it has its socket since the takeover."""
    with flight(fccd, tmp_path) as (simulator, daemon):
        engage(simulator, daemon)
        (helper,) = daemon.helpers()
        wait_until(
            lambda: any(file.startswith("socket:") for file in open_files(helper)), "its socket"
        )
        most = resource.prlimit(helper, resource.RLIMIT_NOFILE)
        resource.prlimit(helper, resource.RLIMIT_NOFILE, (0, most[1]))
        daemon.end(signal.SIGKILL)
        assert_released(simulator)


def test_a_helper_sees_the_end_of_a_daemon_whose_pipe_stays_open(
    fccd: Path, tmp_path: Path
) -> None:
    """As that of a killed process does, one thread of which waits for a disk."""
    with flight(fccd, tmp_path) as (simulator, daemon):
        engage(simulator, daemon)
        (helper,) = daemon.helpers()
        writer = os.open(f"/proc/{helper}/fd/0", os.O_WRONLY)
        try:
            daemon.send(signal.SIGKILL)
            assert_released(simulator)
        finally:
            os.close(writer)


@contextlib.contextmanager
def full_pipe() -> Iterator[int]:
    """Make a pipe that nobody reads, and in which nothing has room."""
    reader, writer = os.pipe()
    os.set_blocking(writer, False)
    with contextlib.suppress(BlockingIOError):
        while True:
            os.write(writer, bytes(4096))
    os.set_blocking(writer, True)
    try:
        yield writer
    finally:
        os.close(reader)
        os.close(writer)


def test_a_helper_does_not_wait_for_a_debugger_that_is_stopped(fccd: Path, tmp_path: Path) -> None:
    """The kernel ends a process that is traced only when the tracer goes on."""
    with flight(fccd, tmp_path) as (simulator, daemon):
        engage(simulator, daemon)
        words = ["strace", "-f", "-p", str(daemon.pid), "-e", "trace=none", "-o", "/dev/null"]
        with subprocess.Popen(words, stderr=subprocess.DEVNULL) as tracer:
            status = Path(f"/proc/{daemon.pid}/status")
            wait_until(lambda: f"TracerPid:\t{tracer.pid}" in status.read_text(), "it is traced")
            tracer.send_signal(signal.SIGSTOP)
            try:
                daemon.send(signal.SIGKILL)
                assert_released(simulator)
                assert status.exists(), "it has not ended yet"
            finally:
                tracer.kill()


@pytest.mark.fault(
    "Around the flight",
    "release helper ends, is killed or hangs",
    "its end; pipe not emptied",
    "20 ms; 5 s",
    "event; restarted, five times a flight, once a second at most",
)
def test_a_helper_that_does_not_read_is_replaced(fccd: Path, tmp_path: Path) -> None:
    with flight(fccd, tmp_path) as (simulator, daemon):
        daemon.wait_until_ready()
        (helper,) = daemon.helpers()
        os.kill(helper, signal.SIGSTOP)
        engage(simulator, daemon)
        daemon.wait_for("the release helper did not read its input, and was started again")
        (other,) = daemon.helpers()
        assert other != helper
        daemon.end(signal.SIGKILL)
        assert_released(simulator)


def test_a_helper_does_not_wait_for_a_daemon_that_has_given_up(fccd: Path, tmp_path: Path) -> None:
    """The daemon cannot end: nobody reads its result."""
    with StandInProcess(Settings(port=0)) as simulator, full_pipe() as output:
        config = write_config(tmp_path, simulator.port)
        words: list[str | Path] = [fccd, "run", "--config", config, "--json"]
        with DaemonUnderTest(words, tmp_path, stdout=output) as daemon:
            engage(simulator, daemon)
            simulator.act("freeze:60")
            daemon.send(signal.SIGTERM)
            assert "the release helper continues" in daemon.wait_for("did not confirm the release")
            simulator.act("run")
            assert_released(simulator)
            assert daemon.is_running


def test_a_helper_holds_nothing_of_others(fccd: Path, tmp_path: Path) -> None:
    """Neither descriptors that the daemon inherited or has, nor the pipe that it prints into."""
    with StandInProcess(Settings(port=0)) as simulator:
        instance = f'[telemetry]\ninstance = "fccd-test-{simulator.port}"'
        config = write_config(tmp_path, simulator.port, others=instance)
        with (
            (tmp_path / "inherited").open("w") as inherited,
            subprocess.Popen(
                [fccd, "run", "--config", config, "--quiet"],
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.PIPE,
                pass_fds=[inherited.fileno()],
            ) as process,
        ):
            wait_until(lambda: len(helpers_of(process.pid)) == 1, "its helper")
            wait_until(lambda: len(helpers_of(process.pid, "publisher")) == 1, "its publisher")
            (helper,) = (Path(f"/proc/{pid}/fd") for pid in helpers_of(process.pid))
            wait_until(lambda: len(list(helper.iterdir())) == 3, "three descriptors")
            assert (helper / "2").readlink() == Path("/dev/null")
            (publisher,) = helpers_of(process.pid, "publisher")
            wait_until(lambda: inherited.name not in open_files(publisher), "it is closed")
            assert Path(f"/proc/{publisher}/fd/2").readlink() == Path("/dev/null")
            # Signals are caught by then.
            recordings = tmp_path / "recordings"
            wait_until(lambda: list(recordings.glob("*.mcap")) != [], "it records")
            process.send_signal(signal.SIGTERM)
            assert process.wait(15.0) == SUCCESS


Kill = Callable[[DaemonUnderTest, random.Random], None]


def _daemon(daemon: DaemonUnderTest, _: random.Random) -> None:
    daemon.send(signal.SIGKILL)


def kill_helpers(daemon: DaemonUnderTest) -> None:
    for helper in daemon.helpers():
        with contextlib.suppress(ProcessLookupError):
            os.kill(helper, signal.SIGKILL)


def _helper(daemon: DaemonUnderTest, _: random.Random) -> None:
    kill_helpers(daemon)


def _helper_then_daemon(daemon: DaemonUnderTest, dice: random.Random) -> None:
    _helper(daemon, dice)
    time.sleep(dice.choice([0.0, 0.005, 0.02, 0.1]))
    _daemon(daemon, dice)


def _daemon_then_helper(daemon: DaemonUnderTest, dice: random.Random) -> None:
    helpers = daemon.helpers()
    _daemon(daemon, dice)
    time.sleep(dice.choice([0.0, 0.002, 0.01]))
    for helper in helpers:
        with contextlib.suppress(ProcessLookupError):
            os.kill(helper, signal.SIGKILL)


ORDERS: list[Kill] = [_daemon, _helper_then_daemon, _daemon_then_helper, _helper]


@pytest.mark.fault(
    "Around the flight",
    "daemon and helper killed, overrides stay set",
    "simulator's file, state file",
    "next start; `warm`: 5 s at most",
    "released until confirmed; only reported with `restart.release_left_held = false`, or if "
    "the yoke stands still after a reboot or without either file",
)
def test_whoever_is_killed_the_controls_are_released_in_the_end(fccd: Path, tmp_path: Path) -> None:
    """Daemon, helper, both, in every order; after both, by the next start, which is cold."""
    dice = random.Random(12)
    left = 0
    early = 0
    released_s: list[float] = []
    with StandInProcess(Settings(port=0)) as simulator:
        config = write_config(tmp_path, simulator.port)
        for number in range(KILLS):
            simulator.write(ENGAGE_SWITCH, 0.0)
            with start(fccd, tmp_path, config) as daemon:
                daemon.wait_until_ready()
                simulator.write(ENGAGE_SWITCH, 1.0)
                deadline_s = time.monotonic() + 15.0
                while simulator.read(OVERRIDE_JOYSTICK) != 1.0:
                    assert time.monotonic() < deadline_s, daemon.log
                # The first 20 ms, or later.
                delay_s = dice.choice([dice.uniform(0.0, 0.02), dice.uniform(0.0, 1.5)])
                early += delay_s < 0.02
                time.sleep(delay_s)
                order = ORDERS[number % len(ORDERS)]
                order(daemon, dice)
                if order is _helper:
                    # It is started again, and releases.
                    daemon.wait_for("the release helper had ended, and was started again")
                    _daemon(daemon, dice)
                daemon.end()
            what = f"flight {number}, {order.__name__}"
            killed_s = time.monotonic()
            simulator.write(ENGAGE_SWITCH, 0.0)
            if order is _daemon or order is _helper:
                wait_until(lambda: not simulator.progress().overridden, what, daemons=[daemon])
                released_s.append(time.monotonic() - killed_s)
                continue
            with start(fccd, tmp_path, config) as again:
                both = [daemon, again]
                wait_until(lambda: not simulator.progress().overridden, what, daemons=both)
                released_s.append(time.monotonic() - killed_s)
                again.wait_until_ready()
                ending: Ending = again.end(signal.SIGTERM)
            left += CUT_OFF in ending.log
            assert ending.exit_code == SUCCESS
    print(
        f"released after {len(released_s)} of {KILLS} kills, {early} of them in the first 20 ms, "
        f"{left} by the next start; after {sorted(released_s)[len(released_s) // 2]:.2f} s, "
        f"at most {max(released_s):.2f} s"
    )
    assert left > 0, "a helper was never killed in time"


def test_what_is_left_held_is_only_reported_if_configured(fccd: Path, tmp_path: Path) -> None:
    others = "[restart]\nrelease_left_held = false"
    with flight(fccd, tmp_path, others=others) as (simulator, daemon):
        engage(simulator, daemon)
        daemon.send(signal.SIGSTOP)
        kill_helpers(daemon)
        daemon.end(signal.SIGKILL)
        simulator.write(ENGAGE_SWITCH, 0.0)
        with start(fccd, tmp_path, tmp_path / "fccd.toml") as again:
            words = again.wait_for(CUT_OFF)
            assert "restart.release_left_held is false" in words
            again.wait_until_ready()
            assert again.end(signal.SIGTERM).exit_code == SUCCESS
        assert simulator.progress().overridden
        # The next start may do otherwise.
        (tmp_path / "other").mkdir()
        config = write_config(tmp_path / "other", simulator.port)
        with start(fccd, tmp_path / "other", config) as again:
            assert "they are released" in again.wait_for(CUT_OFF)
            wait_until(lambda: not simulator.progress().overridden, "they are")
            assert again.end(signal.SIGTERM).exit_code == SUCCESS
