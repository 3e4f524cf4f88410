"""Faults of the watchdog that guards a flight.

All flights are at the same time, and checked afterwards.
"""

from __future__ import annotations

from pathlib import Path

import pytest
from daemon_under_test import Ending, assert_released, engage, flight
from fault_flights import at_once

NOT_RELEASED = 5

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


@pytest.fixture(scope="module")
def endings(faulty_fccd: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Ending]:
    scratch = tmp_path_factory.mktemp("watchdog")
    return at_once(
        {
            "panics": lambda: hung(faulty_fccd, scratch / "panics", FCCD_RELEASE_FAILS="panics"),
            "blocks": lambda: hung(faulty_fccd, scratch / "blocks", FCCD_RELEASE_FAILS="blocks"),
        }
    )


@pytest.mark.fault(
    "The controller",
    "controller hangs, watchdog's release panics or never returns",
    "panic caught; separate thread",
    "immediately, 5 s",
    "exit 5; release helper releases",
)
def test_a_release_that_panics_or_never_returns_does_not_keep_the_program(
    endings: dict[str, Ending],
) -> None:
    for how in ("panics", "blocks"):
        assert endings[how].exit_code == NOT_RELEASED, how
    assert endings["panics"].report["released"] is False
    assert endings["blocks"].report == {}, "it had no time to print one"
