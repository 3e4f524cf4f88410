"""Degraded flight in the running daemon, over X-Plane's protocol, and its ends.

Lost in a turn with 30 degrees of bank; against JSBSim's truth, with the limits of the flights in
lockstep (`test_degraded`), which fly every row of the table in docs/faults.md. Here are those that
the protocol distinguishes, all at the same time; what lasts shorter follows in the same flights.
"""

from __future__ import annotations

import contextlib
import functools
import math
import signal
import socket
import struct
from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest
from daemon_under_test import DaemonUnderTest, Ending, start, switch_on, wait_until, write_config
from degraded_rows import LEVEL_AFTER_S, PITCH_AND_POWER, ROWS, SinceLoss
from fault_flights import at_once
from tampered_link import TamperedLink

from fcc_hil.faulty_sensors import Kind, SensorFault
from fcc_hil.process import StandInProcess
from fcc_hil.quantities import SENSORS
from fcc_hil.standin import Settings
from fcc_hil.truth import Truth
from fcc_hil.udp import free_port

AIRCRAFT = "c172p"
SEED = 11
GLIDES = "heading"
"""Of the datarefs the magnetic heading alone: without the true one there is no acceleration."""
BY_ROWS = "attitude and heading"
"""By rows of Data Output: by datarefs there is no acceleration without the attitude."""
NO_ATTITUDE_AND_RATES = "attitude and acceleration"
"""Goes on without these two."""
FLOWN = (BY_ROWS, GLIDES, NO_ATTITUDE_AND_RATES)

LOST_AT_S = 4.0
LOST_FOR_S = 10.0
HELD_S = 9.0
"""In the flight that glides, failsafe.degraded_s."""
SECOND_AT_S = 21.0
TRIMS_AT_S = 31.0
GLIDING_S = (25.0, 26.5)
"""Since the loss; 12 s after the begin of the glide."""

MOST_MISSED = 5
"""Deadlines of some 900; one that misses more tells of the machine, and is flown again."""
ATTEMPTS = 3

# Level turns: what a loss does to a climb is another matter.
TURN = 'mode = "timed-pattern"\nhold_s = 0.5\nleg_s = 30.0\nclimb_ft = 0.0'
TO_GLIDE = f'[failsafe]\ndegraded_s = {HELD_S}\nhold_s = 1.0\nend = "glide"\n'
DATA_ROWS = (1, 3, 4, 16, 17, 18, 20, 21)
ATTITUDE_ROW = 17
MAGNETIC_HEADING = "sim/flightmodel/position/mag_psi"
CONTROLS = ("elevator", "aileron", "rudder", "throttle")


class Flying:
    """A flight that is engaged; times are the simulator's, since engaging."""

    def __init__(self, simulator: StandInProcess, daemon: DaemonUnderTest) -> None:
        self.simulator = simulator
        self.daemon = daemon
        switch_on(simulator, daemon)
        self.engaged_s = simulator.progress().time_s

    def lose(self, lost: Iterable[str], begins_s: float, ends_s: float = math.inf) -> None:
        """Lose sensors for a time, instead of the ones before."""
        times_s = (self.engaged_s + begins_s, self.engaged_s + ends_s)
        self.simulator.set_sensor_faults(
            [SensorFault(Kind.LOSS, name, SENSORS[name], *times_s) for name in lost]
        )

    def fly_to(self, time_s: float) -> None:
        """Wait."""
        until_s = self.engaged_s + time_s
        wait_until(lambda: self.simulator.progress().time_s >= until_s, "time passes", 120.0)

    def select(self, tag: bytes) -> None:
        """Switch the row with the attitude on or off, as a program does."""
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as program:
            datagram = struct.pack("<4sxi", tag, ATTITUDE_ROW)
            program.sendto(datagram, ("127.0.0.1", self.simulator.port))

    def glide(self, link: TamperedLink) -> None:
        """Lose the heading for good, and in the glide attitude and body rates, too."""
        self.fly_to(LOST_AT_S)
        link.replace_values({MAGNETIC_HEADING: math.nan})
        self.lose(["attitude", "body_rates"], TRIMS_AT_S)
        self.fly_to(TRIMS_AT_S + 3.0)

    def row(self, name: str) -> None:
        """Lose the quantities of a row, and fly on when they are back."""
        if name == BY_ROWS:
            self.fly_to(LOST_AT_S)
            self.select(b"USEL")
            self.fly_to(LOST_AT_S + LOST_FOR_S)
            self.select(b"DSEL")
        else:
            self.lose(ROWS[name][0], LOST_AT_S, LOST_AT_S + LOST_FOR_S)
        self.fly_to(SECOND_AT_S - 0.5)
        if name == NO_ATTITUDE_AND_RATES:
            self.lose(["attitude", "body_rates"], SECOND_AT_S)
            self.daemon.wait_for("failsafe -> standby")


@dataclass(frozen=True)
class Degraded:
    """A completed flight."""

    truth: Truth
    engaged_s: float
    is_overridden: bool
    """At its end."""
    ending: Ending
    recordings: Path

    def since(self, lost_s: float) -> SinceLoss:
        """Return the truth by times since a loss."""
        return SinceLoss(self.truth, self.engaged_s, self.engaged_s + lost_s)

    def times(self, text: str) -> list[float]:
        """Return the times of the events with a text, s."""
        events = self.ending.report["events"]
        return [float(event["time_s"]) for event in events if text in event["text"]]


def fly_undisturbed(fccd: Path, folder: Path, name: str) -> Degraded:
    """Fly one row of the table, again if the machine stood still meanwhile."""
    for attempt in range(ATTEMPTS):
        flown = fly(fccd, folder / f"{name} {attempt}", name)
        if flown.ending.report["timing"]["missed"] <= MOST_MISSED:
            break
    return flown


def fly(fccd: Path, scratch: Path, name: str) -> Degraded:
    """Fly one row of the table."""
    scratch.mkdir()
    settings = Settings(port=0, aircraft=AIRCRAFT, seed=SEED, noise=True)
    x_plane = ""
    if name == BY_ROWS:
        target = ("127.0.0.1", free_port())
        settings = replace(settings, data_target=target, data_rows=DATA_ROWS)
        x_plane = f'input = "data"\nlocal_port = {target[1]}\ndata_version = 11\n'
    others = TO_GLIDE if name == GLIDES else ""
    with contextlib.ExitStack() as stack:
        simulator = stack.enter_context(StandInProcess(settings))
        link = stack.enter_context(TamperedLink(simulator.port)) if name == GLIDES else None
        port = link.port if link else simulator.port
        config = write_config(scratch, port, x_plane, others, TURN)
        daemon = stack.enter_context(start(fccd, scratch, config))
        flying = Flying(simulator, daemon)
        if link:
            flying.glide(link)
        else:
            flying.row(name)
        is_overridden, truth = simulator.progress().overridden, simulator.truth()
        ending = daemon.end(signal.SIGTERM)
        return Degraded(truth, flying.engaged_s, is_overridden, ending, scratch / "recordings")


@pytest.fixture(scope="module")
def flown(fccd: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Degraded]:
    """All flights, side by side."""
    fly_one = functools.partial(fly_undisturbed, fccd, tmp_path_factory.mktemp("degraded"))
    return at_once({name: functools.partial(fly_one, name) for name in FLOWN})


@pytest.mark.fault(
    "Degraded flight",
    "heading lost, replaced by the integrated gyroscope; body rates or attitude lost, "
    "[replaced](control.md#without-a-quantity)",
    "level",
    "`failsafe.degraded_s`",
    "end",
)
@pytest.mark.parametrize("name", FLOWN)
def test_what_is_left_is_held(flown: dict[str, Degraded], name: str) -> None:
    flight = flown[name]
    assert flight.ending.states[:2] == ["standby -> engaged", "engaged -> failsafe"]
    lost, limits = ROWS[name]
    failsafe = next(text for text in flight.ending.events if "engaged -> failsafe" in text)
    assert failsafe.count("is missing or too old") + failsafe.count("are missing") == len(lost)
    assert flight.times("now: flying on without a lost quantity")
    since = flight.since(LOST_AT_S)
    assert np.min(since.between("roll_deg", -0.2, 0.2)) > 25.0
    end_s = HELD_S if name == GLIDES else LOST_FOR_S
    since.assert_held(limits, end_s)
    if name in PITCH_AND_POWER:
        assert np.ptp(since.between("throttle", LEVEL_AFTER_S, end_s)) < 0.01


@pytest.mark.parametrize("name", [name for name in FLOWN if name != GLIDES])
def test_what_is_good_again_is_flown_on(flown: dict[str, Degraded], name: str) -> None:
    flight = flown[name]
    assert flight.ending.states[2] == "failsafe -> engaged"
    lasted_s = flight.times("failsafe -> engaged")[0] - flight.times("engaged -> failsafe")[0]
    # Good for 2 s.
    assert LOST_FOR_S + 1.2 < lasted_s < LOST_FOR_S + 3.0
    assert flight.times("failsafe cleared")
    # It turns on.
    turns_deg = flight.since(LOST_AT_S + LOST_FOR_S).between("roll_deg", 5.5, 6.5)
    assert np.min(turns_deg) > 25.0


@pytest.mark.fault(
    "Degraded flight",
    "attitude and body rates, or all lost",
    "the trims found, of surfaces and throttle",
    "0 s",
    "end; half a second is flown through",
)
def test_without_attitude_and_rates_control_is_given_back(flown: dict[str, Degraded]) -> None:
    flight = flown[NO_ATTITUDE_AND_RATES]
    assert flight.ending.states[3:5] == ["engaged -> failsafe", "failsafe -> standby"]
    lasted_s = flight.times("failsafe -> standby")[0] - flight.times("engaged -> failsafe")[1]
    # failsafe.hold_s.
    assert 4.9 < lasted_s < 6.0
    since = flight.since(SECOND_AT_S)
    # The trims of the surfaces and the throttle.
    for control in CONTROLS:
        assert np.ptp(since.between(control, 1.0, 5.0)) < 0.01
    # The bank of the turn stays: the aircraft does not roll on.
    assert np.max(np.abs(since.between("roll_deg", 0.0, 5.0))) < 40.0


def test_without_a_pilot_it_glides_in_a_gentle_turn(flown: dict[str, Degraded]) -> None:
    """A Cessna 172P glides best at 65 kt (its handbook, section 3)."""
    flight = flown[GLIDES]
    (glides_s,) = flight.times("gliding in a gentle turn")
    # failsafe.degraded_s and failsafe.hold_s.
    assert HELD_S + 0.9 < glides_s - flight.times("engaged -> failsafe")[0] < HELD_S + 2.0
    since = flight.since(LOST_AT_S)
    assert np.max(np.abs(since.between("airspeed_kt", *GLIDING_S) - 65.0)) < 5.0
    assert np.max(np.abs(since.between("roll_deg", *GLIDING_S) - 15.0)) < 2.0
    assert np.max(since.between("throttle", *GLIDING_S)) == 0.0


def test_without_a_pilot_and_attitude_the_trims_are_held(flown: dict[str, Degraded]) -> None:
    flight = flown[GLIDES]
    since = flight.since(TRIMS_AT_S)
    for control in CONTROLS:
        assert np.ptp(since.between(control, 1.0, 3.0)) < 0.01
    assert np.max(since.between("throttle", 1.0, 3.0)) == 0.0
    assert flight.ending.states[1:] == ["engaged -> failsafe", "failsafe -> stopped"]
    assert flight.is_overridden
