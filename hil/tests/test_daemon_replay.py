"""A flight of JSBSim, recorded by the daemon and replayed from its file."""

from __future__ import annotations

import json
import signal
import subprocess
from pathlib import Path
from typing import Any

from daemon_under_test import DaemonUnderTest, engage, write_config

from fcc_hil.fly import ENGAGE_SWITCH
from fcc_hil.process import StandInProcess
from fcc_hil.standin import Mode, Settings

LEAST_OUTPUTS_PER_TICK = 34
"""Surfaces, set points with mode and progress, estimate, step, state, inhibits, faults, sent."""

SUCCESS = 0
FAILSAFE = 3
USAGE = 2
"""Also for a file that is no recording."""

QUICK_PATTERN = 'mode = "timed-pattern"\nhold_s = 2.0\nleg_s = 3.0'


def replay(fccd: Path, *words: str | Path) -> tuple[int, dict[str, Any]]:
    """Run `fccd replay` and return its exit code and what it found."""
    done = subprocess.run(
        [fccd, "replay", *words, "--json"], capture_output=True, text=True, check=False
    )
    return done.returncode, json.loads(done.stdout) if done.stdout else {}


def test_a_replay_of_a_flight_is_identical(fccd: Path, tmp_path: Path) -> None:
    """With the pattern, a switch, a silent simulator and a signal."""
    recordings = tmp_path / "recordings"
    with StandInProcess(Settings(port=0)) as simulator:
        config = write_config(
            tmp_path,
            simulator.port,
            others="[failsafe]\nhold_s = 1.0\nall_silent_s = 1.0",
            guidance=QUICK_PATTERN,
        )
        words: list[str | Path] = [fccd, "run", "--config", config, "--json"]
        words += ["--recordings", recordings]
        with DaemonUnderTest(words, tmp_path) as daemon:
            engage(simulator, daemon)
            for _ in range(7):  # seconds: a status line each
                daemon.next_state()
            simulator.write(ENGAGE_SWITCH, 0.0)
            daemon.wait_for("engaged -> standby")
            engage(simulator, daemon)
            simulator.set_mode(Mode.FROZEN)
            daemon.wait_for("engaged -> failsafe")
            daemon.wait_for("failsafe -> standby")
            simulator.set_mode(Mode.RUNNING)
            daemon.wait_until_ready()
            ending = daemon.end(signal.SIGTERM)
    assert ending.exit_code == FAILSAFE

    (recording,) = recordings.glob("*.mcap")
    exit_code, found = replay(fccd, recording)
    assert exit_code == SUCCESS, found
    assert found["identity"]["differing"] == 0
    assert found["unflown"] is None
    assert found["cuts"] == []
    assert found["ticks"] == ending.report["timing"]["ticks"] > 400
    per_tick, rest = divmod(found["identity"]["outputs"], found["ticks"])
    assert rest == 0
    assert per_tick >= LEAST_OUTPUTS_PER_TICK

    # The recorded configuration is identical; another is not.
    exit_code, found = replay(fccd, recording, "--config", config)
    assert exit_code == SUCCESS
    assert all(quantity["differing"] == 0 for quantity in found["deviation"]["quantities"])
    config.write_text(config.read_text() + "[autopilot.altitude]\npitch_rate_gain = 0.5\n")
    exit_code, found = replay(fccd, recording, "--config", config)
    assert exit_code == SUCCESS
    differing = {q["name"] for q in found["deviation"]["quantities"] if q["differing"] > 0}
    assert differing == {"commanded elevator"}


def test_a_file_that_is_not_a_recording_is_refused(fccd: Path, tmp_path: Path) -> None:
    other = tmp_path / "other.mcap"
    other.write_bytes(b"not a recording")
    exit_code, found = replay(fccd, other)
    assert exit_code == USAGE
    assert "not an MCAP file" in found["error"]
