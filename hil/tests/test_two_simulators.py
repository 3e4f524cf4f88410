"""Two simulators at one address announce themselves: who is held is not left for the other."""

from __future__ import annotations

import signal
import subprocess
import sys
from pathlib import Path

import pytest
from daemon_under_test import engage, start, wait_until
from other_user import NOBODY, as_user, needs_two_users

from fcc_hil.fly import ENGAGE_SWITCH
from fcc_hil.process import StandInProcess
from fcc_hil.protocol import Dialect
from fcc_hil.protocol import beacon as announcement
from fcc_hil.standin import Mode, Settings

SUCCESS = 0
NOT_RELEASED = 5


# Sends the datagram to the group a hundred times a second.
ANNOUNCES = """
import socket, sys, time
s = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
s.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, socket.inet_aton("127.0.0.1"))
while True:
    s.sendto(bytes.fromhex(sys.argv[1]), (sys.argv[2], int(sys.argv[3])))
    time.sleep(0.01)
"""
# No ephemeral port: a stand-in may have had one, and its killed daemon has left it held.
NOT_THERE = 19_999


def write_beacon_config(scratch: Path) -> Path:
    """Write a configuration that enters failsafe soon after a simulator hangs."""
    path = scratch / "fccd.toml"
    path.write_text(
        '[x-plane]\nsimulator = "beacon"\n[guidance]\nmode = "hold"\n'
        "[failsafe]\nhold_s = 0.5\nsensor_max_age_ms = 600\nall_silent_s = 0.6\n"
        f'[recording]\nfolder = "{scratch}/recordings"\n'
    )
    return path


@pytest.mark.fault(
    "Simulator and link",
    "flown simulator hangs, another announces itself",
    "beacon",
    "with beacon",
    "first kept until 5 s after its confirmed release, or its port is closed; machine off: "
    "restart `fccd`",
)
def test_a_simulator_that_hangs_is_kept_until_its_controls_are_released(
    fccd: Path, tmp_path: Path, beacon: tuple[str, int]
) -> None:
    config = write_beacon_config(tmp_path)
    with (
        StandInProcess(Settings(port=0, beacon=beacon)) as first,
        start(fccd, tmp_path, config) as daemon,
    ):
        engage(first, daemon)
        first.set_mode(Mode.FROZEN)
        daemon.wait_for("failsafe -> standby")
        with StandInProcess(Settings(port=0, beacon=beacon)) as second:
            kept = daemon.wait_for("another X-Plane announced itself")
            assert f"X-Plane at 127.0.0.1:{first.port} is kept until it confirms" in kept
            first.set_mode(Mode.RUNNING)
            daemon.wait_for(f"X-Plane at 127.0.0.1:{first.port} confirmed the release")
            assert not first.progress().overridden
            # It ends, and the other one is flown.
            first.kill()
            daemon.wait_for(f"X-Plane at 127.0.0.1:{second.port} answers", 20.0)
            engage(second, daemon)
            ending = daemon.end(signal.SIGTERM)
            assert not second.progress().overridden
    assert f"X-Plane at 127.0.0.1:{second.port} confirmed the release" in ending.log
    assert ending.report["released"] is True


def test_an_exit_says_that_the_simulator_that_hangs_is_not_released(
    fccd: Path, tmp_path: Path, beacon: tuple[str, int]
) -> None:
    config = write_beacon_config(tmp_path)
    with StandInProcess(Settings(port=0, beacon=beacon)) as first:
        with start(fccd, tmp_path, config) as daemon:
            engage(first, daemon)
            first.set_mode(Mode.FROZEN)
            daemon.wait_for("release sent to the actuators")
            with StandInProcess(Settings(port=0, beacon=beacon)):
                daemon.wait_for("another X-Plane announced itself")
                ending = daemon.end(signal.SIGTERM)
        assert ending.exit_code == NOT_RELEASED
        assert ending.report["released"] is False
        assert f"X-Plane at 127.0.0.1:{first.port} did not confirm the release" in ending.log
        # The helper releases it when it returns.
        first.write(ENGAGE_SWITCH, 0.0)
        first.set_mode(Mode.RUNNING)
        wait_until(lambda: not first.progress().overridden, "the helper releases")


@needs_two_users
def test_another_user_who_announces_a_simulator_gets_no_aircraft_that_is_held(
    fccd: Path, tmp_path: Path, beacon: tuple[str, int]
) -> None:
    datagram = announcement(Dialect(121_000), NOT_THERE, "forged").hex()
    words = [*as_user(NOBODY), sys.executable, "-I", "-c", ANNOUNCES, datagram]
    with (
        StandInProcess(Settings(port=0, beacon=beacon)) as simulator,
        start(fccd, tmp_path, write_beacon_config(tmp_path)) as daemon,
    ):
        engage(simulator, daemon)
        impostor = subprocess.Popen([*words, beacon[0], str(beacon[1])], cwd="/")
        try:
            simulator.set_mode(Mode.FROZEN)
            kept = daemon.wait_for("another X-Plane announced itself")
            assert f"X-Plane at 127.0.0.1:{simulator.port} is kept until it confirms" in kept
            daemon.wait_for("failsafe -> standby")
            simulator.set_mode(Mode.RUNNING)
            daemon.wait_for(f"X-Plane at 127.0.0.1:{simulator.port} confirmed the release")
            assert not simulator.progress().overridden
        finally:
            impostor.kill()
            impostor.wait()
        ending = daemon.end(signal.SIGTERM)
    assert ending.report["released"] is True


@needs_two_users
def test_another_user_who_announces_a_simulator_before_the_first_contact_is_left_again(
    fccd: Path, tmp_path: Path, beacon: tuple[str, int]
) -> None:
    """The real one has its turn after 2 s, and the other address is named."""
    datagram = announcement(Dialect(121_000), NOT_THERE, "forged").hex()
    words = [*as_user(NOBODY), sys.executable, "-I", "-c", ANNOUNCES, datagram]
    with (
        start(fccd, tmp_path, write_beacon_config(tmp_path)) as daemon,
        subprocess.Popen([*words, beacon[0], str(beacon[1])], cwd="/") as impostor,
    ):
        try:
            daemon.wait_for(f"X-Plane at 127.0.0.1:{NOT_THERE} does not answer")
            with StandInProcess(Settings(port=0, beacon=beacon)) as simulator:
                daemon.wait_for(f"X-Plane at 127.0.0.1:{simulator.port} answers")
                engage(simulator, daemon)
                assert daemon.end(signal.SIGTERM).exit_code == SUCCESS
        finally:
            impostor.kill()
