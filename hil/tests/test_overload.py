"""A loop whose ticks leave no time to sleep, and would keep all other threads off its CPU."""

from __future__ import annotations

import os
import signal
from pathlib import Path

import pytest
from daemon_under_test import DaemonUnderTest, assert_released, engage, flight
from fault_flights import Flown, assert_flown_again, assert_regular

OVERLOADED = 17
INTERRUPTED = 0

RATE_HZ = 100
PERIOD_NS = 1_000_000_000 // RATE_HZ
# 1.2 periods.
TAKES_MS = "12"
# Failsafe would release the controls and end the load.
NEVER_FAILSAFE = "[budget]\nfailsafe_after = 0\n"
RATE = f"[loop]\nrate_hz = {RATE_HZ}\n"
# It does not sleep in the tick: the core is busy.
SPINS = {"FCCD_SLOW_AT_S": "0", "FCCD_SLOW_MS": TAKES_MS, "FCCD_SLOW_SPINS": "1"}


@pytest.mark.fault(
    "Time",
    "ticks leave no time to sleep",
    "below 5 % of period left",
    "{overload.skip_after_ms} ms (`overload.skip_after_ms`)",
    "no early wake, then [deadlines skipped](#overload)",
)
def test_an_overloaded_core_answers_sigterm(fccd: Path, faulty_fccd: Path, tmp_path: Path) -> None:
    """On one CPU, with a real-time priority where it is granted."""
    config = tmp_path / "fccd.toml"
    config.write_text(
        '[built-in]\nengage_at_s = 1.5\n[guidance]\nmode = "hold"\n[telemetry]\nenabled = false\n'
        f"{RATE}{NEVER_FAILSAFE}[overload]\nstop_after_s = 0\n"
    )
    recordings = tmp_path / "recordings"
    words: list[str | Path] = ["taskset", "--cpu-list", str(min(os.sched_getaffinity(0)))]
    words += [faulty_fccd, "fly", "--config", config, "--json", "--recordings", recordings]
    with DaemonUnderTest(words, tmp_path, SPINS) as daemon:
        daemon.wait_for("deadlines are skipped")
        # The status line, each second.
        daemon.wait_for("  overload")
        # Answered within a second; the rest is the end of the recording, on a busy machine.
        flown = Flown.of(daemon.end(signal.SIGTERM, within_s=5.0), recordings)
    assert flown.ending.exit_code == INTERRUPTED
    assert flown.ending.report["ending"] == "interrupted by SIGTERM"
    assert flown.ending.report["unslept"] > 0
    # Each second deadline, at least, is skipped, and the others are served on time.
    began = next(e for e in flown.events if e.kind.WhichOneof("kind") == "overloaded")
    assert began.kind.overloaded.used_ns > PERIOD_NS
    skipping = [record for record in flown.records if record.tick.number > began.tick]
    assert skipping
    assert all(record.tick.missed >= 1 for record in skipping)
    assert_regular(flown.records, PERIOD_NS)
    assert_flown_again(fccd, flown)


@pytest.mark.fault(
    "Time",
    "ticks leave no time to sleep for long",
    "below 5 % of period left",
    "{overload.stop_after_s} s (`overload.stop_after_s`)",
    "released, exit 17",
)
def test_a_lasting_overload_ends_the_flight(fccd: Path, faulty_fccd: Path, tmp_path: Path) -> None:
    environment = {"FCCD_SLOW_AT_S": "1", "FCCD_SLOW_MS": "30"}
    others = f"{NEVER_FAILSAFE}[overload]\nstop_after_s = 1.0\n"
    with flight(faulty_fccd, tmp_path, others=others, environment=environment) as (
        simulator,
        daemon,
    ):
        engage(simulator, daemon)
        ending = daemon.end()
        assert_released(simulator)
    assert ending.exit_code == OVERLOADED
    assert ending.report["ending"] == "overloaded for too long"
    assert ending.report["released"] is True
    assert "engaged -> stopped" in ending.states
    assert any("deadlines are skipped" in text for text in ending.events)
    assert_flown_again(fccd, Flown.of(ending, tmp_path / "recordings"))
