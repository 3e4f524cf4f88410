"""A simulator that freezes, is cut off for a moment, shows a map, or is reloaded.

The lockstep flights of `crates/fcc-flight/tests/simulator_silence` have all lengths and two frame
rates; these show the same in the running daemon, side by side.
"""

from __future__ import annotations

import signal
import time
from pathlib import Path

import pytest
from daemon_under_test import assert_released, engage, flight, wait_until
from fault_flights import AT_ONCE_S, NS, Flown, assert_flown_again, at_once

from fcc_hil.fly import ENGAGE_SWITCH

SUCCESS = 0
LENGTHS_S = (0.2, 1.5)
STOOD_STILL = "the simulator stood still for"
LINK_LOST = "link lost for"
UNSEEN = "not engaged: the engage switch was switched on while nothing arrived"
MAP_S = 3.0


def gaps(fccd: Path, scratch: Path, action: str, said: str) -> Flown:
    """Let the simulator freeze, or cut it off, for two lengths."""
    scratch.mkdir()
    with flight(fccd, scratch) as (simulator, daemon):
        engage(simulator, daemon)
        for length_s in LENGTHS_S:
            simulator.act(f"{action}:{length_s}")
            daemon.wait_for(said)
        ending = daemon.end(signal.SIGTERM)
        assert_released(simulator)
    return Flown.of(ending, scratch / "recordings")


def waits(fccd: Path, scratch: Path) -> Flown:
    """Open the map, and then show a replay."""
    scratch.mkdir()
    with flight(fccd, scratch) as (simulator, daemon):
        engage(simulator, daemon)
        simulator.act(f"map:{MAP_S}")
        daemon.wait_for("time has stopped although it is not paused")
        daemon.wait_for(STOOD_STILL)
        assert daemon.next_state() == "engaged"
        simulator.act(f"replay:{MAP_S}")
        daemon.wait_for("shows a replay")
        writes = len(simulator.journal())
        daemon.next_state()
        daemon.next_state()
        assert len(simulator.journal()) == writes, "nothing is written to a replay"
        assert simulator.progress().overridden
        daemon.wait_for("time runs again")
        for _ in range(2):
            assert daemon.next_state() == "engaged"
        ending = daemon.end(signal.SIGTERM)
        assert_released(simulator)
    return Flown.of(ending, scratch / "recordings")


def reloads(fccd: Path, scratch: Path, action: str) -> Flown:
    """Load the aircraft again, or move it: it is released once, and nothing is written then."""
    scratch.mkdir()
    with flight(fccd, scratch) as (simulator, daemon):
        engage(simulator, daemon)
        reloaded_ns = time.monotonic_ns()
        simulator.act(action)
        daemon.wait_for("control is given back at once")
        daemon.wait_for("release sent to the actuators")
        wait_until(lambda: not simulator.progress().overridden, "the overrides are released")
        daemon.next_state()
        writes = len(simulator.journal())
        for _ in range(2):
            assert daemon.next_state() == "standby"
        assert len(simulator.journal()) == writes
        assert not simulator.progress().overridden
        ending = daemon.end(signal.SIGTERM)
    return Flown.of(ending, scratch / "recordings", reloaded_ns)


def switched(fccd: Path, scratch: Path) -> Flown:
    """Switch on in a silence, which does not engage; then off and on again."""
    scratch.mkdir()
    with flight(fccd, scratch) as (simulator, daemon):
        daemon.wait_until_ready()
        simulator.act("cut:2")
        time.sleep(0.5)
        simulator.write(ENGAGE_SWITCH, 1.0)
        daemon.wait_for(UNSEEN)
        simulator.write(ENGAGE_SWITCH, 0.0)
        time.sleep(0.5)
        engage(simulator, daemon)
        ending = daemon.end(signal.SIGTERM)
        assert_released(simulator)
    return Flown.of(ending, scratch / "recordings")


RELOADS = ("reload", "reload-air", "relocate")


@pytest.fixture(scope="module")
def flights(fccd: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Flown]:
    """All flights, side by side."""
    scratch = tmp_path_factory.mktemp("gaps")
    return at_once(
        {
            "freezes": lambda: gaps(fccd, scratch / "freezes", "freeze", STOOD_STILL),
            "cuts": lambda: gaps(fccd, scratch / "cuts", "cut", LINK_LOST),
            "switched": lambda: switched(fccd, scratch / "switched"),
            "waits": lambda: waits(fccd, scratch / "waits"),
            "reload": lambda: reloads(fccd, scratch / "reload", "reload"),
            "reload-air": lambda: reloads(fccd, scratch / "reload-air", "reload-air"),
            "relocate": lambda: reloads(fccd, scratch / "relocate", "relocate"),
        }
    )


def assert_engaged_throughout(flown: Flown) -> None:
    assert flown.ending.exit_code == SUCCESS
    assert flown.ending.states == ["standby -> engaged", "engaged -> stopped"]


def lengths_s(flown: Flown, text: str) -> list[float]:
    events = [event for event in flown.texts() if event.startswith(text)]
    return [float(event.removeprefix(text).split()[0]) for event in events]


def assert_lengths(flown: Flown, text: str) -> None:
    """Each is among them: a busy machine makes a gap longer, and may make others."""
    found = lengths_s(flown, text)
    for length_s in LENGTHS_S:
        assert any(length_s - 0.11 < lasted_s < length_s + AT_ONCE_S for lasted_s in found), found


@pytest.mark.fault(
    "Simulator and link",
    "simulator freezes briefly",
    "silence, after which its time has not run on",
    "immediately",
    "[waited for](#silence-of-a-simulator), continues; event with length",
)
def test_a_freeze_is_flown_through(flights: dict[str, Flown]) -> None:
    flown = flights["freezes"]
    assert_engaged_throughout(flown)
    assert_lengths(flown, STOOD_STILL)
    assert max(lengths_s(flown, LINK_LOST), default=0.0) < 1.0


@pytest.mark.fault(
    "Simulator and link",
    "link cut briefly, aircraft flew on",
    "its time ran on",
    "first datagram",
    "navigation settles anew, continues; event with length",
)
def test_a_cut_is_distinguished_from_a_freeze(flights: dict[str, Flown]) -> None:
    flown = flights["cuts"]
    assert_engaged_throughout(flown)
    assert_lengths(flown, LINK_LOST)
    assert max(lengths_s(flown, STOOD_STILL), default=0.0) < 1.0


@pytest.mark.fault(
    "Time",
    "simulator's time and aircraft stand still while it sends, not paused",
    "its clock",
    "reported after 250 ms; {failsafe.all_silent_s} s (`failsafe.all_silent_s`)",
    "waited for, then failsafe",
)
@pytest.mark.fault(
    "Simulator and link",
    "simulator shows map, menu, alert or replay",
    "clock; silence; `sim/time/is_in_replay`",
    "250 ms",
    "waited for, a replay without writes; continues",
)
def test_a_map_and_a_replay_are_waited_out(flights: dict[str, Flown]) -> None:
    flown = flights["waits"]
    assert_engaged_throughout(flown)
    assert max(lengths_s(flown, STOOD_STILL)) > MAP_S - 0.11


def test_a_switch_moved_in_a_silence_is_reported(flights: dict[str, Flown]) -> None:
    flown = flights["switched"]
    assert_engaged_throughout(flown)
    assert [event.startswith(UNSEEN) for event in flown.texts()].count(True) == 1


@pytest.mark.fault(
    "Simulator and link",
    "simulator reloads aircraft",
    "both overrides cleared in two ticks",
    "second",
    "given back, event",
)
@pytest.mark.parametrize("action", RELOADS)
def test_a_reload_is_released_at_once(flights: dict[str, Flown], action: str) -> None:
    flown = flights[action]
    assert flown.ending.exit_code == SUCCESS
    assert flown.failsafes == []
    assert flown.ending.report["released"] is True
    (released,) = [
        event for event in flown.events if event.kind.WhichOneof("kind") == "released_at_once"
    ]
    assert 0.0 < (released.time_ns - flown.injected_ns) * NS < AT_ONCE_S
    later = [record for record in flown.records if record.tick.number >= released.tick]
    assert not any(record.sent for record in later)


@pytest.mark.parametrize("name", ["freezes", "cuts", "switched", "waits", *RELOADS])
def test_a_replay_is_identical(fccd: Path, flights: dict[str, Flown], name: str) -> None:
    assert_flown_again(fccd, flights[name])
