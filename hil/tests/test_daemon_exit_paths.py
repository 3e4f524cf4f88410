"""On every exit path X-Plane has its controls back, as seen by X-Plane."""

from __future__ import annotations

import math
import os
import resource
import signal
import time
from pathlib import Path

import pytest
from daemon_under_test import assert_released, engage, flight, wait_until
from fault_flights import AT_ONCE_S, ENGAGED, NS, Flown, assert_in_the_same_tick

from fcc_hil.cockpit import OVERRIDE_JOYSTICK
from fcc_hil.fly import ENGAGE_SWITCH

# As in `fccd --help`.
SUCCESS = 0
FAILSAFE = 3
PANICKED = 6


@pytest.mark.fault(
    "Around the flight",
    "SIGTERM, Ctrl-C (SIGINT), Ctrl-\\ (SIGQUIT), terminal hangs up (SIGHUP; continues under "
    "`nohup`)",
    "stop flag",
    "next tick",
    "centred, released, confirmed; exit 0",
)
@pytest.mark.parametrize(
    ("number", "by"),
    [
        (signal.SIGTERM, "SIGTERM"),
        (signal.SIGINT, "Ctrl-C (SIGINT)"),
        (signal.SIGQUIT, "Ctrl-\\ (SIGQUIT)"),
        (signal.SIGHUP, "the end of its terminal (SIGHUP)"),
    ],
)
def test_a_signal_centres_and_releases(
    fccd: Path, tmp_path: Path, number: signal.Signals, by: str
) -> None:
    with flight(fccd, tmp_path) as (simulator, daemon):
        engage(simulator, daemon)
        told_ns = time.monotonic_ns()
        ending = daemon.end(number)
        assert_released(simulator)
    assert ending.exit_code == SUCCESS
    assert ending.states == ["standby -> engaged", "engaged -> stopped"]
    assert ending.report["timing"]["rate_hz"] == 40.0
    assert ending.report["timing"]["ticks"] > 0
    assert ending.report["flight"] is None, "a hold has no legs to score"
    assert ending.report["ending"] == f"interrupted by {by}"
    assert ending.report["released"] is True
    assert ending.report["failsafes"] == 0
    assert "Accept incoming connections" not in ending.log
    events = Flown.of(ending, tmp_path / "recordings").events
    heard = next(event for event in events if event.kind.WhichOneof("kind") == "stop_requested")
    assert (heard.time_ns - told_ns) * NS < AT_ONCE_S


def test_signals_without_a_meaning_do_not_end_a_flight(fccd: Path, tmp_path: Path) -> None:
    with flight(fccd, tmp_path) as (simulator, daemon):
        engage(simulator, daemon)
        for number in (signal.SIGUSR1, signal.SIGUSR2, signal.SIGALRM):
            daemon.send(number)
        time.sleep(0.3)
        ending = daemon.end(signal.SIGTERM)
        assert_released(simulator)
    assert ending.exit_code == SUCCESS
    assert ending.report["ending"] == "interrupted by SIGTERM"


@pytest.mark.fault(
    "The controller",
    "controller panics",
    "caught around tick",
    "immediately",
    "centred, released; exit 6",
)
def test_a_panic_in_control_centres_and_releases(faulty_fccd: Path, tmp_path: Path) -> None:
    with flight(faulty_fccd, tmp_path, environment={"FCCD_PANIC_AT_S": "1"}) as (simulator, daemon):
        engage(simulator, daemon)
        ending = daemon.end()
        assert_released(simulator)
    assert ending.exit_code == PANICKED
    assert ending.report["released"] is True
    assert "injected panic" in ending.report["ending"]
    assert "a part of the loop panicked" in ending.events
    assert ending.states == ["standby -> engaged", "engaged -> stopped"]
    flown = Flown.of(ending, tmp_path / "recordings")
    assert flown.records[-2].state.phase == ENGAGED
    assert_in_the_same_tick(flown, len(flown.records) - 1, after_s=1.0)


@pytest.mark.fault(
    "The controller",
    "controller returns NaN",
    "outputs checked",
    "immediately",
    "never sent; failsafe",
)
def test_an_output_that_is_not_a_number_is_never_sent(faulty_fccd: Path, tmp_path: Path) -> None:
    with flight(
        faulty_fccd,
        tmp_path,
        others="[failsafe]\nhold_s = 1.0",
        environment={"FCCD_NAN_AT_S": "1"},
    ) as (simulator, daemon):
        engage(simulator, daemon)
        daemon.wait_for("engaged -> failsafe: invalid output")
        daemon.wait_for("failsafe -> standby")
        assert_released(simulator)
        ending = daemon.end(signal.SIGTERM)
        # The stand-in refuses values that are not finite; there must be none.
        assert simulator.status()["last_refusals"] == []
        assert all(math.isfinite(write.value) for write in simulator.journal())
    assert ending.exit_code == FAILSAFE
    assert ending.report["failsafes"] == 1
    flown = Flown.of(ending, tmp_path / "recordings")
    assert_in_the_same_tick(flown, flown.failsafes[0], after_s=1.0)


@pytest.mark.fault(
    "Around the flight",
    "SIGKILL",
    "release helper: its pipe ends",
    "immediately",
    "helper centres and releases",
)
def test_a_killed_daemon_leaves_a_helper_that_centres_and_releases(
    fccd: Path, tmp_path: Path
) -> None:
    with flight(fccd, tmp_path) as (simulator, daemon):
        engage(simulator, daemon)
        # A helper that is killed is replaced, and the new one knows what is held.
        (helper,) = daemon.helpers()
        os.kill(helper, signal.SIGKILL)
        daemon.wait_for("the release helper had ended, and was started again")
        (again,) = daemon.helpers()
        assert again != helper
        killed_at_s = simulator.progress().time_s
        ending = daemon.end(signal.SIGKILL)
        assert_released(simulator)
        assert simulator.releases()[0].time_s - killed_at_s < AT_ONCE_S
        wait_until(
            lambda: "fccd release-helper: the daemon has ended" in daemon.log,
            "the helper's message",
        )
    assert ending.exit_code == -signal.SIGKILL


def test_a_release_is_confirmed_although_nothing_can_be_opened(fccd: Path, tmp_path: Path) -> None:
    """The daemon has had the socket for it since it took control."""
    with flight(fccd, tmp_path) as (simulator, daemon):
        engage(simulator, daemon)
        time.sleep(0.5)
        most = resource.prlimit(daemon.pid, resource.RLIMIT_NOFILE)
        resource.prlimit(daemon.pid, resource.RLIMIT_NOFILE, (0, most[1]))
        ending = daemon.end(signal.SIGTERM)
        assert_released(simulator)
    assert ending.exit_code == SUCCESS
    assert (
        f"X-Plane at 127.0.0.1:{simulator.port} confirmed the release of its controls"
        in "\n".join(ending.events)
    )


def test_a_stack_size_of_the_environment_has_no_effect(fccd: Path, tmp_path: Path) -> None:
    with flight(fccd, tmp_path, environment={"RUST_MIN_STACK": "1"}) as (simulator, daemon):
        engage(simulator, daemon)
        ending = daemon.end(signal.SIGTERM)
        assert_released(simulator)
    assert ending.exit_code == SUCCESS


def test_switching_off_releases_and_returns_to_standby(fccd: Path, tmp_path: Path) -> None:
    with flight(fccd, tmp_path) as (simulator, daemon):
        engage(simulator, daemon)
        simulator.write(ENGAGE_SWITCH, 0.0)
        daemon.wait_for("engaged -> standby")
        assert_released(simulator)
        engage(simulator, daemon)
        assert daemon.is_running
        simulator.write(ENGAGE_SWITCH, 0.0)
        daemon.wait_for("engaged -> standby")
        ending = daemon.end(signal.SIGTERM)
        joystick = [r for r in simulator.releases() if r.path == OVERRIDE_JOYSTICK]
    assert len(joystick) == 2
    assert ending.exit_code == SUCCESS


def test_switching_off_ends_the_program_if_configured(fccd: Path, tmp_path: Path) -> None:
    with flight(fccd, tmp_path, others='[engage]\nswitch_off = "stop"') as (simulator, daemon):
        engage(simulator, daemon)
        simulator.write(ENGAGE_SWITCH, 0.0)
        ending = daemon.end()
        assert_released(simulator)
    assert ending.exit_code == SUCCESS
    assert ending.report["ending"] == "switched off"
