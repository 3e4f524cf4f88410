"""Flights with a link to the simulator that is cut, or a slow simulator."""

from __future__ import annotations

import signal
import time
from contextlib import ExitStack
from pathlib import Path

import pytest
from daemon_under_test import assert_released, engage, flight, start, wait_until, write_config
from fault_flights import AT_ONCE_S, ENGAGED, NS, Flown, assert_flown_again, at_once, seconds
from tampered_link import TamperedLink

from fcc_hil.cockpit import OVERRIDE_JOYSTICK
from fcc_hil.faulty_sensors import Kind, SensorFault
from fcc_hil.fly import ENGAGE_SWITCH
from fcc_hil.process import StandInProcess
from fcc_hil.standin import Mode, Settings
from fcc_hil.truth import COLUMNS

SUCCESS = 0
FAILSAFE = 3
MAX_AGE_S = 0.6
"""More than the default, for a busy machine."""
PATIENT = (
    f"[failsafe]\nhold_s = 1.0\nsensor_max_age_ms = {MAX_AGE_S * 1e3:.0f}\n"
    f"all_silent_s = {MAX_AGE_S}\n"
)
SLOW_FPS = 10.0


def nothing_arrives(fccd: Path, scratch: Path) -> Flown:
    """Cut the link from the simulator: datagrams to it still arrive."""
    scratch.mkdir()
    with (
        StandInProcess(Settings(port=0)) as simulator,
        TamperedLink(simulator.port) as link,
        start(
            fccd,
            scratch,
            write_config(scratch, link.port, others=PATIENT),
        ) as daemon,
    ):
        engage(simulator, daemon)
        link.cut(from_simulator=True)
        assert "attitude is missing or too old" in daemon.wait_for("engaged -> failsafe")
        daemon.wait_for("failsafe -> standby")
        assert_released(simulator)
        link.restore()
        simulator.write(ENGAGE_SWITCH, 0.0)
        engage(simulator, daemon)
        ending = daemon.end(signal.SIGTERM)
    return Flown.of(ending, scratch / "recordings")


def nothing_gets_there(fccd: Path, scratch: Path) -> Flown:
    """Cut the link to the simulator: it keeps the last controls."""
    scratch.mkdir()
    with (
        StandInProcess(Settings(port=0)) as simulator,
        TamperedLink(simulator.port) as link,
        start(fccd, scratch, write_config(scratch, link.port, others=PATIENT)) as daemon,
    ):
        engage(simulator, daemon)
        link.cut(to_simulator=True)
        # Another program clears the override, and the daemon cannot set it again.
        cut_ns = time.monotonic_ns()
        simulator.write(OVERRIDE_JOYSTICK, 0.0)
        assert "have no effect" in daemon.wait_for("Accept incoming connections")
        link.restore()
        daemon.wait_for("take effect")
        ending = daemon.end(signal.SIGTERM)
        wait_until(lambda: not simulator.progress().overridden, "the overrides are released")
    return Flown.of(ending, scratch / "recordings", cut_ns)


def slow(fccd: Path, scratch: Path) -> Flown:
    """Let the simulator make 10 frames a second: half of real time."""
    scratch.mkdir()
    with flight(fccd, scratch, others=PATIENT) as (simulator, daemon):
        engage(simulator, daemon)
        slowed_ns = time.monotonic_ns()
        simulator.act(f"fps:{SLOW_FPS}")
        daemon.wait_for("X-Plane is slow")
        for _ in range(3):
            assert daemon.next_state() == "engaged"
        simulator.act("fps:60")
        daemon.wait_for("time runs again")
        ending = daemon.end(signal.SIGTERM)
        assert_released(simulator)
    return Flown.of(ending, scratch / "recordings", slowed_ns)


def one_of_two(fccd: Path, scratch: Path) -> Flown:
    """Measure by two simulators, and end the preferred one: the other is flown for a second.

    Then the switch that engaged is silent, whatever the other's says.

    Before that the preferred one is silent for a moment, with its switch off and the other's on,
    and its altitude jumps by 30 m.
    """
    scratch.mkdir()
    with StandInProcess(Settings(port=0)) as flown, ExitStack() as preferred:
        other = preferred.enter_context(StandInProcess(Settings(port=0)))
        entry = f'[[sensor]]\nkind = "x-plane"\nsimulator = "127.0.0.1:{other.port}"\n'
        config = write_config(scratch, flown.port, others=f"{PATIENT}{entry}")
        with start(fccd, scratch, config) as daemon:
            daemon.wait_until_ready()
            flown.write(ENGAGE_SWITCH, 1.0)
            other.set_mode(Mode.FROZEN)
            daemon.wait_for("from X-Plane 2 instead of X-Plane")
            # Longer, in case not all quantities are read from the other one at once.
            time.sleep(0.3)
            other.set_mode(Mode.RUNNING)
            daemon.wait_for("from X-Plane instead of X-Plane 2")
            for _ in range(2):
                assert daemon.next_state() == "standby"
            other.write(ENGAGE_SWITCH, 1.0)
            daemon.wait_for("standby -> engaged")
            time_s = dict(zip(COLUMNS, other.progress().now, strict=True))["time_s"]
            jump = SensorFault(Kind.BIAS, "altitude", ("altitude_m",), time_s, amount=30.0)
            other.set_sensor_faults([jump])
            daemon.wait_for("altitude: from X-Plane 2 instead of X-Plane")
            assert daemon.next_state() == "engaged"
            preferred.close()
            while "airspeed" not in daemon.wait_for("from X-Plane 2 instead of X-Plane"):
                pass
            assert "engage switch is silent" in daemon.wait_for("engaged -> failsafe")
            daemon.wait_for("failsafe -> standby")
            ending = daemon.end(signal.SIGTERM)
            assert_released(flown)
    return Flown.of(ending, scratch / "recordings")


def a_bouncing_switch(fccd: Path, scratch: Path) -> Flown:
    """Let the engage switch bounce, and then be noisy; with it, datagrams are invalid."""
    scratch.mkdir()
    with (
        StandInProcess(Settings(port=0)) as simulator,
        TamperedLink(simulator.port) as link,
        start(fccd, scratch, write_config(scratch, link.port)) as daemon,
    ):
        engage(simulator, daemon)
        for n in range(40):
            simulator.write(ENGAGE_SWITCH, n % 2)
            time.sleep(0.03)
        daemon.wait_for("standby -> engaged")
        for n in range(40):
            simulator.write(ENGAGE_SWITCH, 0.49 + n % 2 * 0.02)
            link.send(b"RREF,cut")
            time.sleep(0.1)
        ending = daemon.end(signal.SIGTERM)
    return Flown.of(ending, scratch / "recordings")


def a_queue(fccd: Path, scratch: Path) -> Flown:
    """Hold for half a second all that the simulator sends, after a freeze of it."""
    scratch.mkdir()
    with (
        StandInProcess(Settings(port=0)) as simulator,
        TamperedLink(simulator.port) as link,
        start(fccd, scratch, write_config(scratch, link.port)) as daemon,
    ):
        engage(simulator, daemon)
        simulator.set_mode(Mode.FROZEN)
        time.sleep(0.4)
        simulator.set_mode(Mode.RUNNING)
        daemon.wait_for("the simulator stood still for")
        held_ns = time.monotonic_ns()
        link.hold(0.5)
        assert "own clock" in daemon.wait_for("engaged -> failsafe")
        link.restore()
        daemon.wait_for("failsafe -> engaged")
        ending = daemon.end(signal.SIGTERM)
        assert_released(simulator)
    return Flown.of(ending, scratch / "recordings", held_ns)


@pytest.fixture(scope="module")
def flights(fccd: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Flown]:
    """All flights, side by side."""
    scratch = tmp_path_factory.mktemp("link")
    return at_once(
        {
            "from": lambda: nothing_arrives(fccd, scratch / "from"),
            "to": lambda: nothing_gets_there(fccd, scratch / "to"),
            "slow": lambda: slow(fccd, scratch / "slow"),
            "two": lambda: one_of_two(fccd, scratch / "two"),
            "queue": lambda: a_queue(fccd, scratch / "queue"),
            "switch": lambda: a_bouncing_switch(fccd, scratch / "switch"),
        }
    )


@pytest.mark.fault(
    "Simulator and link",
    "link cut, nothing from simulator",
    "nothing arrives",
    "{failsafe.all_silent_s} s (`failsafe.all_silent_s`)",
    "failsafe; release arrives",
)
def test_nothing_from_the_simulator_is_failsafe_and_the_release_arrives(
    flights: dict[str, Flown],
) -> None:
    flown = flights["from"]
    assert flown.ending.exit_code == FAILSAFE
    record = flown.records[flown.failsafes[0]]
    age_s = (record.tick.woke_ns - record.measurements.attitude.taken_ns) * 1e-9
    assert MAX_AGE_S < age_s < 2 * MAX_AGE_S


@pytest.mark.fault(
    "Simulator and link",
    "writes do not arrive, controls are read back",
    "an output moves by 0.1, the controls do not",
    "1.5 s",
    "`the outputs do not reach the aircraft`; loops follow the controls",
)
@pytest.mark.fault(
    "Simulator and link",
    "link cut, nothing to simulator",
    "overrides and yoke read back",
    "1 s; reported after 2 s",
    "event; control retaken with the link; at program end exit 5, release helper continues "
    "two minutes",
)
def test_nothing_to_the_simulator_is_reported_and_the_flight_continues(
    flights: dict[str, Flown],
) -> None:
    flown = flights["to"]
    faults = [
        event
        for event in flown.events
        if event.kind.WhichOneof("kind") == "actuator_fault"
        and event.kind.actuator_fault.fault.WhichOneof("kind") == "unconfirmed"
    ]
    recovered = [
        event for event in flown.events if event.kind.WhichOneof("kind") == "actuator_recovered"
    ]
    # A second after the difference appears.
    assert 0.0 < (faults[0].time_ns - flown.injected_ns) * NS < 1.0 + AT_ONCE_S
    # And a second later as a message.
    said_s = flown.ending.when("Accept incoming connections")
    assert 0.0 < said_s - flown.ending.when("actuator X-Plane: ") < 1.0 + AT_ONCE_S
    assert recovered
    assert flown.ending.report["released"] is True


@pytest.mark.fault(
    "Simulator and link",
    "simulator slow",
    "its time runs below 90 % of ours (95 % with frames above 50 ms)",
    "2 s",
    "reported; flown at its speed",
)
def test_a_slow_simulator_is_flown_at_its_own_speed(flights: dict[str, Flown]) -> None:
    flown = flights["slow"]
    assert flown.ending.exit_code == SUCCESS
    assert flown.failsafes == []
    slow_ones = [r for r in flown.records if r.measurements.plant.value.state == 3]
    assert 0.0 < (slow_ones[0].tick.woke_ns - flown.injected_ns) * NS < 2.0 + AT_ONCE_S
    plant_s = (
        slow_ones[-1].measurements.plant.value.time_s - slow_ones[0].measurements.plant.value.time_s
    )
    ours_s = seconds(slow_ones[-1], slow_ones[0])
    assert plant_s < 0.9 * ours_s


@pytest.mark.parametrize("name", ["from", "to", "slow", "two", "queue", "switch"])
def test_a_replay_is_identical(fccd: Path, flights: dict[str, Flown], name: str) -> None:
    assert_flown_again(fccd, flights[name])


@pytest.mark.fault(
    "Simulator and link",
    "preferred one of two simulators gone, silent, or its altitude jumps",
    "age; plausibility gate",
    "100 ms (`fallback_after_ms`)",
    "event; the other's readings are used; [without its engage "
    "switch](architecture.md#several-sensors) failsafe after 1 s",
)
def test_one_of_two_simulators_is_lost_and_the_other_one_flown(flights: dict[str, Flown]) -> None:
    flown = flights["two"]
    assert flown.ending.exit_code == FAILSAFE
    assert flown.ending.states == [
        "standby -> engaged",
        "engaged -> failsafe",
        "failsafe -> standby",
        "standby -> stopped",
    ]
    readings = [record.measurements.airspeed_mps for record in flown.records]
    engaged = next(n for n, record in enumerate(flown.records) if record.state.phase == ENGAGED)
    switches = [record.measurements.engage_switch for record in flown.records]
    # Once the preferred one has delivered its switch, never again the other's.
    owned = next(n for n, switch in enumerate(switches) if switch.source == 0 and switch.taken_ns)
    assert owned < engaged
    assert {switch.source for switch in switches[owned:]} == {0}
    silent = flown.failsafes[0]
    silent_s = (flown.records[silent].tick.woke_ns - switches[silent].taken_ns) * NS
    assert 1.0 < silent_s < 1.0 + AT_ONCE_S
    changed = engaged + [reading.source for reading in readings[engaged:]].index(1)
    assert changed > engaged
    assert {reading.source for reading in readings[changed:]} == {1}
    # `fallback_after_ms` is 100.
    age_s = (flown.records[changed].tick.woke_ns - readings[changed - 1].taken_ns) * NS
    assert 0.1 < age_s < MAX_AGE_S
    # The altitude came from the other one before, in the tick of the jump.
    altitudes = [record.measurements.altitude_m for record in flown.records[engaged:changed]]
    jumped = [reading.source for reading in altitudes].index(1)
    assert jumped < changed - engaged
    before, after = altitudes[jumped - 1 : jumped + 1]
    assert abs(after.value - before.value) < 15.0
    assert {reading.source for reading in altitudes[jumped:]} == {1}


@pytest.mark.fault(
    "Time",
    "network queue: data late, in order",
    "[the source's clock](envelope.md#time)",
    "first late reading, from 250 ms",
    "failsafe; continues 2 s after the queue is empty",
)
def test_a_queue_in_the_network_is_failsafe_until_it_is_empty(flights: dict[str, Flown]) -> None:
    flown = flights["queue"]
    assert flown.ending.exit_code == FAILSAFE
    record = flown.records[flown.failsafes[0]]
    # It has just arrived.
    age_s = (record.tick.woke_ns - record.measurements.attitude.taken_ns) * NS
    assert 0.25 < age_s < 0.5 + AT_ONCE_S
    assert 0.0 < (record.tick.woke_ns - flown.injected_ns) * NS < 0.5 + AT_ONCE_S


@pytest.mark.fault(
    "Simulator and link",
    "engage switch off, bouncing or noisy",
    "[position](envelope.md#who-has-control): on from 0.75, off below 0.25",
    "0.1 s at most",
    "given back; on counts 0.5 s after the last off",
)
def test_a_switch_that_bounces_disengages_once(flights: dict[str, Flown]) -> None:
    flown = flights["switch"]
    assert flown.ending.states == [
        "standby -> engaged",
        "engaged -> standby",
        "standby -> engaged",
        "engaged -> stopped",
    ]


def test_a_flapping_fault_is_summarised(flights: dict[str, Flown]) -> None:
    flown = flights["switch"]
    invalid = "the data that arrives is invalid"
    assert sum(invalid in text for text in flown.texts()) > 10
    lines = [line for line in flown.ending.log.splitlines() if invalid in line]
    assert len(lines) <= 3
    assert any("such events in" in event["text"] for event in flown.ending.report["events"])
