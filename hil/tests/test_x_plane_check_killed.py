"""`fccd x-plane check` and `identify`, killed or stopped while X-Plane's controls are held."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from daemon_under_test import engage, helpers_of, start, wait_until, write_config
from test_release_helper import CUT_OFF

from fcc_hil.cockpit import OVERRIDE_JOYSTICK, OVERRIDE_THROTTLES
from fcc_hil.process import StandInProcess
from fcc_hil.settings import Settings

PATIENCE_S = 60.0
TAKEN = 12


@contextlib.contextmanager
def holding(
    fccd: Path, scratch: Path, *words: str
) -> Iterator[tuple[StandInProcess, subprocess.Popen[bytes]]]:
    """Run `fccd x-plane ...` until both overrides are set."""
    with StandInProcess(Settings(port=0, version=121_000, person=True)) as simulator:
        config = write_config(scratch, simulator.port)
        with (scratch / "err").open("wb") as err:
            process = subprocess.Popen(
                [str(fccd), "x-plane", *words, "--config", str(config)],
                cwd=scratch,
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=err,
            )
        try:
            wait_until(lambda: are_set(simulator, 1.0), "the overrides are set", PATIENCE_S)
            yield simulator, process
        finally:
            process.kill()
            process.wait()


def are_set(simulator: StandInProcess, value: float) -> bool:
    return all(simulator.read(path) == value for path in (OVERRIDE_JOYSTICK, OVERRIDE_THROTTLES))


def test_what_a_killed_check_has_started_ends_and_releases(fccd: Path, tmp_path: Path) -> None:
    with holding(fccd, tmp_path, "check", "--yes", "--only", "11") as (simulator, check):
        check.kill()
        check.wait()
        # The engage switch stays on: only the end of the daemon releases the controls.
        wait_until(lambda: are_set(simulator, 0.0), "the controls are released")


def test_a_deflection_of_a_killed_identification_is_released(fccd: Path, tmp_path: Path) -> None:
    with holding(fccd, tmp_path, "identify", "--by-hand") as (simulator, identification):
        identification.kill()
        identification.wait()
        wait_until(lambda: are_set(simulator, 0.0), "the controls are released")


def test_a_deflection_is_released_by_the_next_start_if_its_helper_is_killed_too(
    fccd: Path, tmp_path: Path
) -> None:
    with holding(fccd, tmp_path, "identify", "--by-hand") as (simulator, identification):
        (helper,) = helpers_of(identification.pid)
        os.kill(helper, signal.SIGKILL)
        identification.kill()
        identification.wait()
        time.sleep(1.0)
        assert are_set(simulator, 1.0)
        with start(fccd, tmp_path, tmp_path / "fccd.toml") as daemon:
            assert "they are released" in daemon.wait_for(CUT_OFF)
            wait_until(lambda: are_set(simulator, 0.0), "the controls are released")


@pytest.mark.parametrize("words", [("identify", "--by-hand"), ("check", "--yes")])
def test_nothing_is_deflected_or_checked_that_another_daemon_flies(
    fccd: Path, tmp_path: Path, words: tuple[str, ...]
) -> None:
    """Exit code 12: another program uses the simulator."""
    with StandInProcess(Settings(port=0, version=121_000)) as simulator:
        config = write_config(tmp_path, simulator.port)
        with start(fccd, tmp_path, config) as daemon:
            engage(simulator, daemon)
            found = subprocess.run(
                [fccd, "x-plane", *words, "--config", config],
                cwd=tmp_path,
                stdin=subprocess.DEVNULL,
                capture_output=True,
                text=True,
                timeout=20.0,
                check=False,
            )
            assert "another fccd flies this X-Plane: end it first" in found.stderr
            assert found.returncode == TAKEN
            assert not list(tmp_path.glob("x-plane-check.*"))
            assert are_set(simulator, 1.0)
            assert "engaged -> " not in daemon.log


def test_ctrl_z_does_not_stop_a_deflection(fccd: Path, tmp_path: Path) -> None:
    with holding(fccd, tmp_path, "identify", "--by-hand") as (simulator, identification):
        identification.send_signal(signal.SIGTSTP)
        wait_until(lambda: are_set(simulator, 0.0), "the controls are released")
        wait_until(lambda: "Ctrl-Z does not stop" in (tmp_path / "err").read_text(), "its message")
        identification.send_signal(signal.SIGINT)
        assert identification.wait(PATIENCE_S) == 1
