"""A port that is closed: of a simulator, or of a relay before it, which live or have ended."""

from __future__ import annotations

import contextlib
import select
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from daemon_under_test import (
    DaemonUnderTest,
    assert_released,
    engage,
    start,
    wait_until,
    write_config,
)
from other_user import needs_two_users
from test_release_helper import CUT_OFF

from fcc_hil.process import StandInProcess
from fcc_hil.standin import Settings
from fcc_hil.udp import free_port

SUCCESS = 0
NOT_RELEASED = 5


class Relay(threading.Thread):
    """A program at the simulator's port that passes everything on, as port forwarding does."""

    def __init__(self, simulator: int, port: int = 0) -> None:
        super().__init__(daemon=True)
        self._to = ("127.0.0.1", simulator)
        self._answers = _bound(0)
        # Closed for a while it must not be given to another.
        self._listening: socket.socket | None = _bound(port or free_port())
        self.port: int = self._listening.getsockname()[1]
        self._daemon: tuple[str, int] | None = None
        self._lock = threading.Lock()

    def run(self) -> None:
        while True:
            with self._lock:
                listening = self._listening
            sockets = [self._answers] if listening is None else [self._answers, listening]
            with contextlib.suppress(OSError, ValueError):
                for ready in select.select(sockets, [], [], 0.01)[0]:
                    datagram, sender = ready.recvfrom(65_535)
                    if ready is listening:
                        self._daemon = sender
                        self._answers.sendto(datagram, self._to)
                    elif self._daemon is not None:
                        self._answers.sendto(datagram, self._daemon)

    def close(self) -> None:
        with self._lock:
            assert self._listening is not None
            self._listening.close()
            self._listening = None

    def open(self) -> None:
        with self._lock:
            self._listening = _bound(self.port)


def _bound(port: int) -> socket.socket:
    bound = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    bound.bind(("127.0.0.1", port))
    bound.setblocking(False)
    return bound


WITHOUT_CAPABILITIES = ["setpriv", "--bounding-set=-all", "--inh-caps=-all"]
"""So that it cannot look at a process that has them, as at one of another user."""


@pytest.mark.parametrize("by", [signal.SIGTERM, signal.SIGKILL])
@pytest.mark.parametrize("sees", ["it", pytest.param("it not", marks=needs_two_users)])
def test_a_port_that_is_closed_is_not_the_end_of_a_simulator(
    fccd: Path, tmp_path: Path, by: signal.Signals, sees: str
) -> None:
    """It was taken for that, and the controls stayed held with exit code 0."""
    with StandInProcess(Settings(port=0)) as simulator:
        relay = Relay(simulator.port)
        relay.start()
        config = write_config(tmp_path, relay.port)
        words: list[str | Path] = [fccd, "run", "--config", config, "--json"]
        with DaemonUnderTest(words if sees == "it" else WITHOUT_CAPABILITIES + words, tmp_path) as (
            daemon
        ):
            engage(simulator, daemon)
            relay.close()
            ending = daemon.end(by, within_s=8.0)
            # Longer than a release that is believed to be over.
            time.sleep(4.0)
            assert simulator.progress().overridden
            assert "has ended, and nothing holds" not in daemon.log
            assert ending.exit_code == (NOT_RELEASED if by is signal.SIGTERM else -by)
            relay.open()
            assert_released(simulator)


@contextlib.contextmanager
def relay_process(to: int, port: int = 0) -> Iterator[tuple[subprocess.Popen[str], int]]:
    """Run a relay as a program of its own, and give its port."""
    words = [sys.executable, __file__, str(to), str(port)]
    with subprocess.Popen(words, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        try:
            yield process, int(process.stdout.readline())
        finally:
            process.kill()


def test_what_was_held_behind_a_relay_that_was_killed_is_released_by_the_next_start(
    fccd: Path, tmp_path: Path
) -> None:
    """The relay is taken for the simulator, and has ended."""
    with StandInProcess(Settings(port=0)) as simulator:
        with relay_process(simulator.port) as (relay, port):
            config = write_config(tmp_path, port)
            with start(fccd, tmp_path, config) as daemon:
                engage(simulator, daemon)
                relay.kill()
                relay.wait()
                ending = daemon.end(signal.SIGTERM)
        assert ending.exit_code == SUCCESS
        assert "has ended, and nothing holds" in ending.log
        assert simulator.progress().overridden
        with relay_process(simulator.port, port), start(fccd, tmp_path, config) as again:
            assert "they are released" in again.wait_for(CUT_OFF)
            wait_until(lambda: not simulator.progress().overridden, "they are")


def test_a_helper_waits_for_a_relay_that_was_killed(fccd: Path, tmp_path: Path) -> None:
    with StandInProcess(Settings(port=0)) as simulator:
        with relay_process(simulator.port) as (relay, port):
            config = write_config(tmp_path, port)
            with start(fccd, tmp_path, config) as daemon:
                engage(simulator, daemon)
                relay.kill()
                relay.wait()
                daemon.end(signal.SIGKILL)
        # Longer than a release that is believed to be over.
        time.sleep(4.0)
        assert simulator.progress().overridden
        with relay_process(simulator.port, port):
            assert_released(simulator)


if __name__ == "__main__":
    of_its_own = Relay(int(sys.argv[1]), int(sys.argv[2]))
    print(of_its_own.port, flush=True)
    of_its_own.run()
