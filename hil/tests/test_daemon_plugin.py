"""The plugin with the real daemon: on this machine, and as if on another host."""

from __future__ import annotations

import signal
import socket
from pathlib import Path

import pytest
from daemon_under_test import start, write_config
from recordings import RECORD, by_index

# What is loaded here stays: a run of pytest inside another forgets what it loads.
import fcc_hil.artifacts
import fcc_hil.daemon_rig
import fcc_hil.lockstep_rig  # noqa: F401
from fcc_hil import remote_rig
from fcc_hil.udp import free_port

FLIES = """
import pytest
from fcc_hil import altitude, heading

@pytest.mark.autopilot("hold", failsafe_hold_s=1, all_silent_s=0.5)
def test_it(flight, faults):
    flight.engages(by=5)
    flight.flies(1)
    flight.stays(heading, within=10)
    cut = faults.loss("everything")
    flight.falls_into_failsafe(by=3, after=cut)
    flight.releases(by=6, after=cut)
"""


def _run(pytester: pytest.Pytester, text: str, *options: str) -> pytest.RunResult:
    pytester.makepyfile(text)
    return pytester.runpytest_inprocess("-p", "no:cacheprovider", *options)


def test_the_same_test_in_lockstep_and_in_real_time(pytester: pytest.Pytester, fccd: Path) -> None:
    _run(pytester, FLIES).assert_outcomes(passed=1)
    _run(pytester, FLIES, "--realtime", "--fccd-program", str(fccd)).assert_outcomes(passed=1)


def test_the_same_test_with_a_daemon_started_separately(
    pytester: pytest.Pytester, fccd: Path, tmp_path: Path
) -> None:
    """It was started by somebody else, and is only known by what it does."""
    port = free_port()
    config = write_config(tmp_path, port, others="[failsafe]\nhold_s = 1.0\nall_silent_s = 0.5\n")
    with start(fccd, tmp_path, config) as there:
        options = ("--fccd", "127.0.0.1", "--fccd-listen", f"127.0.0.1:{port}")
        _run(pytester, FLIES, *options).assert_outcomes(passed=1)
        assert there.is_running, "it is not ours to end"
        ending = there.end(signal.SIGTERM)
    assert ending.report["failsafes"] == 1
    assert ending.states[:3] == ["standby -> engaged", "engaged -> failsafe", "failsafe -> standby"]


def test_a_failed_test_in_real_time_leaves_the_daemons_recording(
    pytester: pytest.Pytester, fccd: Path
) -> None:
    text = FLIES.replace("within=10", "within=1e-9")
    result = _run(pytester, text, "--realtime", "--fccd-program", str(fccd))
    result.assert_outcomes(failed=1)
    left = [Path(line) for line in result.outlines if line.startswith("/")]
    names = [path.name for path in left if path.suffix != ".py"]
    assert names == ["flight.png", "truth.csv", "recording.mcap"]
    assert any(message.topic == RECORD for message in by_index(left[-1]))


def test_a_daemon_that_does_not_start_is_reported_with_its_message(
    pytester: pytest.Pytester, fccd: Path
) -> None:
    text = (
        'import pytest\n@pytest.mark.autopilot("hold", config="[loop]\\nrate_hz = 0.5\\n")\n'
        "def test_it(flight):\n    flight.engages(by=3)\n"
    )
    options = ("--realtime", "--fccd-program", str(fccd), "--flight-artifacts", "/proc/none")
    result = _run(pytester, text, *options)
    result.assert_outcomes(failed=1)
    result.stdout.fnmatch_lines(["E *FlightError: the daemon ended with 2*", "E *loop.rate_hz*"])


def test_a_host_without_a_daemon_is_reported(
    pytester: pytest.Pytester, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(remote_rig, "_SUBSCRIBE_S", 0.5)
    at = f"127.0.0.1:{free_port()}"
    result = _run(pytester, FLIES, "--fccd", "127.0.0.1", "--fccd-listen", at)
    result.assert_outcomes(failed=1)
    result.stdout.fnmatch_lines(
        [f'E *FlightError: no daemon subscribed*is fccd running on 127.0.0.1*simulator = "{at}"*']
    )


def test_a_daemon_of_a_third_host_is_refused(
    pytester: pytest.Pytester, fccd: Path, tmp_path: Path
) -> None:
    port = free_port()
    with start(fccd, tmp_path, write_config(tmp_path, port)):
        result = _run(pytester, FLIES, "--fccd", "127.0.0.2", "--fccd-listen", f"127.0.0.1:{port}")
    result.assert_outcomes(failed=1)
    result.stdout.fnmatch_lines(["E *FlightError: 127.0.0.1 subscribed *not only 127.0.0.2*"])


def test_a_port_in_use_is_reported(pytester: pytest.Pytester) -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as taken:
        taken.bind(("127.0.0.1", 0))
        at = f"127.0.0.1:{taken.getsockname()[1]}"
        result = _run(pytester, FLIES, "--fccd", "127.0.0.1", "--fccd-listen", at)
    result.assert_outcomes(errors=1)
    result.stdout.fnmatch_lines([f"*cannot listen on {at}*"])


def test_a_daemon_killed_in_flight_is_reported(pytester: pytest.Pytester, fccd: Path) -> None:
    text = """
        import os, signal

        def test_it(daemon, flight):
            flight.engages(by=5)
            os.kill(daemon.daemon.pid, signal.SIGKILL)
            flight.flies(5)
    """
    options = ("--realtime", "--fccd-program", str(fccd), "--flight-artifacts", "/proc/none")
    result = _run(pytester, text, *options)
    result.assert_outcomes(failed=1)
    result.stdout.fnmatch_lines(["E *FlightError: the daemon ended with -9 (SIGKILL)*"])
