"""A flight watched by Python, by `fccd top`, and by many watchers that are killed."""

from __future__ import annotations

import itertools
import json
import math
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import fcc
import numpy as np
import pytest
from daemon_under_test import DaemonUnderTest, wait_until
from other_user import as_user, needs_two_users

SUCCESS = 0
FAILURE = 1
PATIENCE_S = 15.0
WATCH = "import fcc, sys\nfor record in fcc.Watcher(sys.argv[1]): print(record)"

# What the built-in aircraft begins with (config/built-in.toml).
ALTITUDE_M = 3_000 * 0.3048
AIRSPEED_MPS = 100 * 1852 / 3600


@pytest.fixture
def instance(request: pytest.FixtureRequest) -> str:
    """Return a name that no other daemon has."""
    return f"t{os.getpid()}-{abs(hash(request.node.name)) % 10**6}"


def fly(fccd: Path, scratch: Path, instance: str, config: str = "") -> DaemonUnderTest:
    path = scratch / "fccd.toml"
    path.write_text(f'[built-in]\nengage_at_s = 1.5\n[guidance]\nmode = "hold"\n{config}')
    words: list[str | Path] = [fccd, "fly", "--config", path, "--instance", instance, "--json"]
    return DaemonUnderTest([*words, "--seconds", "600"], scratch)


def watch(instance: str, daemon: DaemonUnderTest) -> fcc.Watcher:
    """Watch as soon as the daemon publishes."""
    daemon.wait_for("standby -> engaged")
    return fcc.Watcher(instance)


def watch_again(instance: str) -> fcc.Watcher:
    """Watch, also where a busy machine made the daemon start its publisher again."""
    deadline_s = time.monotonic() + PATIENCE_S
    while True:
        try:
            return fcc.Watcher(instance)
        except fcc.TelemetryError:
            if time.monotonic() > deadline_s:
                raise


def snapshot(fccd: Path, instance: str) -> subprocess.CompletedProcess[str]:
    words: list[str | Path] = [fccd, "top", "--instance", instance, "--json"]
    return subprocess.run(words, capture_output=True, text=True, check=False, timeout=PATIENCE_S)


@needs_two_users
def test_users_have_separate_shared_memory(fccd: Path, tmp_path: Path, instance: str) -> None:
    """Two daemons of one name, of two users: each is watched by its own."""
    uid = 65_534 - os.getpid() % 1_000
    with tempfile.TemporaryDirectory(dir="/var/tmp") as folder:
        theirs = Path(folder)
        program = theirs / "fccd"
        shutil.copy(fccd, program)
        os.chown(theirs, uid, uid)

        def as_them(*words: str) -> subprocess.CompletedProcess[str]:
            return subprocess.run(
                [*as_user(uid), *words],
                cwd=theirs,
                capture_output=True,
                text=True,
                check=False,
                timeout=PATIENCE_S,
            )

        top = (str(program), "top", "--json", "--instance", instance)
        short = ("--instance", instance, "--seconds", "0.5", "--quiet")
        with fly(fccd, tmp_path, instance) as daemon:
            daemon.wait_for("standby -> engaged")
            nobody = as_them(*top)
            assert nobody.returncode == FAILURE
            # A guess: other tests have daemons of other users at the same time.
            assert re.search(rf"sudo -u \S+ fccd top --instance {instance}", nobody.stderr)
            flown = as_them(str(program), "fly", *short)
            assert flown.returncode == SUCCESS, flown.stderr
            assert "no live telemetry" not in flown.stderr
            assert json.loads(snapshot(fccd, instance).stdout)["process_id"] == daemon.pid

            # A user is named who has the daemon, and none who only has a folder.
            theirs_alone = f"{instance}-theirs"
            words = [*as_user(uid), str(program), "fly", "--quiet", "--no-recording"]
            options = ["--seconds", "600", "--instance", theirs_alone]
            assert "for this user" not in snapshot(fccd, theirs_alone).stderr
            with subprocess.Popen(
                [*words, *options],
                cwd=theirs,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
            ) as other:
                try:
                    named = f"sudo -u '#{uid}' fccd top --instance {theirs_alone}"
                    wait_until(
                        lambda: named in snapshot(fccd, theirs_alone).stderr, "they are named"
                    )
                finally:
                    other.terminate()
            assert Path(f"/dev/shm/fccd-run-{uid}").is_dir()
            wait_until(
                lambda: "for this user" not in snapshot(fccd, theirs_alone).stderr,
                "they are no longer named",
            )

        place = Path(f"/dev/shm/fccd-run-{uid}")
        assert (place.stat().st_uid, place.stat().st_mode & 0o777) == (uid, 0o700)
        # One of another user is reported, and not used; the flight is flown.
        shutil.rmtree(place)
        place.mkdir()
        flown = as_them(str(program), "fly", *short)
        place.rmdir()
        assert flown.returncode == SUCCESS
        assert f"{place} is not used: it belongs to user 0 and not to user {uid}" in flown.stderr


def test_python_reads_the_flight(fccd: Path, tmp_path: Path, instance: str) -> None:
    records: list[np.void] = []
    with fly(fccd, tmp_path, instance) as daemon:
        watcher = watch(instance, daemon)
        assert watcher.info["rate_hz"] == 40.0
        assert watcher.info["process_id"] == daemon.pid
        assert watcher.info["timer"] == "timerfd"

        def has_come() -> bool:
            records.extend(watcher.records())
            return len(records) >= 80

        wait_until(has_come, "80 records have come")
        events = [event.text for event in watcher.events()]
        taken = snapshot(fccd, instance)
        ending = daemon.end(signal.SIGTERM)
    # One record for each tick, in order.
    for last, record in itertools.pairwise(records):
        assert record["tick"] == last["tick"] + 1 + record["missed"]
        assert record["scheduled_ns"] - last["scheduled_ns"] == round(record["dt_s"] * 1e9)
    newest = records[-1]
    assert fcc.STATES[newest["state"]] == "engaged"
    assert newest["sent"] == 1
    assert newest["engage_inhibits"] == 0
    assert newest["engage_switch"] == 1
    # It holds what it began with: noisy sensors, still air.
    assert newest["altitude_m"] == pytest.approx(ALTITUDE_M, abs=15.0)
    assert newest["desired_altitude_m"] == pytest.approx(ALTITUDE_M, abs=15.0)
    assert newest["airspeed_mps"] == pytest.approx(AIRSPEED_MPS, abs=3.0)
    assert math.cos(newest["heading_rad"]) > math.cos(math.radians(5.0))
    assert newest["specific_force_z_mps2"] == pytest.approx(-9.81, abs=2.0)
    assert newest["attitude_taken_ns"] == newest["woke_ns"]
    assert 0.0 < newest["commanded_throttle"] <= 1.0
    assert 0 < newest["total_time_ns"] < 25_000_000
    assert "standby -> engaged" in events
    assert ending.exit_code == SUCCESS

    assert taken.returncode == SUCCESS, taken.stderr
    seen = json.loads(taken.stdout)
    assert seen["tick"]["state"] == "engaged"
    assert seen["tick"]["actual"]["altitude_ft"] == pytest.approx(3_000, abs=50)
    assert seen["run"]["watchers"] >= 1
    assert seen["run"]["not_published"] == 0
    assert [event["text"] for event in seen["events"]] == events


def test_what_is_promised_at_once_is_there_on_a_busy_machine(
    fccd: Path, tmp_path: Path, instance: str
) -> None:
    """The newest record and status, and the past events."""
    busy = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(5)]
    try:
        with fly(fccd, tmp_path, instance) as daemon:
            watch(instance, daemon)
            less = 0
            for _ in range(60):
                watcher = watch_again(instance)
                events = [event.text for event in watcher.events()]
                found = (watcher.status(0.0), watcher.latest(0.0))
                less += "standby -> engaged" not in events or any(of is None for of in found)
            # A publisher that was just started again has no status for a second, in which
            # several of them look. Before, one watcher of four found less: 15 of these.
            assert less <= 7
    finally:
        for process in busy:
            process.kill()
            process.wait()


def test_without_a_daemon_top_reports_it(fccd: Path, instance: str) -> None:
    asked = snapshot(fccd, instance)
    assert asked.returncode == FAILURE
    # How it goes on depends on whether other users' daemons were here.
    assert f"no fccd named '{instance}' runs here" in asked.stderr


def test_two_daemons_of_one_name_both_fly(fccd: Path, tmp_path: Path, instance: str) -> None:
    scratch = tmp_path / "second"
    scratch.mkdir()
    with fly(fccd, tmp_path, instance) as first:
        first.wait_for("standby -> engaged")
        with fly(fccd, scratch, instance) as second:
            second.wait_for("another fccd publishes as")
            second.wait_for("standby -> engaged")
            assert second.end(signal.SIGTERM).exit_code == SUCCESS
        assert fcc.Watcher(instance).info["process_id"] == first.pid


def test_a_killed_daemon_leaves_its_name(fccd: Path, tmp_path: Path, instance: str) -> None:
    with fly(fccd, tmp_path, instance) as first:
        watch(instance, first)
        first.end(signal.SIGKILL)
    with fly(fccd, tmp_path, instance) as second:
        assert watch(instance, second).info["process_id"] == second.pid
        assert "no live telemetry" not in second.log


def test_fifty_watchers_some_killed_lose_no_record(
    fccd: Path, tmp_path: Path, instance: str
) -> None:
    came, at_once = 50, 10
    with fly(fccd, tmp_path, instance, "[loop]\nrate_hz = 1000\n") as daemon:
        daemon.wait_for("standby -> engaged")
        here: list[subprocess.Popen[Any]] = []
        for number in range(came):
            words: list[str | Path] = (
                [fccd, "top", "--instance", instance, "--json"]
                if number % 2
                else [sys.executable, "-c", WATCH, instance]
            )
            here.append(
                subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            )
            time.sleep(0.05)
            if len(here) > at_once:
                _end(here.pop(0))
        for process in here:
            _end(process)
        ending = daemon.end(signal.SIGTERM)
    assert ending.exit_code == SUCCESS
    assert ending.report["records_dropped"] == 0
    assert ending.report["failsafes"] == 0
    assert "live telemetry" not in ending.log


def _end(process: subprocess.Popen[Any]) -> None:
    process.kill()
    process.wait()
