"""The pilot turns X-Plane's altimeter while the daemon flies: nothing moves."""

from __future__ import annotations

import random
import signal
from pathlib import Path

import numpy as np
import pytest
from daemon_under_test import DaemonUnderTest, engage, flight, wait_until

from fcc_hil.process import StandInProcess
from fcc_hil.standin import Settings
from fcc_hil.udp import free_port

X_PLANE_11, X_PLANE_12 = 115_501, 121_000
"""The first has no pressure altitude: it comes from the pilot's altimeter and its setting."""
ROWS = (1, 3, 4, 16, 17, 18, 20, 21)
LARGEST_MOVE_FT = 5.0
TURNS = 24


def turn_at_random(simulator: StandInProcess, seed: int) -> None:
    """Turn the knob for about eight seconds: far at once, or a few clicks, one after the other."""
    pick = random.Random(seed)
    setting = 29.92
    for _ in range(TURNS):
        if pick.random() < 0.5:
            setting = round(pick.uniform(28.5, 31.0), 2)
            simulator.act(f"knob:{setting:.2f}")
        else:
            click = pick.choice((-0.01, 0.01))
            for _ in range(pick.randint(2, 10)):
                setting += click
                simulator.act(f"knob:{setting:.2f}")
        fly_on(simulator, pick.uniform(0.02, 0.6))


def fly_on(simulator: StandInProcess, seconds: float) -> None:
    """Wait until this time of the flight has passed."""
    until_s = simulator.progress().time_s + seconds
    wait_until(lambda: simulator.progress().time_s >= until_s, "time passes")


def held(simulator: StandInProcess, daemon: DaemonUnderTest, seed: int) -> float:
    """Engage and turn the knob; return by how much the aircraft climbed and sank, ft."""
    engage(simulator, daemon)
    engaged_s = simulator.progress().time_s
    turn_at_random(simulator, seed)
    truth = simulator.truth()
    altitude_ft = truth["altitude_ft"][truth["time_s"] >= engaged_s]
    return float(np.ptp(altitude_ft))


@pytest.mark.parametrize("version", [X_PLANE_11, X_PLANE_12])
def test_a_knob_turned_at_any_moment_moves_nothing(
    fccd: Path, tmp_path: Path, version: int
) -> None:
    settings = Settings(port=0, version=version, qnh_inhg=29.7)
    with flight(fccd, tmp_path, settings) as (simulator, daemon):
        moved_ft = held(simulator, daemon, version)
        ending = daemon.end(signal.SIGTERM)
    assert ending.states == ["standby -> engaged", "engaged -> stopped"]
    assert moved_ft < LARGEST_MOVE_FT
    assert "does not send" not in ending.log


def test_a_knob_turned_with_rows_as_input_moves_nothing(fccd: Path, tmp_path: Path) -> None:
    """The indicated altitude comes in row 20, the setting as a dataref in other datagrams."""
    port = free_port()
    settings = Settings(port=0, data_target=("127.0.0.1", port), data_rows=ROWS)
    rows = f'input = "data"\nlocal_port = {port}\ndata_version = 11\n'
    with flight(fccd, tmp_path, settings, x_plane=rows) as (simulator, daemon):
        moved_ft = held(simulator, daemon, 1)
        ending = daemon.end(signal.SIGTERM)
    assert ending.states == ["standby -> engaged", "engaged -> stopped"]
    assert moved_ft < LARGEST_MOVE_FT


@pytest.mark.fault(
    "Simulator and link",
    "altimeter setting missing or not 22 to 33 inHg, where altitude needs it",
    "no altitude",
    "{failsafe.sensor_max_age_ms} ms",
    "failsafe",
)
def test_an_altimeter_without_a_plausible_setting_is_no_altitude(
    fccd: Path, tmp_path: Path
) -> None:
    with flight(fccd, tmp_path, Settings(port=0, version=X_PLANE_11)) as (simulator, daemon):
        engage(simulator, daemon)
        simulator.act("knob:20.5")
        failsafe = daemon.wait_for("engaged -> failsafe")
        assert "altitude is missing or too old" in failsafe
