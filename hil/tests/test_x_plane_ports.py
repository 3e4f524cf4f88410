"""Where X-Plane answers from, what prevents it, and what is said about it."""

from __future__ import annotations

import signal
import socket
import struct
import threading
import time
from pathlib import Path

import pytest
from daemon_under_test import assert_released, engage, flight, start, wait_until, write_config
from tampered_link import TamperedLink

from fcc_hil.fly import ENGAGE_SWITCH
from fcc_hil.process import StandInProcess
from fcc_hil.standin import Settings

SUCCESS = 0
NOT_RELEASED = 5
FORGED_EVERY_S = 0.005
FORGED = 1.0
"""In every quantity, also the simulator's time."""


def bound() -> socket.socket:
    """Return a socket that never answers, on a free port."""
    opened = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    opened.bind(("127.0.0.1", 0))
    return opened


@pytest.mark.fault(
    "Simulator and link",
    "no traffic to or from X-Plane",
    "ICMP, beacons",
    "1.5 s of silence; 3 s if nothing at all",
    "causes reported once; [ports](troubleshooting.md#ports-and-firewalls)",
)
@pytest.mark.usefixtures("beacon")
def test_a_port_without_a_program_is_distinguished_from_one_that_does_not_answer(
    fccd: Path, tmp_path: Path
) -> None:
    """Beacons of other tests would tell another port; their marks would be of this one."""
    with bound() as nobody:
        port = nobody.getsockname()[1]
    apart = {"XDG_RUNTIME_DIR": str(tmp_path)}
    with start(fccd, tmp_path, write_config(tmp_path, port), apart) as daemon:
        daemon.wait_for(f"does not answer: no program listens on UDP port {port}")
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as mute:
            mute.bind(("127.0.0.1", port))
            log = daemon.wait_for("nothing else of that machine arrives here")
            assert "Accept incoming connections" in log
            ending = daemon.end(signal.SIGTERM)
    assert ending.exit_code == SUCCESS
    # Each once, though the state lasted.
    for cause in ("no program listens", "nothing else of that machine"):
        assert sum(cause in text for text in ending.events) == 1


@pytest.mark.fault(
    "Simulator and link",
    "datagrams of another program or machine",
    "[address, port](security.md#the-network)",
    "immediately",
    "not read",
)
def test_forged_values_of_another_port_are_not_read(fccd: Path, tmp_path: Path) -> None:
    with bound() as free:
        port = free.getsockname()[1]
    over = threading.Event()
    values = b"RREF," + b"".join(struct.pack("<if", index, FORGED) for index in range(64))

    def forge() -> None:
        with bound() as forger:
            while not over.wait(FORGED_EVERY_S):
                forger.sendto(values, ("127.0.0.1", port))

    with flight(fccd, tmp_path, x_plane=f"local_port = {port}") as (simulator, daemon):
        daemon.wait_until_ready()
        forging = threading.Thread(target=forge)
        forging.start()
        try:
            engage(simulator, daemon)
            for _ in range(3):
                assert daemon.next_state() == "engaged"
        finally:
            over.set()
            forging.join()
        ending = daemon.end(signal.SIGTERM)
    assert ending.exit_code == SUCCESS
    assert ending.states == ["standby -> engaged", "engaged -> stopped"]


def test_one_forged_datagram_changes_nothing(fccd: Path, tmp_path: Path) -> None:
    """From X-Plane's own port: the time alone, and every value at once."""
    time_ahead = b"RREF," + struct.pack("<if", 0, 1e6)
    everything = [
        b"RREF," + b"".join(struct.pack("<if", index, value) for index in range(64))
        for value in (0.0, FORGED, 1e6)
    ]
    with (
        StandInProcess(Settings(port=0)) as simulator,
        TamperedLink(simulator.port) as link,
        start(fccd, tmp_path, write_config(tmp_path, link.port)) as daemon,
    ):
        engage(simulator, daemon)
        for datagram in (time_ahead, *everything):
            link.send(datagram)
            time.sleep(0.5)
        assert daemon.next_state() == "engaged"
        ending = daemon.end(signal.SIGTERM)
    assert ending.exit_code == SUCCESS
    assert ending.states == ["standby -> engaged", "engaged -> stopped"]


def test_a_link_that_is_cut_towards_x_plane_is_named_and_its_release_not_confirmed(
    fccd: Path, tmp_path: Path
) -> None:
    with (
        StandInProcess(Settings(port=0)) as simulator,
        TamperedLink(simulator.port) as link,
    ):
        with start(fccd, tmp_path, write_config(tmp_path, link.port)) as daemon:
            engage(simulator, daemon)
            link.cut(to_simulator=True)
            assert "UDP port" in daemon.wait_for("the controls written to it have no effect")
            assert daemon.next_state() == "engaged"
            ending = daemon.end(signal.SIGTERM)
        assert ending.exit_code == NOT_RELEASED
        assert simulator.progress().overridden
        assert "release sent to the actuators" in ending.events
        assert f"X-Plane at 127.0.0.1:{link.port} did not confirm the release" in ending.log
        assert "confirmed the release" not in ending.log
        link.restore()
        wait_until(lambda: not simulator.progress().overridden, "the helper releases")


def test_a_release_helper_believes_the_port_that_was_flown(fccd: Path, tmp_path: Path) -> None:
    """Another program has the port from which X-Plane usually answers."""
    host, usual, flown = "127.73.0.1", 49_001, 49_005
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other:
        other.bind((host, usual))
        settings = Settings(host=host, port=49_000, reply_port=flown)
        with StandInProcess(settings) as simulator:
            config = write_config(tmp_path, 49_000)
            config.write_text(config.read_text().replace("127.0.0.1", host))
            with start(fccd, tmp_path, config) as daemon:
                engage(simulator, daemon)
                assert simulator.reply_port == flown
                (helper,) = daemon.helpers()
                daemon.send(signal.SIGKILL)
                simulator.write(ENGAGE_SWITCH, 0.0)
                assert_released(simulator)
                # It repeats the release until it is confirmed, for two minutes.
                said = f"the daemon has ended; X-Plane at {host}:49000 was released"
                wait_until(lambda: said in daemon.log, said)
                wait_until(lambda: not Path(f"/proc/{helper}").exists(), "the helper ends")


def test_a_generic_light_that_this_version_lacks_is_named(fccd: Path, tmp_path: Path) -> None:
    switch = "sim/cockpit2/switches/generic_lights_switch[100]"
    with (
        StandInProcess(Settings(port=0, version=105_101)) as simulator,
        start(
            fccd,
            tmp_path,
            write_config(tmp_path, simulator.port, x_plane=f'engage_switch = "{switch}"'),
        ) as daemon,
    ):
        words = daemon.wait_for("does not exist in this version of X-Plane")
        assert switch in words
        assert "generic lights 0 to 63" in words
        ending = daemon.end(signal.SIGTERM)
    assert ending.exit_code == SUCCESS


def test_a_fast_loop_sends_no_more_than_a_frame_takes(fccd: Path, tmp_path: Path) -> None:
    """A loop of 1 kHz with eight engines, at 30 frames a second: without a limit, 366 a frame."""
    with flight(
        fccd,
        tmp_path,
        settings=Settings.plain(port=0, frame_rate_hz=30.0),
        x_plane="engines = 8",
        others="[loop]\nrate_hz = 1000\n[budget]\nfailsafe_after = 0\n",
    ) as (simulator, daemon):
        engage(simulator, daemon)
        for _ in range(3):
            assert daemon.next_state() == "engaged"
        status = simulator.status()
        ending = daemon.end(signal.SIGTERM)
    assert ending.report["released"] is True
    assert status["messages"]["WriteDataref"] > 1_000
    assert status["overflowed"] == 0
