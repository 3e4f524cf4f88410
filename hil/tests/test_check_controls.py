"""`fccd check-controls` against the stand-in, parked: its yoke is read back."""

from __future__ import annotations

import json
import signal
import socket
import subprocess
import time
from pathlib import Path
from typing import Any

import pytest
from daemon_under_test import engage, flight, write_config

from fcc_hil.person import CUES
from fcc_hil.process import StandInProcess
from fcc_hil.settings import Settings, Start

SUCCESS, TAKEN, CONTROLS_NOT_CHECKED = 0, 12, 20
REVERSES_ROLL, CENTRES_AILERONS = 7, 11
"""Steps of `fccd x-plane check` in which the stand-in misbehaves so."""
PARKED = Start(runway_elevation_ft=0.0)
FLYING = Start()


def check(
    fccd: Path, scratch: Path, *, misbehaves_in: int | None = None, start: Start = PARKED
) -> tuple[int, dict[str, Any]]:
    """Check the controls without a person; return the exit code and what is printed."""
    steps = () if misbehaves_in is None else (misbehaves_in,)
    settings = Settings(port=0, version=121_000, person=True, misbehaves_in=steps, start=start)
    with StandInProcess(settings) as simulator:
        for step in steps:
            cue = f"CMND\0{CUES}{step}/begin\0".encode()
            with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
                sender.sendto(cue, ("127.0.0.1", simulator.port))
        config = write_config(scratch, simulator.port)
        done = subprocess.run(
            [fccd, "check-controls", config, "--json"],
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            timeout=120.0,
            check=False,
        )
        assert not simulator.progress().overridden, done.stderr
        printed: dict[str, Any] = json.loads(done.stdout)
        assert printed["released"], done.stderr
    return done.returncode, printed


def verdicts(printed: dict[str, Any], control: str) -> list[str]:
    return [one["verdict"] for one in printed["movements"] if one["control"] == control]


def test_right_controls_are_told_from_a_reversed_one(fccd: Path, tmp_path: Path) -> None:
    exit_code, printed = check(fccd, tmp_path)
    assert exit_code == SUCCESS
    for control in ("elevator", "aileron", "rudder"):
        assert verdicts(printed, control) == ["ok", "ok"]
    exit_code, printed = check(fccd, tmp_path, misbehaves_in=REVERSES_ROLL)
    assert exit_code == CONTROLS_NOT_CHECKED
    assert verdicts(printed, "aileron") == ["reversed", "reversed"]
    assert verdicts(printed, "elevator") == ["ok", "ok"]


def test_ailerons_that_stay_centred_have_no_effect(fccd: Path, tmp_path: Path) -> None:
    exit_code, printed = check(fccd, tmp_path, misbehaves_in=CENTRES_AILERONS)
    assert exit_code == CONTROLS_NOT_CHECKED
    assert verdicts(printed, "aileron") == ["no-effect", "no-effect"]
    assert verdicts(printed, "rudder") == ["ok", "ok"]


def test_an_aircraft_that_flies_is_refused(fccd: Path, tmp_path: Path) -> None:
    exit_code, printed = check(fccd, tmp_path, start=FLYING)
    assert exit_code == CONTROLS_NOT_CHECKED
    assert printed["movements"] == []
    assert "the aircraft moves" in printed["error"]


@pytest.mark.parametrize("sent", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_releases(fccd: Path, tmp_path: Path, sent: signal.Signals) -> None:
    with StandInProcess(Settings(port=0, version=121_000, start=PARKED)) as simulator:
        config = write_config(tmp_path, simulator.port)
        running = subprocess.Popen(
            [fccd, "check-controls", config, "--json"],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
        )
        give_up_s = time.monotonic() + 60.0
        while not simulator.progress().overridden:
            assert time.monotonic() < give_up_s
            time.sleep(0.02)
        running.send_signal(sent)
        printed, log = running.communicate(timeout=60.0)
        assert running.returncode == CONTROLS_NOT_CHECKED, log
        assert json.loads(printed)["released"]
        assert not simulator.progress().overridden


def test_a_daemon_that_flies_keeps_its_controls(fccd: Path, tmp_path: Path) -> None:
    scratch = tmp_path / "check"
    scratch.mkdir()
    with flight(fccd, tmp_path) as (simulator, daemon):
        engage(simulator, daemon)
        config = write_config(scratch, simulator.port)
        refused = subprocess.run(
            [fccd, "check-controls", config],
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            timeout=60.0,
            check=False,
        )
        assert refused.returncode == TAKEN, refused.stderr
        assert "another fccd on this machine flies X-Plane" in refused.stderr
        assert simulator.progress().overridden
        assert daemon.is_running
