"""The daemon among other programs of its machine: whatever they do, the controls are released."""

from __future__ import annotations

import contextlib
import fcntl
import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from daemon_under_test import (
    assert_released,
    engage,
    flight,
    start,
    wait_until,
    write_config,
)
from other_user import NOBODY, as_user, needs_two_users
from test_release_helper import CUT_OFF, kill_helpers

from fcc_hil.fly import ENGAGE_SWITCH
from fcc_hil.process import StandInProcess
from fcc_hil.standin import Settings

SUCCESS = 0
TAKEN = 12

# Listens at abstract names with queues that are full: whoever connects waits.
SQUATTER = """
import socket, sys, time
held = []
for name in sys.argv[1:]:
    for kind in (socket.SOCK_STREAM, socket.SOCK_DGRAM):
        s = socket.socket(socket.AF_UNIX, kind)
        try:
            s.bind("\\0" + name)
        except OSError:
            continue
        held.append(s)
        if kind == socket.SOCK_STREAM:
            s.listen(0)
            full = socket.socket(socket.AF_UNIX, kind)
            full.connect("\\0" + name)
            held.append(full)
print("ready", flush=True)
time.sleep(600)
"""


@contextlib.contextmanager
def squatter(*names: str) -> Iterator[None]:
    """Let another user take names of the abstract namespace."""
    words = as_user(NOBODY)
    with subprocess.Popen(
        [*words, sys.executable, "-I", "-c", SQUATTER, *names], stdout=subprocess.PIPE, cwd="/"
    ) as process:
        assert process.stdout is not None
        try:
            assert process.stdout.readline() == b"ready\n"
            yield
        finally:
            process.kill()


@needs_two_users
def test_another_user_can_neither_prevent_a_start_nor_block_it(fccd: Path, tmp_path: Path) -> None:
    with StandInProcess(Settings(port=0)) as simulator:
        plant = f"X-Plane at 127.0.0.1:{simulator.port}"
        config = write_config(tmp_path, simulator.port)
        with squatter(f"fccd/{plant}", f"fccd-release-helper-{plant}"):
            with start(fccd, tmp_path, config) as daemon:
                engage(simulator, daemon)
                # Longer than the interval at which an earlier helper is looked for.
                time.sleep(1.5)
                assert daemon.end(signal.SIGTERM, within_s=8.0).exit_code == SUCCESS
            assert_released(simulator)
            simulator.write(ENGAGE_SWITCH, 0.0)
            with start(fccd, tmp_path, config) as daemon:
                engage(simulator, daemon)
                daemon.end(signal.SIGKILL)
            wait_until(lambda: not simulator.progress().overridden, "the helper releases")


@needs_two_users
def test_a_folder_of_another_user_is_refused_and_the_flight_is_flown(
    fccd: Path, tmp_path: Path
) -> None:
    theirs = tmp_path / "theirs"
    theirs.mkdir(mode=0o700)
    os.chown(theirs, NOBODY, NOBODY)
    with flight(fccd, tmp_path, environment={"RUNTIME_DIRECTORY": str(theirs)}) as (
        simulator,
        daemon,
    ):
        daemon.wait_for(f"the folder {theirs} is not used: it belongs to user {NOBODY}")
        engage(simulator, daemon)
        assert daemon.end(signal.SIGTERM).exit_code == SUCCESS
        assert_released(simulator)
    assert list(theirs.iterdir()) == []


def test_a_run_folder_that_is_removed_in_flight_is_made_anew(fccd: Path, tmp_path: Path) -> None:
    """With lock and mark, and the lock of the helper: nobody else can fly, and both may die."""
    run = tmp_path / "run"
    run.mkdir(mode=0o700)
    environment = {"RUNTIME_DIRECTORY": str(run)}
    with flight(fccd, tmp_path, environment=environment) as (simulator, daemon):
        engage(simulator, daemon)
        (helper,) = daemon.helpers()
        shutil.rmtree(run)
        words = daemon.wait_for("was removed in flight, and was made anew")
        assert f"locks X-Plane at 127.0.0.1:{simulator.port}" in words
        wait_until(lambda: any(run.glob("*.helper")), "the helper's lock")
        (tmp_path / "second").mkdir()
        config = write_config(tmp_path / "second", simulator.port)
        with start(fccd, tmp_path / "second", config, environment) as second:
            assert second.end().exit_code == TAKEN
        assert daemon.next_state() == "engaged"
        os.kill(helper, signal.SIGSTOP)
        daemon.end(signal.SIGKILL)
        os.kill(helper, signal.SIGKILL)
        simulator.write(ENGAGE_SWITCH, 0.0)
        with start(fccd, tmp_path / "second", config, environment) as again:
            assert "they are released" in again.wait_for(CUT_OFF)
            wait_until(lambda: not simulator.progress().overridden, "they are")
            assert again.end(signal.SIGTERM).exit_code == SUCCESS


def _can_mount() -> bool:
    test = ["unshare", "--mount", "mount", "-t", "tmpfs", "tmpfs", "/mnt"]
    return (
        os.geteuid() == 0 and subprocess.run(test, capture_output=True, check=False).returncode == 0
    )


@contextlib.contextmanager
def memory_to_fill(folder: Path) -> Iterator[Path]:
    """Mount a little memory, and give the file that fills it."""
    folder.mkdir()
    subprocess.run(["mount", "-t", "tmpfs", "-o", "size=1m", "tmpfs", folder], check=True)
    try:
        yield folder / "filler"
    finally:
        subprocess.run(["umount", "--lazy", folder], check=True)


def fill(filler: Path) -> None:
    with contextlib.suppress(OSError), filler.open("wb", buffering=0) as file:
        while True:
            file.write(bytes(4096))


@pytest.mark.skipif(not _can_mount(), reason="mounting is not permitted here")
@pytest.mark.parametrize("fills", ["before the start", "before the takeover"])
def test_what_is_held_is_stored_when_the_run_folder_is_full(
    fccd: Path, tmp_path: Path, fills: str
) -> None:
    """What needs space is written before control is taken, and a failure is said."""
    memory = tmp_path / "memory"
    run = memory / "run"
    environment = {"RUNTIME_DIRECTORY": str(run)}
    without_telemetry = "[telemetry]\nenabled = false"
    with memory_to_fill(memory) as filler:
        run.mkdir(mode=0o700)
        if fills == "before the start":
            fill(filler)
        with flight(fccd, tmp_path, others=without_telemetry, environment=environment) as (
            simulator,
            daemon,
        ):
            plant = f"X-Plane at 127.0.0.1:{simulator.port}"
            if fills == "before the start":
                cannot = daemon.wait_for(f"that {plant} is held cannot be stored (No space left")
                assert "release the controls by hand" in cannot
                filler.unlink()
            daemon.wait_until_ready()
            if fills == "before the takeover":
                fill(filler)
            engage(simulator, daemon)
            daemon.send(signal.SIGSTOP)
            kill_helpers(daemon)
            daemon.end(signal.SIGKILL)
            simulator.write(ENGAGE_SWITCH, 0.0)
            with start(fccd, tmp_path, tmp_path / "fccd.toml", environment) as again:
                assert "they are released" in again.wait_for(CUT_OFF)
                wait_until(lambda: not simulator.progress().overridden, "they are")
                assert again.end(signal.SIGTERM).exit_code == SUCCESS


def test_a_mark_that_is_overwritten_in_flight_is_stored_again(fccd: Path, tmp_path: Path) -> None:
    run = tmp_path / "run"
    run.mkdir(mode=0o700)
    environment = {"RUNTIME_DIRECTORY": str(run)}
    with flight(fccd, tmp_path, environment=environment) as (simulator, daemon):
        engage(simulator, daemon)
        plant = f"X-Plane at 127.0.0.1:{simulator.port} in "
        (mark,) = (file for file in run.iterdir() if file.name.removeprefix(plant).isdigit())
        taken = mark.read_bytes()
        mark.write_bytes(bytes(len(taken)))
        wait_until(lambda: mark.read_bytes() == taken, "it is stored again")
        daemon.send(signal.SIGSTOP)
        kill_helpers(daemon)
        daemon.end(signal.SIGKILL)
        simulator.write(ENGAGE_SWITCH, 0.0)
        with start(fccd, tmp_path, tmp_path / "fccd.toml", environment) as again:
            assert "they are released" in again.wait_for(CUT_OFF)
            wait_until(lambda: not simulator.progress().overridden, "they are")


def test_a_place_that_another_daemon_took_meanwhile_is_said(fccd: Path, tmp_path: Path) -> None:
    run = tmp_path / "run"
    run.mkdir(mode=0o700)
    environment = {"RUNTIME_DIRECTORY": str(run)}
    with flight(fccd, tmp_path, environment=environment) as (simulator, daemon):
        engage(simulator, daemon)
        (lock,) = (path for path in run.glob("X-Plane*") if path.suffix != ".helper")
        # As another daemon that locks it does.
        with (run / "theirs").open("w") as theirs:
            (run / "theirs").chmod(0o600)
            fcntl.flock(theirs, fcntl.LOCK_EX)
            (run / "theirs").rename(lock)
            words = daemon.wait_for("was removed in flight, and cannot be made anew")
            assert "another fccd locked it meanwhile" in words
        daemon.wait_for("was removed in flight, and was made anew")
        ending = daemon.end(signal.SIGTERM)
    assert ending.exit_code == SUCCESS
    assert sum("cannot be made anew" in text for text in ending.events) == 1
