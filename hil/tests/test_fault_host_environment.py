"""Faults of a flight's environment: disk, terminal, watchers, configuration, a second daemon."""

from __future__ import annotations

import os
import shutil
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Mapping
from pathlib import Path

import fcc
import pytest
from daemon_under_test import (
    DaemonUnderTest,
    Ending,
    assert_released,
    engage,
    flight,
    start,
    write_config,
)
from fault_flights import (
    AT_ONCE_S,
    ENGAGED,
    FAILSAFE,
    Flown,
    assert_flown_again,
    assert_regular,
    at_once,
)
from recordings import RECORD, attachments, in_sequence, only_recording

from fcc_hil.process import StandInProcess
from fcc_hil.standin import Settings

SUCCESS = 0
NOT_RECORDED = 14
TAKEN = 12

NORMAL_HZ = 40
FAST_HZ = 1_000
RING_S = 4.2
"""The capacity of the loop's ring at 1 kHz, s."""
WRITTEN_EVERY_S = 0.7
"""Interval of commits, s."""
BEACON_PERIOD_S = 1.0
"""As X-Plane sends it."""

HOLD = '[guidance]\nmode = "hold"\n'
WATCH = "import fcc, sys\nfor record in fcc.Watcher(sys.argv[1]): print(record, flush=True)"
UNTIL_STOPPED = ["--seconds", "3600"]


def fly(
    fccd: Path,
    scratch: Path,
    config: str,
    *words: str | Path,
    before: tuple[str, ...] = (),
    environment: Mapping[str, str] | None = None,
) -> DaemonUnderTest:
    """Start a flight of the built-in aircraft; `before` is a program that starts it."""
    scratch.mkdir(exist_ok=True)
    path = scratch / "fccd.toml"
    path.write_text(f"[built-in]\nengage_at_s = 1.5\n{HOLD}{config}")
    starts: list[str | Path] = [*before, fccd, "fly", "--config", path, "--json"]
    return DaemonUnderTest([*starts, *UNTIL_STOPPED, *words], scratch, environment)


def a_full_disk(fccd: Path, scratch: Path) -> Ending:
    """Fly on a disk that is full after some seconds: no file may grow beyond 300 kB."""
    limited = ("prlimit", "--fsize=300000", "--")
    config = 'compression = "none"\n[telemetry]\nenabled = false\n'
    with fly(
        fccd,
        scratch,
        f'[recording]\nfolder = "{scratch}/recordings"\n{config}',
        before=limited,
    ) as daemon:
        daemon.wait_for("standby -> engaged")
        daemon.wait_for("recording stopped", within_s=60.0)
        for _ in range(2):
            assert daemon.next_state() == "engaged"
        return daemon.end(signal.SIGTERM)


def a_changed_configuration(fccd: Path, scratch: Path) -> Flown:
    """Fly while the configuration is overwritten with invalid text, and then emptied."""
    recordings = scratch / "recordings"
    with fly(fccd, scratch, "[telemetry]\nenabled = false\n", "--recordings", recordings) as daemon:
        daemon.wait_for("standby -> engaged")
        path = scratch / "fccd.toml"
        given = path.read_text()
        path.write_text("[loop]\nrate_hz = 7\n[nonsense")
        for _ in range(2):
            assert daemon.next_state() == "engaged"
        path.unlink()
        assert daemon.next_state() == "engaged"
        flown = Flown.of(daemon.end(signal.SIGTERM), recordings)
    assert attachments(flown.recording)["config-as-given.toml"].decode() == given
    return flown


def a_hung_watcher(fccd: Path, scratch: Path) -> Flown:
    """Fly while one program that watches is stopped and never reads again."""
    recordings, instance = scratch / "recordings", f"hung-{os.getpid()}"
    words = ("--recordings", recordings, "--instance", instance)
    with fly(fccd, scratch, f"[loop]\nrate_hz = {FAST_HZ}\n", *words) as daemon:
        daemon.wait_for("standby -> engaged")
        watcher = subprocess.Popen(
            [sys.executable, "-c", WATCH, instance],
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
        )
        assert watcher.stdout is not None
        watcher.stdout.readline()
        watcher.send_signal(signal.SIGSTOP)
        try:
            # More than fit into its buffer of 1,024 records.
            for _ in range(3):
                assert daemon.next_state() == "engaged"
            # A new watcher still gets the newest record.
            assert fcc.Watcher(instance).info["process_id"] == daemon.pid
            return Flown.of(daemon.end(signal.SIGTERM), recordings)
        finally:
            watcher.kill()
            watcher.wait()


def a_full_ring(faulty_fccd: Path, scratch: Path) -> Flown:
    """Fly at 1 kHz without reading the ring until it overflows."""
    recordings = scratch / "recordings"
    config = f"[loop]\nrate_hz = {FAST_HZ}\n[telemetry]\nenabled = false\n"
    paused = {"FCCD_PAUSE_AT_S": "3", "FCCD_PAUSE_S": str(2 * RING_S)}
    words = ("--recordings", recordings)
    with fly(faulty_fccd, scratch, config, *words, environment=paused) as daemon:
        daemon.wait_for("records lost", within_s=30.0)
        return Flown.of(daemon.end(signal.SIGTERM), recordings)


@pytest.fixture(scope="module")
def flights(
    fccd: Path, faulty_fccd: Path, tmp_path_factory: pytest.TempPathFactory
) -> dict[str, object]:
    """All flights, side by side."""
    scratch = tmp_path_factory.mktemp("host_environment")
    assert shutil.which("prlimit"), "install util-linux"
    made: dict[str, Callable[[], object]] = {
        "disk": lambda: a_full_disk(fccd, scratch / "disk"),
        "configuration": lambda: a_changed_configuration(fccd, scratch / "configuration"),
        "watcher": lambda: a_hung_watcher(fccd, scratch / "watcher"),
        "ring": lambda: a_full_ring(faulty_fccd, scratch / "ring"),
    }
    return at_once(made)


@pytest.mark.fault(
    "Around the flight",
    "disk full, nothing to delete",
    "failing write",
    "immediately; each 0.7 s",
    "reported; recording cut off: `fccd recover` finishes it; exit 14",
)
def test_a_disk_that_is_full_ends_the_recording_and_not_the_flight(
    flights: dict[str, object],
) -> None:
    ending = flights["disk"]
    assert isinstance(ending, Ending)
    assert ending.exit_code == NOT_RECORDED
    assert ending.states == ["standby -> engaged", "engaged -> stopped"]
    recording = ending.report["recording"]
    assert "all earlier ones are recorded" in recording["stopped"]
    (name,) = recording["files"]
    seen = in_sequence(Path(name))
    ticks = [message.content.tick.number for message in seen if message.topic == RECORD]
    assert len(ticks) == recording["ticks"] > 0
    # At the next write. What has gathered for it is lost.
    last_s = (ticks[-1] - ticks[0]) / NORMAL_HZ
    assert 0.0 <= ending.when("recording stopped") - last_s < WRITTEN_EVERY_S + AT_ONCE_S


@pytest.mark.fault(
    "Around the flight",
    "configuration file changed in flight",
    "none: read once",
    "",
    "nothing; used one is recorded",
)
def test_a_configuration_that_changes_in_flight_changes_nothing(
    fccd: Path, flights: dict[str, object]
) -> None:
    flown = flights["configuration"]
    assert isinstance(flown, Flown)
    assert flown.ending.exit_code == SUCCESS
    assert flown.ending.states == ["standby -> engaged", "engaged -> stopped"]
    assert_flown_again(fccd, flown)


@pytest.mark.fault(
    "Around the flight",
    "telemetry reader hung",
    "none",
    "",
    "only it misses records",
)
def test_a_watcher_that_hangs_loses_no_record_of_others(flights: dict[str, object]) -> None:
    flown = flights["watcher"]
    assert isinstance(flown, Flown)
    assert flown.ending.exit_code == SUCCESS
    assert flown.records[-1].records_dropped == 0
    assert len(flown.records) > 3 * FAST_HZ
    assert_regular(flown.records, 1_000_000_000 // FAST_HZ)


@pytest.mark.fault(
    "Around the flight",
    "ring full",
    "ring's room",
    "immediately",
    "records dropped, counted; exit 14",
)
def test_a_full_ring_drops_and_counts_records(flights: dict[str, object]) -> None:
    flown = flights["ring"]
    assert isinstance(flown, Flown)
    assert flown.ending.exit_code == NOT_RECORDED
    kinds = [event.kind.WhichOneof("kind") for event in flown.events]
    gap = flown.events[kinds.index("records_dropped")].kind.records_dropped
    assert gap.count == flown.records[-1].records_dropped > 0
    ticks = [record.tick.number for record in flown.records]
    lost = set(range(gap.first, gap.last + 1))
    assert lost.isdisjoint(ticks)
    assert {gap.first - 1, gap.last + 1} & set(ticks), "told where the gap is"
    # The loop never waited: before, in and after the gap it was engaged.
    after = [record for record in flown.records if record.tick.number > gap.last]
    assert after[0].state.phase == ENGAGED
    assert all(record.state.phase != FAILSAFE for record in flown.records)


@pytest.mark.fault(
    "Around the flight",
    "second instance started, same user and simulator",
    "lock on simulator's file",
    "immediately; with beacon: at the first",
    "takes no control, exit 12",
)
def test_a_second_daemon_does_not_fly_the_same_simulator(fccd: Path, tmp_path: Path) -> None:
    scratch = tmp_path / "second"
    scratch.mkdir()
    with flight(fccd, tmp_path) as (simulator, daemon):
        engage(simulator, daemon)
        begun_s = time.monotonic()
        with start(fccd, scratch, write_config(scratch, simulator.port)) as second:
            refused = second.end()
        assert time.monotonic() - begun_s < AT_ONCE_S
        assert refused.exit_code == TAKEN
        assert f"another fccd on this machine flies X-Plane at 127.0.0.1:{simulator.port}" in (
            refused.log
        )
        assert simulator.progress().overridden, "the first flies on"
        daemon.send(signal.SIGKILL)
        daemon.end()
        # A killed daemon leaves nothing that blocks the next.
        third_scratch = tmp_path / "third"
        third_scratch.mkdir()
        with start(fccd, third_scratch, write_config(third_scratch, simulator.port)) as third:
            third.wait_for("answers")
            assert third.end(signal.SIGTERM).exit_code == SUCCESS
        assert_released(simulator)
    assert only_recording(third_scratch / "recordings")


@pytest.mark.parametrize(("first", "second"), [("address", "beacon"), ("beacon", "address")])
def test_a_beacon_does_not_lead_to_a_simulator_under_control(
    fccd: Path, tmp_path: Path, beacon: tuple[str, int], first: str, second: str
) -> None:
    with StandInProcess(Settings(port=0, beacon=beacon)) as simulator:
        address = f"127.0.0.1:{simulator.port}"

        def daemon(way: str) -> DaemonUnderTest:
            scratch = tmp_path / way
            scratch.mkdir()
            config = write_config(scratch, simulator.port)
            if way == "beacon":
                config.write_text(config.read_text().replace(address, "beacon"))
            return start(fccd, scratch, config)

        with daemon(first) as flies:
            engage(simulator, flies)
            begun_s = time.monotonic()
            with daemon(second) as comes:
                refused = comes.end()
            took_s = time.monotonic() - begun_s
            assert took_s < AT_ONCE_S + (BEACON_PERIOD_S if second == "beacon" else 0.0)
            assert refused.exit_code == TAKEN
            assert f"another fccd on this machine flies X-Plane at {address}" in refused.log
            # It saw the switch on, and has not touched the controls.
            assert "engaged" not in refused.log
            assert simulator.progress().overridden
            assert simulator.releases() == []
            assert flies.next_state() == "engaged"
            assert flies.end(signal.SIGTERM).exit_code == SUCCESS
        assert_released(simulator)


def test_a_local_port_in_use_has_its_own_exit_code(fccd: Path, tmp_path: Path) -> None:
    """It has its own exit code, so that a service manager does not restart it in vain."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other:
        other.bind(("0.0.0.0", 0))
        port = other.getsockname()[1]
        config = write_config(tmp_path, 49_000, x_plane=f"local_port = {port}")
        with start(fccd, tmp_path, config) as daemon:
            refused = daemon.end()
    assert refused.exit_code == TAKEN
    assert f"cannot receive on UDP port {port}" in refused.log


@pytest.mark.fault(
    "Around the flight",
    "Ctrl-Z (SIGTSTP), terminal stops (SIGTTIN, SIGTTOU); SIGUSR1, SIGUSR2, SIGALRM",
    "signal; blocked",
    "immediately",
    "Ctrl-Z reported; flight or `fccd x-plane` continues",
)
def test_ctrl_z_does_not_stop_a_flight(fccd: Path, tmp_path: Path) -> None:
    with fly(fccd, tmp_path, "", "--recordings", tmp_path / "recordings") as daemon:
        daemon.wait_for("standby -> engaged")
        for stopping in (signal.SIGTSTP, signal.SIGTTIN, signal.SIGTTOU):
            daemon.send(stopping)
        daemon.wait_for("Ctrl-Z does not stop a flight; Ctrl-C ends it")
        for _ in range(2):
            assert daemon.next_state() == "engaged"
        ending = daemon.end(signal.SIGTERM)
    assert ending.exit_code == SUCCESS
    flown = Flown.of(ending, tmp_path / "recordings")
    assert_regular(flown.records, 1_000_000_000 // NORMAL_HZ)


def test_a_limit_on_file_sizes_prevents_telemetry_and_not_the_flight(
    fccd: Path, tmp_path: Path
) -> None:
    limited = ("prlimit", "--fsize=100000", "--")
    words = ("--no-recording", "--instance", f"limited-{os.getpid()}")
    with fly(fccd, tmp_path, "", *words, before=limited) as daemon:
        assert "LimitFSIZE" in daemon.wait_for("no live telemetry")
        daemon.wait_for("standby -> engaged")
        ending = daemon.end(signal.SIGTERM)
    assert ending.exit_code == SUCCESS
