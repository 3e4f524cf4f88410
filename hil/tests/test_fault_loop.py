"""Faults of the loop itself: late, stopped, slow, hung.

All flights are of the built-in aircraft, at the same time, and checked afterwards.
"""

from __future__ import annotations

import os
import signal
import subprocess
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import pytest
from daemon_under_test import DaemonUnderTest, assert_released, engage, flight
from fault_flights import (
    ENGAGED,
    FAILSAFE,
    NS,
    OVERRUN,
    Flown,
    assert_flown_again,
    assert_regular,
    at_once,
)

SUCCESS = 0
FAILSAFE_HAPPENED = 3
HUNG = 9

RATE_HZ = 40
ENGAGED_S = 6.0
PERIOD_NS = 1_000_000_000 // RATE_HZ
CONTROL = 4
"""The stage, as the recording calls it."""
HOLD = '[guidance]\nmode = "hold"\n[telemetry]\nenabled = false\n'
NEVER_FAILSAFE = "[budget]\nfailsafe_after = 0\n"
QUICK_WATCHDOG = "[watchdog]\nhang_after_ms = 500\n"
HANG_AFTER_NS = 500_000_000


def fly(
    fccd: Path,
    scratch: Path,
    environment: Mapping[str, str],
    config: str = "",
    before: Sequence[str] = (),
) -> DaemonUnderTest:
    """Start a flight of the built-in aircraft; `before` is a program that starts it."""
    scratch.mkdir()
    path = scratch / "fccd.toml"
    path.write_text(f"[built-in]\nengage_at_s = 1.5\n{HOLD}{config}")
    words: list[str | Path] = [*before, fccd, "fly", "--config", path, "--json"]
    words += ["--recordings", scratch / "recordings", "--seconds", str(ENGAGED_S)]
    return DaemonUnderTest(words, scratch, environment)


def flown(daemon: DaemonUnderTest, scratch: Path) -> Flown:
    return Flown.of(daemon.end(within_s=60.0), scratch / "recordings")


def broken(
    fccd: Path,
    scratch: Path,
    config: str = "",
    before: Sequence[str] = (),
    **environment: str,
) -> Flown:
    """Fly to the end with a fault inside the daemon."""
    with fly(fccd, scratch, environment, config, before) as daemon:
        return flown(daemon, scratch)


def stopped_for_a_while(fccd: Path, scratch: Path, seconds: float, config: str) -> Flown:
    """Fly, and stop the whole process in between, as a debugger or a laptop's lid does."""
    with fly(fccd, scratch, {}, config) as daemon:
        daemon.wait_for("standby -> engaged")
        time.sleep(1.0)
        daemon.send(signal.SIGSTOP)
        time.sleep(seconds)
        daemon.send(signal.SIGCONT)
        return flown(daemon, scratch)


def wall_clock_stepped(fccd: Path, scratch: Path) -> Flown:
    """Fly while the wall clock is set a day forwards and two days back."""
    shim = scratch.with_suffix(".so")
    source = Path(__file__).with_name("wall_clock.c")
    subprocess.run(["cc", "-shared", "-fPIC", "-O1", "-o", shim, source], check=True)
    with fly(fccd, scratch, {"LD_PRELOAD": str(shim)}) as daemon:
        return flown(daemon, scratch)


@pytest.fixture(scope="module")
def flights(
    fccd: Path, faulty_fccd: Path, tmp_path_factory: pytest.TempPathFactory
) -> dict[str, Flown]:
    """All flights, side by side."""
    scratch = tmp_path_factory.mktemp("loop")

    def slow(name: str, ms: int, ticks: int, config: str = "") -> Flown:
        return broken(
            faulty_fccd,
            scratch / name,
            config,
            FCCD_SLOW_AT_S="1",
            FCCD_SLOW_MS=str(ms),
            FCCD_SLOW_TICKS=str(ticks),
        )

    flown_at_once = at_once(
        {
            "late by one": lambda: slow("one", 60, 1),
            "late by many": lambda: slow("many", 300, 1),
            "late by far too many": lambda: slow("far", 900, 1),
            "overruns": lambda: slow("overruns", 30, 1_000),
            "a stage overruns": lambda: slow(
                "stage", 8, 1_000, "[budget]\ncontrol_us = 4000\nfailsafe_after = 10\n"
            ),
            "stopped": lambda: stopped_for_a_while(
                fccd, scratch / "stopped", 2.0, NEVER_FAILSAFE + QUICK_WATCHDOG
            ),
            "stopped for long": lambda: stopped_for_a_while(fccd, scratch / "long", 3.0, ""),
            "wall clock": lambda: wall_clock_stepped(fccd, scratch / "clock"),
            "a sensor blocks": lambda: broken(
                faulty_fccd, scratch / "blocks", QUICK_WATCHDOG, FCCD_BLOCK_AT_S="3"
            ),
        }
    )
    # By itself, and on one core: it spins at a real-time priority, and would take
    # half of a small machine from the others.
    one_core = ("taskset", "--cpu-list", str(min(os.sched_getaffinity(0))))
    hangs = broken(
        faulty_fccd, scratch / "hangs", QUICK_WATCHDOG, before=one_core, FCCD_HANG_AT_S="1"
    )
    return {**flown_at_once, "control hangs": hangs}


def phases(flight: Flown) -> set[int]:
    return {record.state.phase for record in flight.records}


def missed(flight: Flown) -> list[Any]:
    return [record for record in flight.records if record.tick.missed > 0]


@pytest.mark.fault(
    "Time",
    "timer late by one period",
    "missed deadlines counted",
    "immediately",
    "recorded, one event; phase kept",
)
@pytest.mark.parametrize(("name", "least"), [("late by one", 1), ("late by many", 10)])
def test_a_late_timer_is_counted_and_reported(
    flights: dict[str, Flown], name: str, least: int
) -> None:
    flight = flights[name]
    assert flight.ending.exit_code == SUCCESS
    assert FAILSAFE not in phases(flight)
    # The tick that took so long, and what was due meanwhile.
    assert sum(record.tick.missed for record in missed(flight)) >= least
    assert flight.records[-1].overruns >= 1
    # Of several within a second only the first has an event of its own, on a busy machine a
    # timer that woke late.
    first = ("tick overran its budget", "the timer woke")
    assert any(kind in text for text in flight.texts() for kind in first)
    assert any("ticks overran or were missed" in text for text in flight.texts())
    assert_regular(flight.records, PERIOD_NS)


@pytest.mark.fault(
    "Time",
    "timer late by many periods",
    "missed deadlines counted",
    "immediately",
    "recorded, one event; phase kept; half a second: failsafe",
)
def test_half_a_second_of_missed_periods_is_failsafe(flights: dict[str, Flown]) -> None:
    flight = flights["late by far too many"]
    assert flight.ending.exit_code == FAILSAFE_HAPPENED
    (place,) = flight.failsafes
    record = flight.records[place]
    assert record.state.cause == OVERRUN
    assert record.tick.missed >= RATE_HZ // 2
    assert record.sent, "wings level at once"
    assert_regular(flight.records, PERIOD_NS)


@pytest.mark.fault(
    "Time",
    "tick overruns, or a stage",
    "stage times against [`[budget]`](#overruns)",
    "tick's end; `budget.failsafe_after` in a row",
    "recorded, event with stage and duration; then failsafe",
)
def test_overruns_in_a_row_are_failsafe(flights: dict[str, Flown]) -> None:
    flight = flights["overruns"]
    assert flight.ending.exit_code == FAILSAFE_HAPPENED
    place = flight.failsafes[0]
    record = flight.records[place]
    assert record.state.cause == OVERRUN
    # Reported once, with the stage, and each counted in its own record.
    told = [
        event.kind.overrun for event in flight.events if event.kind.WhichOneof("kind") == "overrun"
    ]
    assert 1 <= len(told) <= 2
    assert told[-1].longest == CONTROL
    assert told[-1].took_ns > 30_000_000
    assert told[-1].budget_ns == PERIOD_NS
    before = [r.stages.total_ns > PERIOD_NS for r in flight.records[: place + 1]]
    assert record.overruns == sum(before)
    # Half a second of them, missed ones included, with those of a busy machine before.
    row = 0
    for record in reversed(flight.records[:place]):
        if record.stages.total_ns <= PERIOD_NS:
            break
        row += 1 + record.tick.missed
    assert row + flight.records[place].tick.missed >= RATE_HZ // 2
    assert row <= 2 * RATE_HZ // 2
    assert_regular(flight.records, PERIOD_NS)


def test_a_stage_that_overruns_is_named(flights: dict[str, Flown]) -> None:
    flight = flights["a stage overruns"]
    assert flight.ending.exit_code == FAILSAFE_HAPPENED
    assert any("control overran its budget: " in text for text in flight.texts())
    assert flight.records[flight.failsafes[0]].state.cause == OVERRUN


def test_a_stopped_process_continues(flights: dict[str, Flown]) -> None:
    """Its own watchdog was stopped too, and does not fire."""
    flight = flights["stopped"]
    assert flight.ending.exit_code == SUCCESS
    assert max(record.tick.missed for record in flight.records) >= 1.5 * RATE_HZ
    assert flight.records[-2].state.phase == ENGAGED
    assert any("the timer woke" in text for text in flight.texts())
    assert_regular(flight.records, PERIOD_NS)
    long = flights["stopped for long"]
    assert long.ending.exit_code == FAILSAFE_HAPPENED
    assert long.records[long.failsafes[0]].state.cause == OVERRUN


@pytest.mark.fault(
    "Time",
    "clock stepped",
    "none: loop reads no wall clock",
    "",
    "nothing",
)
def test_a_wall_clock_that_is_set_is_not_noticed(flights: dict[str, Flown]) -> None:
    flight = flights["wall clock"]
    assert flight.ending.exit_code == SUCCESS
    assert flight.failsafes == []
    assert_regular(flight.records, PERIOD_NS)
    times = [record.tick.woke_ns for record in flight.records]
    assert times == sorted(times)
    assert (times[-1] - times[0]) * NS == pytest.approx(7.5, abs=1.0)
    assert flight.ending.report["recording"]["stopped"] is None


@pytest.mark.fault(
    "The controller",
    "controller hangs, on the only core, or in a sensor's read",
    "[watchdog](#the-watchdog)",
    "1 s",
    "watchdog releases; recording saved, exit 9",
)
@pytest.mark.parametrize("name", ["control hangs", "a sensor blocks"])
def test_a_loop_that_hangs_is_ended_and_its_recording_is_finished(
    flights: dict[str, Flown], name: str
) -> None:
    flight = flights[name]
    assert flight.ending.exit_code == HUNG
    assert flight.ending.report["ending"] == "the loop hung"
    assert flight.ending.report["released"] is True
    last = flight.events[-1]
    assert last.kind.WhichOneof("kind") == "hung"
    # It checks ten times in that time, and counts at most two checks for one.
    assert HANG_AFTER_NS <= last.kind.hung.silent_ns < 1.2 * HANG_AFTER_NS
    assert "the watchdog released the controls" in flight.ending.log
    # All up to the tick that hangs, which has no end and so no record.
    assert [record.tick.number for record in flight.records][-1] == last.tick
    assert flight.records[-1].state.phase == ENGAGED
    assert_regular(flight.records, PERIOD_NS)


@pytest.mark.fault(
    "The controller",
    "controller hangs, main thread too",
    "[watchdog](#the-watchdog)",
    "1 s, plus 3 s",
    "released; exit 9; recording unfinished",
)
def test_a_loop_that_hangs_is_ended_though_the_main_thread_hangs_too(
    faulty_fccd: Path, tmp_path: Path
) -> None:
    """It cannot finish the recording."""
    environment = {"FCCD_HANG_AT_S": "2", "FCCD_PAUSE_AT_S": "3"}
    with fly(faulty_fccd, tmp_path / "both", environment, QUICK_WATCHDOG) as daemon:
        ending = daemon.end(within_s=60.0)
    assert ending.exit_code == HUNG
    assert ending.report == {}, "it had no time to print one"


@pytest.mark.parametrize("name", ["overruns", "late by far too many", "stopped", "control hangs"])
def test_a_replay_is_identical(fccd: Path, flights: dict[str, Flown], name: str) -> None:
    assert_flown_again(fccd, flights[name])


def test_the_controls_of_a_loop_that_hangs_are_released(faulty_fccd: Path, tmp_path: Path) -> None:
    environment = {"FCCD_HANG_AT_S": "1"}
    with flight(faulty_fccd, tmp_path, others=QUICK_WATCHDOG, environment=environment) as (
        simulator,
        daemon,
    ):
        engage(simulator, daemon)
        ending = daemon.end()
        assert_released(simulator)
    assert ending.exit_code == HUNG
    assert ending.report["released"] is True
    assert ending.events[-2] == "the loop hung: no progress for 0.5 s"
