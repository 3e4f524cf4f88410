"""The daemon flies through a servo board: the board has the pitot tube, the switch and the servos.

Attitude, heading and altitude come from the stand-in, as from sensors of the computer's own.
"""

from __future__ import annotations

import heapq
import random
import select
import signal
import socket
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from daemon_under_test import DaemonUnderTest, start, switch_on, wait_until

from fcc_hil.board_link import Change
from fcc_hil.cockpit import ENGAGE_SWITCH
from fcc_hil.faults import Faults
from fcc_hil.process import StandInProcess
from fcc_hil.servo_board import FAILSAFE_AFTER_S, Control
from fcc_hil.standin import Settings
from fcc_hil.state import Controls

CENTRED = Controls()
LATEST_S = 4.0
"""So late a message arrives again at most."""
WAYS = pytest.mark.parametrize("way", ["serial", "udp"])


class RepeatingLink:
    """Between a daemon and the board: what the board sends may arrive again, much later."""

    def __init__(self, board_port: int, faults: Faults) -> None:
        self._sockets = [socket.socket(socket.AF_INET, socket.SOCK_DGRAM) for _ in range(2)]
        for end in self._sockets:
            end.bind(("127.0.0.1", 0))
        self.port: int = self._sockets[0].getsockname()[1]
        self._board = ("127.0.0.1", board_port)
        self._share = faults.duplicate
        self._random = random.Random(1)
        self._is_cut = False
        self._runs = True
        self._thread = threading.Thread(target=self._serve, daemon=True)
        self._thread.start()

    def cut_back(self) -> None:
        """Let nothing of the board's arrive any more."""
        self._is_cut = True

    def close(self) -> None:
        self._runs = False
        self._thread.join()
        for end in self._sockets:
            end.close()

    def _serve(self) -> None:
        near, far = self._sockets
        daemon = None
        late: list[tuple[float, bytes]] = []
        while self._runs:
            ready, _, _ = select.select(self._sockets, [], [], 0.005)
            now_s = time.monotonic()
            back = []
            if near in ready:
                message, daemon = near.recvfrom(2_048)
                far.sendto(message, self._board)
            if far in ready:
                message = far.recv(2_048)
                back.append(message)
                if self._random.random() < self._share:
                    heapq.heappush(late, (now_s + self._random.uniform(0.5, LATEST_S), message))
            while late and late[0][0] <= now_s:
                back.append(heapq.heappop(late)[1])
            for message in back:
                if daemon is not None and not self._is_cut:
                    near.sendto(message, daemon)


class Flight:
    """A daemon, a board and an aircraft."""

    def __init__(
        self,
        fccd: Path,
        scratch: Path,
        way: str,
        guidance: str,
        faults: Faults | None = None,
        other_switch: str = "no/such/switch",
    ) -> None:
        self._fccd, self._scratch = fccd, scratch
        line = scratch / "ttyBOARD"
        board = str(line) if way == "serial" else "udp"
        self.aircraft = StandInProcess(Settings(port=0, board=board))
        port = self.aircraft.board_port()
        self.network = None
        if faults is not None:
            self.network = RepeatingLink(port, faults)
            port = self.network.port
        where = f'serial = "{line}"' if way == "serial" else f'address = "127.0.0.1:{port}"'
        # The only switch is the board's, unless another is given; the simulator's airspeed
        # replaces a lost one.
        self._config = scratch / "fccd.toml"
        self._config.write_text(
            f"[servo-board]\n{where}\n"
            '[[sensor]]\nkind = "servo-board"\n'
            f'[[sensor]]\nkind = "x-plane"\nsimulator = "127.0.0.1:{self.aircraft.port}"\n'
            f'engage_switch = "{other_switch}"\n'
            '[[actuator]]\nkind = "servo-board"\n'
            f"[guidance]\n{guidance}\n"
            f'[recording]\nfolder = "{scratch}/recordings"\n'
            '[restart]\nmode = "warm"\n'
        )
        self.daemon = self.start()

    def start(self) -> DaemonUnderTest:
        return start(self._fccd, self._scratch, self._config)

    def close(self) -> None:
        self.daemon.__exit__()
        if self.network is not None:
            self.network.close()
        self.aircraft.stop()

    def engage(self) -> None:
        switch_on(self.aircraft, self.daemon)
        self.await_control(Control.HELD)

    def await_control(self, control: Control, within_s: float = 15.0) -> Change:
        """Wait until control is last changed to this, and return the change."""
        what = f"the board is {control.value}"
        wait_until(lambda: self._last() is control, what, within_s, daemons=[self.daemon])
        return self.aircraft.board_changes()[-1]

    def _last(self) -> Control:
        changes = self.aircraft.board_changes()
        return changes[-1].control if changes else Control.FREE


@contextmanager
def flying(
    fccd: Path, scratch: Path, way: str, guidance: str = 'mode = "hold"', **more: Any
) -> Iterator[Flight]:
    flight = Flight(fccd, scratch, way, guidance, **more)
    try:
        yield flight
    finally:
        flight.close()


def assert_failsafe(change: Change) -> None:
    """By its own clock the board waited for 200 ms, and not a pass longer."""
    assert change.control is Control.FAILSAFE
    assert change.driven == CENTRED
    assert change.silent_before_s < FAILSAFE_AFTER_S <= change.silent_s


@WAYS
def test_a_killed_daemon_leaves_the_surfaces_centred_after_200_ms(
    fccd: Path, tmp_path: Path, way: str
) -> None:
    with flying(fccd, tmp_path, way) as flight:
        flight.engage()
        time.sleep(3.0)
        flight.daemon.send(signal.SIGKILL)
        assert_failsafe(flight.await_control(Control.FAILSAFE))
        # A new one flies on.
        flight.daemon = flight.start()
        flight.await_control(Control.HELD)
        ending = flight.daemon.end(signal.SIGTERM)
        assert ending.exit_code == 0
        flight.await_control(Control.FREE)


@WAYS
def test_a_cable_that_is_pulled_out_and_put_back_is_flown_on(
    fccd: Path, tmp_path: Path, way: str
) -> None:
    with flying(fccd, tmp_path, way) as flight:
        flight.engage()
        for seconds in (0.05, 0.5):
            time.sleep(2.0)
            before = len(flight.aircraft.board_changes())
            flight.aircraft.at_board("pull")
            time.sleep(seconds)
            flight.aircraft.at_board("put_back")
            if seconds > FAILSAFE_AFTER_S:
                flight.await_control(Control.HELD)
                assert_failsafe(flight.aircraft.board_changes()[before])
        time.sleep(2.0)
        flight.aircraft.write(ENGAGE_SWITCH, 0.0)
        change = flight.await_control(Control.FREE)
        assert change.control is Control.FREE
        assert "engaged -> failsafe" not in flight.daemon.log


@WAYS
def test_a_board_that_starts_again_in_flight_is_taken_again(
    fccd: Path, tmp_path: Path, way: str
) -> None:
    with flying(fccd, tmp_path, way) as flight:
        flight.engage()
        time.sleep(2.0)
        before = len(flight.aircraft.board_changes())
        flight.aircraft.at_board("reboot")
        # It may be taken again before anybody can look, so both changes are awaited at once;
        # on a busy machine it may be let go and taken more than once.
        wait_until(
            lambda: (
                [change.control for change in flight.aircraft.board_changes()[before:]][-2:]
                == [Control.FREE, Control.HELD]
            ),
            "the board is free and held again",
        )
        time.sleep(2.0)
        assert flight.aircraft.board_changes()[-1].control is Control.HELD
        assert "engaged -> failsafe" not in flight.daemon.log


def test_without_the_way_back_it_is_failsafe_whatever_another_switch_says(
    fccd: Path, tmp_path: Path
) -> None:
    """The pilot's switch is not read any more; the simulator's, which is on, is not his."""
    with flying(fccd, tmp_path, "udp", faults=Faults(), other_switch=ENGAGE_SWITCH) as flight:
        flight.engage()
        time.sleep(2.0)
        assert flight.network is not None
        flight.network.cut_back()
        assert "engage switch is silent" in flight.daemon.wait_for("engaged -> failsafe")
        assert "engage switch: from" not in flight.daemon.log


def test_messages_that_arrive_again_seconds_later_neither_release_nor_engage(
    fccd: Path, tmp_path: Path
) -> None:
    """30 % of what the board sends arrives again, half a second to four seconds later."""
    with flying(fccd, tmp_path, "udp", faults=Faults(duplicate=0.3)) as flight:
        # Those of the switch that was off arrive after it went on, and the reverse.
        flight.engage()
        flight.daemon.wait_for("messages a second are older than others")
        assert flight._last() is Control.HELD
        flight.aircraft.write(ENGAGE_SWITCH, 0.0)
        flight.await_control(Control.FREE)
        time.sleep(LATEST_S + 1.0)
        states = [line for line in flight.daemon.log.splitlines() if " -> " in line]
    assert len(states) == 2, states
