"""Faults of the threads that guard a flight: the watchdog, and the one that writes the state file.

All flights are at the same time, and checked afterwards.
"""

from __future__ import annotations

import signal
from pathlib import Path

import pytest
from daemon_under_test import Ending, assert_released, engage, flight, wait_until
from fault_flights import at_once

NOT_RELEASED = 5
HUNG = 9

HANGS = {"FCCD_HANG_AT_S": "0.5"}
QUICK_WATCHDOG = """
[watchdog]
hang_after_ms = 500
[telemetry]
enabled = false
[realtime]
priority = 0
"""
"""Without a real-time priority: loops that hang at the same time would stop each other's."""


def hung(faulty_fccd: Path, scratch: Path, **environment: str) -> Ending:
    """Fly until the loop hangs, with another fault; the controls are released in the end."""
    scratch.mkdir()
    with flight(
        faulty_fccd, scratch, others=QUICK_WATCHDOG, environment={**HANGS, **environment}
    ) as (
        simulator,
        daemon,
    ):
        engage(simulator, daemon)
        ending = daemon.end(within_s=30.0)
        # Without the daemon, its release helper does it.
        assert_released(simulator)
    return ending


def state_file_thread_ends(faulty_fccd: Path, scratch: Path) -> Ending:
    """Fly until the state file is written although its first writer panicked."""
    scratch.mkdir()
    state = scratch / "state.flight"
    others = f'{QUICK_WATCHDOG}[restart]\nstate_file = "{state}"\n'
    environment = {"FCCD_STATE_PANICS": "1"}
    with flight(faulty_fccd, scratch, others=others, environment=environment) as (
        simulator,
        daemon,
    ):
        engage(simulator, daemon)
        wait_until(state.exists, "the state of the flight is on the disk")
        return daemon.end(signal.SIGTERM)


@pytest.fixture(scope="module")
def endings(faulty_fccd: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Ending]:
    scratch = tmp_path_factory.mktemp("watchdog")
    return at_once(
        {
            "ends": lambda: hung(faulty_fccd, scratch / "ends", FCCD_WATCHDOG_PANICS="1"),
            "panics": lambda: hung(faulty_fccd, scratch / "panics", FCCD_RELEASE_FAILS="panics"),
            "state": lambda: state_file_thread_ends(faulty_fccd, scratch / "state"),
            "blocks": lambda: hung(faulty_fccd, scratch / "blocks", FCCD_RELEASE_FAILS="blocks"),
        }
    )


def test_a_watchdog_that_ended_is_started_again(endings: dict[str, Ending]) -> None:
    ending = endings["ends"]
    assert "the watchdog had ended, and was started again" in ending.events
    assert ending.exit_code == HUNG
    assert ending.report["ending"] == "the loop hung"
    assert ending.report["released"] is True


def test_a_release_that_panics_or_never_returns_does_not_keep_the_program(
    endings: dict[str, Ending],
) -> None:
    for how in ("panics", "blocks"):
        assert endings[how].exit_code == NOT_RELEASED, how
    assert endings["panics"].report["released"] is False
    assert endings["blocks"].report == {}, "it had no time to print one"


def test_a_state_file_is_written_though_its_thread_ended(endings: dict[str, Ending]) -> None:
    events = endings["state"].events
    assert any("its thread had ended, and was started again" in text for text in events)
