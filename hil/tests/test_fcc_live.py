"""A running daemon, watched from Python and given commands."""

from __future__ import annotations

import itertools
import json
import os
import signal
import subprocess
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import fcc
import numpy as np
import pytest
from daemon_under_test import DaemonUnderTest, wait_until

PATIENCE_S = 15.0
FAILURE = 1
USAGE = 2
REFUSED = 11


@pytest.fixture
def instance(request: pytest.FixtureRequest) -> str:
    """Return a name that no other daemon has."""
    return f"p{os.getpid()}-{abs(hash(request.node.name)) % 10**6}"


def fly(fccd: Path, scratch: Path, instance: str, config: str = "") -> DaemonUnderTest:
    path = scratch / "fccd.toml"
    path.write_text(f'[built-in]\nengage_at_s = 1.5\n[guidance]\nmode = "hold"\n{config}')
    words: list[str | Path] = [fccd, "fly", "--config", path, "--instance", instance, "--json"]
    return DaemonUnderTest([*words, "--recordings", scratch, "--seconds", "600"], scratch)


def command(fccd: Path, instance: str, *words: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [fccd, "command", *words, "--instance", instance],
        capture_output=True,
        text=True,
        check=False,
        timeout=60.0,
    )


def test_records_events_and_status_arrive(fccd: Path, tmp_path: Path, instance: str) -> None:
    with fly(fccd, tmp_path, instance) as daemon:
        daemon.wait_for("standby -> engaged")
        watcher = fcc.Watcher(instance)
        assert watcher.info["process_id"] == daemon.pid
        assert watcher.info["rate_hz"] == 40.0
        newest = watcher.latest(timeout_s=PATIENCE_S)
        assert newest is not None
        assert newest["state"] == fcc.STATES.index("engaged")
        assert newest["altitude_m"] == pytest.approx(3_000 * 0.3048, abs=20.0)
        ticks = [int(record["tick"]) for record in itertools.islice(watcher, 10)]
        missed = ticks[-1] - ticks[0] + 1 - len(ticks)
        assert missed >= 0
        assert ticks == sorted(set(ticks))
        rows: list[np.void] = []

        def has_come() -> bool:
            rows.extend(watcher.records())
            return len(rows) >= 40

        wait_until(has_come, "40 records have come")
        engaged = ["standby -> engaged", "mode: hold, was none"]
        texts = [event.text for event in watcher.events()]
        assert [text for text in texts if text in engaged] == engaged
        status = watcher.status(PATIENCE_S)
        assert status is not None
        assert status["not_published"] == 0
        daemon.end(signal.SIGKILL)
        with pytest.raises(fcc.TelemetryError, match="has ended"):
            for _ in watcher:
                pass
        with pytest.raises(fcc.TelemetryError, match="has ended"):
            watcher.latest(0.0)
        assert not watcher.is_alive


def test_commands_are_carried_out_or_refused_with_the_reason(
    fccd: Path, tmp_path: Path, instance: str
) -> None:
    with fly(fccd, tmp_path, instance) as daemon:
        daemon.wait_for("standby -> engaged")
        watcher, commander = fcc.Watcher(instance), fcc.Commander(instance)
        tick = commander.set(heading_rad=1.0, altitude_m=950.0)

        def aims() -> tuple[float, float]:
            newest = watcher.latest(PATIENCE_S)
            assert newest is not None
            return newest["desired_heading_rad"], newest["desired_altitude_m"]

        wait_until(lambda: aims() == pytest.approx((1.0, 950.0)), "the set points are the new ones")
        assert commander.disengage() > tick
        with pytest.raises(fcc.CommandError, match="accepted only while engaged"):
            commander.set(airspeed_mps=50.0)
        # The altimeter can be set in every state.
        assert commander.set(altimeter_setting_pa=102_000.0) > tick
        with pytest.raises(fcc.CommandError, match=r"altimeter\.field_elevation_ft"):
            commander.set(height_m=300.0)
        assert command(fccd, instance, "set", "--altimeter-inhg", "30.12").returncode == 0
        engaged = commander.engage()
        assert engaged > tick
        told = daemon.wait_for("command: heading 57.3°")
        assert told
        # The word on the command line is the same order.
        assert command(fccd, instance, "set", "--heading-deg", "90").returncode == 0
        printed = command(fccd, instance, "disengage", "--json")
        assert json.loads(printed.stdout)["carried_out"] is True
        refused = command(fccd, instance, "set", "--airspeed-kt", "100")
        assert refused.returncode == REFUSED
        assert "accepted only while engaged" in refused.stderr
        wrong = command(fccd, instance, "set", "--airspeed-kt", "-3")
        assert wrong.returncode == USAGE
        assert "airspeed is" in wrong.stderr
        assert command(fccd, instance, "set").returncode == USAGE
        commander.stop()
        ending = daemon.end()
    assert ending.report["ending"] == "stopped by command"
    assert ending.exit_code == 0
    with pytest.raises(fcc.TelemetryError, match="no fccd named"):
        commander.engage()


def test_a_stop_of_an_engaged_flight_waits_until_it_has_stopped(
    fccd: Path, tmp_path: Path, instance: str
) -> None:
    with fly(fccd, tmp_path, instance) as daemon, ThreadPoolExecutor() as beside:
        daemon.wait_for("standby -> engaged")
        commander = fcc.Commander(instance)
        stops = beside.submit(command, fccd, instance, "stop", "--json")
        daemon.wait_for("levelling and trimming before the release")
        for begin in (commander.engage, lambda: commander.set(heading_rad=1.0)):
            with pytest.raises(fcc.CommandError, match="it is stopping"):
                begin()
        stopped = stops.result()
        ending = daemon.end()
    assert stopped.returncode == 0
    assert json.loads(stopped.stdout)["carried_out"] is True
    assert ending.report["ending"] == "stopped by command"


def test_a_daemon_without_commands_is_reported(fccd: Path, tmp_path: Path, instance: str) -> None:
    with fly(fccd, tmp_path, instance, "[telemetry]\ncommands = false\n") as daemon:
        daemon.wait_for("standby -> engaged")
        with pytest.raises(fcc.TelemetryError, match="accepts no commands"):
            fcc.Commander(instance)
        assert command(fccd, instance, "engage").returncode == FAILURE
        assert fcc.Watcher(instance).is_alive


def test_without_a_daemon_each_raises_an_error(fccd: Path, instance: str) -> None:
    for connect in (fcc.Watcher, fcc.Commander):
        with pytest.raises(fcc.TelemetryError, match=f"no fccd named '{instance}' runs here"):
            connect(instance)
        with pytest.raises(ValueError, match="is not a valid instance name"):
            connect("left/wing")
    refused = command(fccd, instance, "stop")
    assert refused.returncode == FAILURE
    assert f"no fccd named '{instance}'" in refused.stderr


def test_a_refused_engagement_gives_the_inhibits(fccd: Path, tmp_path: Path, instance: str) -> None:
    path = tmp_path / "fccd.toml"
    # Nobody is there to be flown.
    path.write_text('[x-plane]\nsimulator = "127.0.0.1:9"\n')
    words: list[str | Path] = [fccd, "run", "--config", path, "--instance", instance, "--json"]
    with DaemonUnderTest([*words, "--recordings", tmp_path], tmp_path) as daemon:
        daemon.wait_for("no measurements yet")
        commander = fcc.Commander(instance)
        with pytest.raises(fcc.CommandError, match="attitude is missing or too old"):
            commander.engage()
        commander.stop()
        assert daemon.end().report["ending"] == "stopped by command"
