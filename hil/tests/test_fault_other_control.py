"""X-Plane's own autopilot, and simulators that run too fast."""

from __future__ import annotations

import signal
import time
from pathlib import Path

import pytest
from daemon_under_test import (
    DaemonUnderTest,
    assert_released,
    engage,
    flight,
    wait_until,
)

from fcc_hil.fly import ENGAGE_SWITCH
from fcc_hil.process import StandInProcess
from fcc_hil.truth import COLUMNS

SUCCESS = 0

SAMPLED_WITHIN_S = 0.3
LEVER = 0.35


def refuse(simulator: StandInProcess, daemon: DaemonUnderTest, why: str) -> None:
    """Switch off and on, and be refused for this reason."""
    simulator.write(ENGAGE_SWITCH, 0.0)
    time.sleep(SAMPLED_WITHIN_S)
    simulator.write(ENGAGE_SWITCH, 1.0)
    assert why in daemon.wait_for("not engaged: ")
    simulator.write(ENGAGE_SWITCH, 0.0)


def truth_now(simulator: StandInProcess) -> dict[str, float]:
    return dict(zip(COLUMNS, simulator.progress().now, strict=True))


@pytest.mark.fault(
    "Simulator and link",
    "X-Plane's autopilot, time more than 2.2 times as fast",
    "[what else acts](x-plane.md#what-else-acts-on-the-controls)",
    "at most 3 s",
    "engaging refused; in flight event",
)
def test_x_planes_own_autopilot_refuses_engaging_and_is_reported_in_flight(
    fccd: Path, tmp_path: Path
) -> None:
    with flight(fccd, tmp_path) as (simulator, daemon):
        daemon.wait_until_ready()
        simulator.act("servos:1")
        refuse(simulator, daemon, "another autopilot is on")
        simulator.act("servos:0")
        daemon.wait_until_ready()
        engage(simulator, daemon)
        simulator.act("servos:1")
        daemon.wait_for("now: another autopilot is on")
        simulator.act("servos:0")
        daemon.wait_for("no longer: another autopilot is on")
        simulator.act(f"lever:{LEVER}")
        simulator.write(ENGAGE_SWITCH, 0.0)
        daemon.wait_for("engaged -> standby")
        assert "35 %" in daemon.wait_for("the throttle follows its lever again")
        simulator.act("servos:1")
        assert "another autopilot is on" in daemon.wait_for("not ready: ")
        ending = daemon.end(signal.SIGTERM)
        assert_released(simulator)
    assert ending.exit_code == SUCCESS


def test_twice_as_fast_is_flown_and_four_times_as_fast_refused(fccd: Path, tmp_path: Path) -> None:
    with flight(fccd, tmp_path) as (simulator, daemon):
        daemon.wait_until_ready()
        simulator.act("speed:2")
        engage(simulator, daemon)
        before = truth_now(simulator)
        wait_until(
            lambda: truth_now(simulator)["time_s"] > before["time_s"] + 12.0,
            "12 s of the simulator's time",
        )
        after = truth_now(simulator)
        assert abs(after["altitude_ft"] - before["altitude_ft"]) < 15.0
        assert abs(after["roll_deg"]) < 3.0
        simulator.act("speed:4")
        daemon.wait_for("now: simulator time runs more than twice as fast")
        simulator.write(ENGAGE_SWITCH, 0.0)
        daemon.wait_for("engaged -> standby")
        refuse(simulator, daemon, "simulator time runs more than twice as fast")
        ending = daemon.end(signal.SIGTERM)
    assert ending.exit_code == SUCCESS
    assert not [text for text in ending.events if "failsafe" in text]
