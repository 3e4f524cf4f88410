"""A daemon that is killed in flight and started again: asserted on the aircraft.

Only the daemon is killed; the simulator continues, its engage switch still on, and the release
helper releases the controls to a pilot who does not move them.
"""

from __future__ import annotations

import contextlib
import json
import os
import re
import signal
import subprocess
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from daemon_under_test import (
    DaemonUnderTest,
    Ending,
    assert_released,
    engage,
    flight,
    open_files,
    start,
    wait_until,
    write_config,
)
from fault_flights import ENGAGED, NS
from recordings import RECORD, in_sequence

from fcc_hil.fly import ENGAGE_SWITCH
from fcc_hil.process import StandInProcess
from fcc_hil.standin import Settings

SUCCESS = 0
RECOVERED_S = 3.0
"""Nominally 0.7 s; machines are busy with other things."""
WARM = '[restart]\nmode = "warm"\n'
# Long legs: killed early in the first, the aircraft is far from its set points, and a recovered
# flight differs clearly from a new capture.
PATTERN = 'mode = "timed-pattern"\nhold_s = 1.0\nleg_s = 60.0\nturn_deg = 90.0\nclimb_ft = 150.0'

_AIMS = re.compile(r"hdg +\d+→ *(\d+)°.*alt +-?\d+→ *(-?\d+) ft.*→ *(\d+) kt")


@dataclass(frozen=True)
class Aims:
    """The set points in the daemon's status line."""

    heading_deg: float
    altitude_ft: float
    airspeed_kt: float

    @classmethod
    def of(cls, line: str) -> Aims:
        found = _AIMS.search(line)
        assert found is not None, line
        return cls(float(found[1]), float(found[2]), float(found[3]))


class Cockpit:
    """A simulator in flight, and successive daemons."""

    def __init__(self, fccd: Path, scratch: Path, simulator: StandInProcess) -> None:
        self.fccd = fccd
        self.scratch = scratch
        self.simulator = simulator
        self.state_file = scratch / "recordings" / "fccd.flight"
        self._daemons = 0

    @contextlib.contextmanager
    def daemon(self, others: str, guidance: str = PATTERN) -> Iterator[DaemonUnderTest]:
        self._daemons += 1
        scratch = self.scratch / f"daemon-{self._daemons}"
        scratch.mkdir()
        config = write_config(self.scratch, self.simulator.port, others=others, guidance=guidance)
        with start(self.fccd, scratch, config) as daemon:
            yield daemon

    def fly_and_kill(
        self, others: str, guidance: str = PATTERN, *, with_helper: bool = False
    ) -> Aims:
        """Fly into the first turn, and kill the daemon; return its set points."""
        with self.daemon(others, guidance) as daemon:
            captured = self.engage(daemon)
            aims = captured
            while guidance == PATTERN and aims.heading_deg == captured.heading_deg:
                aims = Aims.of(daemon.wait_for("→"))
            wait_until(self.state_file.exists, "the state of the flight is stored")
            # It is kept each second.
            Aims.of(daemon.wait_for("→"))
            aims = Aims.of(daemon.wait_for("→"))
            if with_helper:
                # Stopped, it does not replace the helper.
                os.kill(daemon.pid, signal.SIGSTOP)
                for helper in daemon.helpers():
                    os.kill(helper, signal.SIGKILL)
            daemon.end(signal.SIGKILL)
        return aims

    def engage(self, daemon: DaemonUnderTest) -> Aims:
        engage(self.simulator, daemon)
        return Aims.of(daemon.wait_for("→"))


def first_engaged_ns(ending: Ending) -> int:
    """Return when the loop first woke up engaged, by the machine's monotonic clock."""
    (path,) = ending.report["recording"]["files"]
    return next(
        int(seen.content.tick.woke_ns)
        for seen in in_sequence(Path(path))
        if seen.topic == RECORD and seen.content.state.phase == ENGAGED
    )


@pytest.fixture
def cockpit(fccd: Path, tmp_path: Path) -> Iterator[Cockpit]:
    with StandInProcess(Settings(port=0)) as simulator:
        yield Cockpit(fccd, tmp_path, simulator)


def test_a_warm_restart_continues_the_flight(
    cockpit: Cockpit, record_property: Callable[[str, object], None]
) -> None:
    simulator = cockpit.simulator
    aims = cockpit.fly_and_kill(WARM)
    killed_at_s = simulator.progress().time_s
    begun_ns = time.monotonic_ns()
    with cockpit.daemon(WARM) as again:
        again.wait_for("recovering it")
        assert "timed-pattern, " in again.wait_for("the flight was recovered")
        resumed = Aims.of(again.wait_for("→"))
        assert resumed.heading_deg == aims.heading_deg
        assert resumed.altitude_ft == pytest.approx(aims.altitude_ft, abs=1.0)
        assert resumed.airspeed_kt == pytest.approx(aims.airspeed_kt, abs=0.2)
        taken_at_s = simulator.progress().time_s
        # The release helper of the killed daemon does not release the controls again.
        wait_until(
            lambda: simulator.progress().time_s > taken_at_s + 25.0, "25 s of flight", within_s=90.0
        )
        assert simulator.progress().overridden
        ending = again.end(signal.SIGTERM)
        assert_released(simulator)
    assert ending.exit_code == SUCCESS
    assert ending.states == ["standby -> engaged", "engaged -> stopped"]
    assert ending.report["failsafes"] == 0
    took_s = (first_engaged_ns(ending) - begun_ns) * NS
    record_property("taken_up_after_s", took_s)
    print(f"recovered {took_s:.3f} s after the process' start")
    assert 0.0 < took_s < RECOVERED_S

    truth = simulator.truth()
    time_s, altitude_ft = truth["time_s"], truth["altitude_ft"]
    start_ft = aims.altitude_ft - 150.0
    flown = time_s > killed_at_s
    assert altitude_ft[flown].min() > start_ft - 50.0, "height was lost"
    arrived = time_s > taken_at_s + 20.0
    # The stand-in's elevation and the altimeter's altitude differ by their datum.
    assert np.ptp(altitude_ft[arrived]) < 10.0
    assert np.ptp(truth["heading_deg"][arrived]) < 2.0
    assert not cockpit.state_file.exists(), "a flight that ended regularly is not recovered"


def test_a_cold_restart_stays_in_standby_and_reports_it(cockpit: Cockpit) -> None:
    cockpit.fly_and_kill("")
    with cockpit.daemon("") as again:
        assert "staying in standby" in again.wait_for('restart.mode is "cold"')
        wait_until(lambda: not cockpit.simulator.progress().overridden, "the helper releases")
        again.wait_until_ready()
        assert again.next_state() == "standby"
        assert not cockpit.simulator.progress().overridden
        # It flies after the switch goes on.
        cockpit.simulator.write(ENGAGE_SWITCH, 0.0)
        again.wait_until_ready()
        cockpit.engage(again)
        ending = again.end(signal.SIGTERM)
    assert ending.states == ["standby -> engaged", "engaged -> stopped"]


def test_a_damaged_state_file_is_a_cold_restart(cockpit: Cockpit) -> None:
    cockpit.fly_and_kill(WARM)
    whole = cockpit.state_file.read_bytes()
    cockpit.state_file.write_bytes(whole.replace(b'"altitude_m":', b'"altitude_m":1'))
    with cockpit.daemon(WARM) as again:
        assert "is damaged; staying in standby" in again.wait_for(str(cockpit.state_file))
        again.wait_until_ready()
        assert again.next_state() == "standby"
        assert again.end(signal.SIGTERM).states == ["standby -> stopped"]


def test_another_configuration_is_a_cold_restart(cockpit: Cockpit) -> None:
    cockpit.fly_and_kill(WARM)
    with cockpit.daemon(WARM, guidance='mode = "hold"') as again:
        assert "staying in standby" in again.wait_for("another configuration")
        again.wait_until_ready()
        assert again.end(signal.SIGTERM).states == ["standby -> stopped"]


def test_a_switch_that_went_off_since_prevents_recovery(cockpit: Cockpit) -> None:
    # The release helper is killed, too, as if the machine had lost power.
    cockpit.fly_and_kill(WARM, with_helper=True)
    cockpit.simulator.write(ENGAGE_SWITCH, 0.0)
    assert cockpit.simulator.progress().overridden
    with cockpit.daemon(WARM) as again:
        again.wait_for("it was switched off since")
        wait_until(lambda: not cockpit.simulator.progress().overridden, "the pilot has control")
        again.wait_until_ready()
        assert again.end(signal.SIGTERM).states == ["standby -> stopped"]


def test_a_flight_that_ended_regularly_is_not_recovered(cockpit: Cockpit) -> None:
    with cockpit.daemon(WARM) as daemon:
        cockpit.engage(daemon)
        wait_until(cockpit.state_file.exists, "the state of the flight is stored")
        daemon.end(signal.SIGTERM)
    assert not cockpit.state_file.exists()
    with cockpit.daemon(WARM) as again:
        again.wait_until_ready()
        ending = again.end(signal.SIGTERM)
    assert ending.states == ["standby -> stopped"]
    assert "was interrupted" not in ending.log


def test_a_helper_of_an_earlier_daemon_is_ended(fccd: Path, tmp_path: Path) -> None:
    """It would release what the next daemon flies; one that is stopped does not wait for it."""
    folder = tmp_path / "run"
    folder.mkdir(mode=0o700)
    environment = {"RUNTIME_DIRECTORY": str(folder)}
    with flight(fccd, tmp_path, environment=environment) as (simulator, daemon):
        address = f"127.0.0.1:{simulator.port}"
        with (
            subprocess.Popen(
                [fccd, "release-helper"],
                stdin=subprocess.PIPE,
                text=True,
                env={**os.environ, **environment},
            ) as helper,
            contextlib.ExitStack() as stack,
        ):
            # Stopped, it would be waited for for ever.
            stack.callback(helper.kill)
            assert helper.stdin is not None
            config = json.dumps(f'[x-plane]\nsimulator = "{address}"\n')
            helper.stdin.write(f"{config}\nheld 1 X-Plane at {address}\n")
            helper.stdin.flush()

            def has_lock_and_socket() -> bool:
                held = open_files(helper.pid)
                return any(name.endswith(".helper") for name in held) and any(
                    name.startswith("socket:") for name in held
                )

            wait_until(has_lock_and_socket, "its lock and its socket")
            helper.send_signal(signal.SIGSTOP)
            engage(simulator, daemon)
            daemon.wait_for("the release helper of the previous daemon was ended")
            assert helper.wait(15.0) == -signal.SIGKILL
        assert simulator.progress().overridden
        assert daemon.end(signal.SIGTERM).exit_code == SUCCESS
        assert_released(simulator)
    assert list(folder.iterdir()) == [], "nothing is left to do"
