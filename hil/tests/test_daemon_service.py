"""Notifications to systemd during a flight, and what it does if the loop hangs."""

from __future__ import annotations

import os
import signal
from pathlib import Path

from daemon_under_test import assert_released, engage, flight, wait_until
from service_manager import ServiceManager

SUCCESS = 0
WATCHDOG_S = 1.0
SILENCE_S = 3.0


def test_systemd_is_notified_of_start_states_and_end(fccd: Path, tmp_path: Path) -> None:
    with (
        ServiceManager() as manager,
        flight(fccd, tmp_path, environment=manager.environment(WATCHDOG_S)) as (simulator, daemon),
    ):
        assert manager.has_received("READY=1")
        assert manager.status.startswith("standby")
        for _ in range(3):
            assert manager.has_received("WATCHDOG=1")
        engage(simulator, daemon)
        assert manager.has_received("STATUS=engaged")
        for _ in range(3):
            assert manager.has_received("WATCHDOG=1")
        daemon.send(signal.SIGTERM)
        assert manager.has_received("STOPPING=1")
        ending = daemon.end()
        assert not manager.has_received("WATCHDOG=1", within_s=0.5)
    assert ending.exit_code == SUCCESS


def test_a_systemd_that_does_not_read_delays_nothing(fccd: Path, tmp_path: Path) -> None:
    with (
        ServiceManager() as manager,
        flight(fccd, tmp_path, environment=manager.environment(watchdog_s=0.1)) as (
            simulator,
            daemon,
        ),
    ):
        engage(simulator, daemon)
        # Long enough to fill all queues.
        for _ in range(5):
            daemon.next_state()
        ending = daemon.end(signal.SIGTERM)
        assert_released(simulator)
    assert ending.exit_code == SUCCESS
    assert ending.report["records_dropped"] == 0


def test_a_loop_that_hangs_sends_no_notification_and_is_released(
    faulty_fccd: Path, tmp_path: Path
) -> None:
    with ServiceManager() as manager:
        environment = {**manager.environment(WATCHDOG_S), "FCCD_HANG_AT_S": "1"}
        with flight(faulty_fccd, tmp_path, environment=environment) as (simulator, daemon):
            engage(simulator, daemon)
            manager.forget()
            assert manager.has_received("WATCHDOG=1")
            wait_until(
                lambda: not manager.has_received("WATCHDOG=1", within_s=SILENCE_S),
                "the watchdog's sign stops",
                within_s=60.0,
            )
            # What systemd does then, to every process of the service.
            for pid in [*_children(daemon.pid), daemon.pid]:
                os.kill(pid, signal.SIGABRT)
            daemon.end()
            assert_released(simulator)


def _children(pid: int) -> list[int]:
    """Return the child processes that are still running."""
    listed = (task.read_text().split() for task in Path(f"/proc/{pid}/task").glob("*/children"))
    return [int(child) for children in listed for child in children]
