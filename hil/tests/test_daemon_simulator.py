"""Faults of simulators: end, pause, hang, reload, ignore writes."""

from __future__ import annotations

import os
import signal
import socket
import time
from pathlib import Path

import pytest
from daemon_under_test import (
    assert_released,
    engage,
    flight,
    start,
    switch_on,
    wait_until,
    write_config,
)
from fault_flights import AT_ONCE_S, NS, Flown
from read_only_simulator import ReadOnlySimulator
from test_daemon_commands import run

from fcc_hil.fly import ENGAGE_SWITCH
from fcc_hil.process import StandInProcess
from fcc_hil.standin import Mode, Settings

SUCCESS = 0
FAILURE = 1
FAILSAFE = 3
REFUSED = 11

TOO_OLD = "attitude is missing or too old"
MAX_SILENCE_S = 0.3
"""As configured; the default is 30 s."""
SAID_AFTER_S = 1.5
"""Silent after half a second, and for another second."""
ASKED_EVERY_S = 1.0
"""Interval of requests to a silent simulator."""
AGAIN_AFTER_S = 0.25
"""Interval between releases, until confirmed."""
PAUSED = 1
"""The plant's state, as the recording calls it."""
SHORT_SILENCE = f"[failsafe]\nall_silent_s = {MAX_SILENCE_S}\n"
SHORT_FAILSAFE = f"{SHORT_SILENCE}hold_s = 1.0\n"


def assert_lost_when_too_old(flown: Flown, place: int) -> None:
    record = flown.records[place]
    age_s = (record.tick.woke_ns - record.measurements.attitude.taken_ns) * NS
    assert MAX_SILENCE_S < age_s < MAX_SILENCE_S + AT_ONCE_S


def assert_released_at_once(flown: Flown, since_ns: int) -> None:
    (released,) = [
        event for event in flown.events if event.kind.WhichOneof("kind") == "released_at_once"
    ]
    assert 0.0 < (released.time_ns - since_ns) * NS < AT_ONCE_S
    later = [record for record in flown.records if record.tick.number >= released.tick]
    assert not any(record.sent for record in later)


@pytest.mark.fault(
    "Simulator and link",
    "requested value never arrives: mistyped, lacking in this version, row off",
    "not arrived while others have",
    "4 to 6 s; 5 s if it arrived before",
    "reported once",
)
def test_an_engage_switch_that_x_plane_does_not_have_is_named(fccd: Path, tmp_path: Path) -> None:
    mistyped = "sim/cockpit2/switches/generic_light_switch[0]"
    with flight(fccd, tmp_path, x_plane=f'engage_switch = "{mistyped}"') as (_, daemon):
        assert mistyped in daemon.wait_for("answers")
        # The stand-in also lacks another dataref, which nothing depends on.
        words = daemon.wait_for("does not send x-plane.engage_switch")
        assert f'"{mistyped}"' in words
        ending = daemon.end(signal.SIGTERM)
    assert ending.exit_code == SUCCESS
    log = [text for text in ending.events if "does not send x-plane.engage_switch" in text]
    assert len(log) == 1, log


@pytest.mark.parametrize(("host", "written"), [("::1", "[::1]"), ("127.0.0.1", "localhost")])
def test_the_simulator_is_reached_by_ipv6_and_by_host_name(
    fccd: Path, tmp_path: Path, host: str, written: str
) -> None:
    with StandInProcess(Settings(host=host, port=0)) as simulator:
        config = write_config(tmp_path, simulator.port)
        text = config.read_text().replace('"127.0.0.1:', f'"{written}:')
        config.write_text(text)
        with start(fccd, tmp_path, config) as daemon:
            engage(simulator, daemon)
            ending = daemon.end(signal.SIGTERM)
        assert_released(simulator)
    assert ending.exit_code == SUCCESS
    assert ending.report["released"] is True


def test_a_killed_daemon_on_ipv6_leaves_a_helper_that_releases(fccd: Path, tmp_path: Path) -> None:
    with StandInProcess(Settings(host="::1", port=0)) as simulator:
        config = write_config(tmp_path, simulator.port)
        config.write_text(config.read_text().replace('"127.0.0.1:', '"[::1]:'))
        with start(fccd, tmp_path, config) as daemon:
            engage(simulator, daemon)
            daemon.end(signal.SIGKILL)
            assert_released(simulator)


def test_a_host_name_without_an_address_is_reported_before_the_flight(
    fccd: Path, tmp_path: Path
) -> None:
    config = write_config(tmp_path, 49_000)
    config.write_text(config.read_text().replace('"127.0.0.1:49000"', '"sim.invalid"'))
    with start(fccd, tmp_path, config) as daemon:
        ending = daemon.end()
    assert ending.exit_code == FAILURE
    assert "cannot find X-Plane at sim.invalid:49000" in ending.log
    assert "IP address" in ending.log


@pytest.mark.fault(
    "Simulator and link",
    "simulator back",
    "datagrams",
    "first",
    "ready; switch must go off and on",
)
@pytest.mark.fault(
    "Simulator and link",
    "simulator gone or hangs",
    "nothing arrives",
    "{failsafe.all_silent_s} s (`failsafe.all_silent_s`); reported after 1.5 s",
    "failsafe",
)
def test_a_killed_simulator_and_its_return(fccd: Path, tmp_path: Path) -> None:
    with flight(fccd, tmp_path, others=SHORT_FAILSAFE) as (simulator, daemon):
        engage(simulator, daemon)
        killed_ns = time.monotonic_ns()
        simulator.kill()
        assert TOO_OLD in daemon.wait_for("engaged -> failsafe")
        daemon.wait_for("sensor X-Plane: nothing arrives")
        daemon.wait_for("failsafe -> standby")
        daemon.wait_for("release sent to the actuators")
        assert str(simulator.port) in daemon.wait_for("does not answer")
        assert TOO_OLD in daemon.wait_for("not ready: ")
        with StandInProcess(Settings(port=simulator.port)) as again:
            back_ns = time.monotonic_ns()
            daemon.wait_for("works again")
            daemon.wait_for(f"X-Plane at 127.0.0.1:{again.port} answers")
            engage(again, daemon)
            again.write(ENGAGE_SWITCH, 0.0)
            daemon.wait_for("engaged -> standby")
            assert_released(again)
            ending = daemon.end(signal.SIGTERM)
    assert ending.exit_code == FAILSAFE
    assert ending.report["failsafes"] == 1
    assert ending.report["released"] is True
    assert ending.states == [
        "standby -> engaged",
        "engaged -> failsafe",
        "failsafe -> standby",
        "standby -> engaged",
        "engaged -> standby",
        "standby -> stopped",
    ]
    flown = Flown.of(ending, tmp_path / "recordings")
    assert_lost_when_too_old(flown, flown.failsafes[0])
    # Since the last reading, which is that old at the failsafe.
    silent_s = ending.when("does not answer") - ending.when("engaged -> failsafe") + MAX_SILENCE_S
    assert 1.0 < silent_s < SAID_AFTER_S + AT_ONCE_S
    recovered_ns = [
        event.time_ns
        for event in flown.events
        if event.kind.WhichOneof("kind") == "sensor_recovered" and event.time_ns > killed_ns
    ]
    assert (recovered_ns[0] - back_ns) * NS < ASKED_EVERY_S + AT_ONCE_S


@pytest.mark.fault(
    "Simulator and link",
    "release lost",
    "overrides read back",
    "250 ms",
    "repeated until confirmed",
)
def test_a_release_lost_by_a_hung_simulator_is_repeated_until_confirmed(
    fccd: Path, tmp_path: Path
) -> None:
    with flight(fccd, tmp_path, others=SHORT_SILENCE) as (simulator, daemon):
        engage(simulator, daemon)
        simulator.set_mode(Mode.FROZEN)
        daemon.wait_for("engaged -> failsafe")
        # Writes to it now fill the socket's buffer.
        time.sleep(2.0)
        daemon.send(signal.SIGTERM)
        daemon.wait_for("failsafe -> stopped")
        assert daemon.is_running, "the release was not seen to take effect"
        simulator.set_mode(Mode.RUNNING)
        running_s = time.monotonic()
        wait_until(lambda: not simulator.progress().overridden, "the overrides are released")
        assert time.monotonic() - running_s < AGAIN_AFTER_S + AT_ONCE_S
        ending = daemon.end()
        assert_released(simulator)
    assert ending.exit_code == FAILSAFE
    assert ending.report["released"] is True


def test_a_killed_simulator_ends_the_program_if_configured(fccd: Path, tmp_path: Path) -> None:
    with flight(fccd, tmp_path, others=SHORT_FAILSAFE + 'then = "stop"') as (simulator, daemon):
        engage(simulator, daemon)
        simulator.kill()
        ending = daemon.end()
    assert ending.exit_code == FAILSAFE
    assert ending.report["ending"] == "failsafe ended"
    assert ending.states[-1] == "failsafe -> stopped"


@pytest.mark.fault(
    "Simulator and link",
    "simulator paused",
    "reported by it",
    "immediately",
    "outputs held; continues afterwards",
)
def test_a_pause_is_waited_out(fccd: Path, tmp_path: Path) -> None:
    with flight(fccd, tmp_path) as (simulator, daemon):
        engage(simulator, daemon)
        paused_ns = time.monotonic_ns()
        simulator.set_mode(Mode.PAUSED)
        daemon.wait_for("X-Plane is paused")
        stood_at_s = simulator.progress().time_s
        for _ in range(3):
            assert daemon.next_state() == "engaged"
        assert simulator.progress().time_s == stood_at_s
        assert simulator.progress().overridden
        simulator.set_mode(Mode.RUNNING)
        wait_until(lambda: simulator.progress().time_s > stood_at_s + 1.0, "simulated time goes on")
        ending = daemon.end(signal.SIGTERM)
        assert_released(simulator)
    assert ending.exit_code == SUCCESS
    assert ending.states == ["standby -> engaged", "engaged -> stopped"]
    records = Flown.of(ending, tmp_path / "recordings").records
    paused = [record for record in records if record.measurements.plant.value.state == PAUSED]
    assert (paused[0].tick.woke_ns - paused_ns) * NS < AT_ONCE_S
    assert len({str(record.outputs) for record in paused[1:]}) == 1, "they are held"


@pytest.mark.fault(
    "Simulator and link",
    "simulator loads a flight, or jumps in time",
    "two datagrams with the clock set back, or a second gained above twice our rate",
    "second datagram; set back: 0.15 to 0.4 s",
    "given back, event",
)
def test_a_simulator_that_hangs_is_a_failsafe_and_one_that_jumps_is_released(
    fccd: Path, tmp_path: Path
) -> None:
    with flight(fccd, tmp_path, others=SHORT_FAILSAFE) as (simulator, daemon):
        engage(simulator, daemon)
        simulator.set_mode(Mode.FROZEN)
        assert TOO_OLD in daemon.wait_for("engaged -> failsafe")
        daemon.wait_for("failsafe -> standby")
        simulator.set_mode(Mode.RUNNING)
        simulator.write(ENGAGE_SWITCH, 0.0)
        engage(simulator, daemon)
        jumped_ns = time.monotonic_ns()
        simulator.act("jump:100")
        assert "simulator time jumped" in daemon.wait_for("control is given back at once")
        daemon.wait_for("engaged -> standby")
        assert_released(simulator)
        ending = daemon.end(signal.SIGTERM)
    assert ending.exit_code == FAILSAFE
    assert ending.report["failsafes"] == 1
    flown = Flown.of(ending, tmp_path / "recordings")
    (hung,) = flown.failsafes
    assert_lost_when_too_old(flown, hung)
    assert_released_at_once(flown, jumped_ns)


def test_standby_says_what_it_waits_for_and_a_command_engages_without_a_button(
    fccd: Path, tmp_path: Path
) -> None:
    """As troubleshooting says: a switch that stays off, and `fccd command engage`."""
    name = f"standby-{os.getpid()}"
    telemetry = f'[telemetry]\ninstance = "{name}"\n'
    command: list[str | Path] = [fccd, "command", "engage", "--instance", name]
    with flight(fccd, tmp_path, others=telemetry) as (simulator, daemon):
        daemon.wait_for("s  waits for the engage switch")
        refused = run(command)
        assert refused.returncode == REFUSED
        assert "switch it on, or configure command_needs_switch = false" in refused.stderr
        switch_on(simulator, daemon)
        run([*command[:2], "disengage", *command[3:]])
        daemon.wait_for("waits for a command, or the engage switch off and on")
        daemon.end(signal.SIGTERM)
    others = f"[engage]\ncommand_needs_switch = false\n{telemetry}"
    with flight(fccd, tmp_path, others=others) as (_, daemon):
        daemon.wait_for("waits for the engage switch or a command")
        # On a busy machine readings may be late.
        wait_until(lambda: run(command).returncode == SUCCESS, "a command engages")
        daemon.wait_for("standby -> engaged")
        daemon.end(signal.SIGTERM)


def test_a_reloaded_flight_is_not_continued(fccd: Path, tmp_path: Path) -> None:
    """The switch is off and the clock at zero again; the release is in the same tick."""
    with flight(fccd, tmp_path, others=SHORT_FAILSAFE) as (simulator, daemon):
        engage(simulator, daemon)
        simulator.act("restart")
        daemon.wait_for("engaged -> standby")
        wait_until(lambda: not simulator.progress().overridden, "the overrides are released")
        engage(simulator, daemon)
        simulator.write(ENGAGE_SWITCH, 0.0)
        daemon.wait_for("engaged -> standby")
        assert_released(simulator)
        daemon.end(signal.SIGTERM)


def test_writes_that_never_arrive_are_reported_with_the_setting_to_change(
    fccd: Path, tmp_path: Path
) -> None:
    with (
        StandInProcess(Settings(port=0)) as simulator,
        ReadOnlySimulator(simulator.port) as read_only,
        start(fccd, tmp_path, write_config(tmp_path, read_only.port)) as daemon,
    ):
        switch_on(simulator, daemon)
        log = daemon.wait_for("Accept incoming connections")
        assert "have no effect" in log
        assert str(read_only.port) in log
        assert not simulator.progress().overridden
        assert read_only.dropped > 0
        simulator.write(ENGAGE_SWITCH, 0.0)
        daemon.wait_for("engaged -> standby")
        ending = daemon.end(signal.SIGTERM)
    assert any(text.startswith("actuator X-Plane: ") for text in ending.events)
    assert "works again" not in ending.log, "nobody knows that"


def test_without_a_simulator_it_waits_and_reports_it(fccd: Path, tmp_path: Path) -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as nobody:
        nobody.bind(("127.0.0.1", 0))
        port = nobody.getsockname()[1]
        with start(fccd, tmp_path, write_config(tmp_path, port)) as daemon:
            daemon.wait_for("no measurements yet")
            log = daemon.wait_for("does not answer")
            assert "X-Plane" in log
            assert str(port) in log
            assert "Accept incoming connections" in log
            ending = daemon.end(signal.SIGTERM)
    assert ending.exit_code == SUCCESS
    assert ending.states == ["standby -> stopped"]


def test_the_beacon_gives_the_address(fccd: Path, tmp_path: Path, beacon: tuple[str, int]) -> None:
    with StandInProcess(Settings(port=0, beacon=beacon)) as simulator:
        config = tmp_path / "fccd.toml"
        config.write_text(
            '[x-plane]\nsimulator = "beacon"\n[guidance]\nmode = "hold"\n'
            f'[recording]\nfolder = "{tmp_path}/recordings"\n'
        )
        with start(fccd, tmp_path, config) as daemon:
            daemon.wait_for(f"X-Plane at 127.0.0.1:{simulator.port} answers")
            engage(simulator, daemon)
            ending = daemon.end(signal.SIGTERM)
            assert_released(simulator)
    assert ending.exit_code == SUCCESS
