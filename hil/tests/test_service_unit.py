"""The systemd unit: valid, restricted, and with the rights needed to fly."""

from __future__ import annotations

import re
import shutil
import signal
import subprocess
from pathlib import Path

import pytest
from daemon_under_test import DaemonUnderTest, engage, write_config

from fcc_hil.process import StandInProcess
from fcc_hil.standin import Settings

UNIT = Path(__file__).parents[2] / "deploy" / "fccd.service"
MOST_EXPOSED = 2.0
_TRACED_S = 120.0


def analyze(*words: str | Path) -> str:
    program = shutil.which("systemd-analyze")
    assert program, "there is no systemd-analyze: apt-get install systemd"
    done = subprocess.run([program, *words], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout + done.stderr


def settings(name: str) -> list[str]:
    """Return the values of a setting, in their order."""
    return re.findall(rf"^{name}=(.*)$", UNIT.read_text(), re.MULTILINE)


def test_systemd_verifies_the_unit(fccd: Path, tmp_path: Path) -> None:
    unit = tmp_path / UNIT.name
    unit.write_text(UNIT.read_text().replace("/usr/bin/fccd", str(fccd)))
    assert analyze("verify", "--man=no", unit).strip() == ""


def test_little_is_exposed() -> None:
    log = analyze("security", "--offline=true", UNIT)
    found = re.search(r"Overall exposure level for \S+: ([\d.]+)", log)
    assert found is not None, log
    assert float(found[1]) <= MOST_EXPOSED


def test_the_system_calls_of_a_flight_are_permitted(fccd: Path, tmp_path: Path) -> None:
    """Every system call of a flight, by the unit's own filter."""
    strace = shutil.which("strace")
    assert strace, "there is no strace: apt-get install strace"
    trace = tmp_path / "calls"
    with StandInProcess(Settings(port=0)) as simulator:
        config = write_config(tmp_path, simulator.port)
        command: list[str | Path] = [strace, "-fqqc", "-o", trace, fccd, "run", "--config", config]
        with DaemonUnderTest([*command, "--json"], tmp_path) as daemon:
            engage(simulator, daemon)
            pid = Path(f"/proc/{daemon.pid}/task/{daemon.pid}/children").read_text().split()[0]
            subprocess.run(["kill", f"-{signal.SIGTERM.value}", pid], check=True)
            daemon.end(within_s=_TRACED_S)
    # Rows of the table: they begin with their share of the time.
    called = set(re.findall(r"^ *[\d.]+ .* (\w+)$", trace.read_text(), re.MULTILINE)) - {"total"}
    assert {"sched_setattr", "sched_setscheduler"} & called, called
    assert called - allowed_calls() == set()


def allowed_calls() -> set[str]:
    """Return the system calls that the unit permits."""
    allowed = _calls("@system-service")
    for taken in " ".join(settings("SystemCallFilter")).split("~")[1:]:
        for group in taken.split():
            allowed -= _calls(group)
    return allowed


def _calls(group: str) -> set[str]:
    """Return the system calls of a group, those of the groups in it included."""
    calls: set[str] = set()
    for line in analyze("syscall-filter", group).splitlines()[1:]:
        word = line.split("#")[0].strip()
        if word.startswith("@"):
            calls |= _calls(word)
        elif word:
            calls.add(word)
    return calls


@pytest.mark.parametrize(
    ("name", "values"),
    [
        ("Type", ["notify"]),
        ("LimitMEMLOCK", ["infinity"]),
        ("LimitRTPRIO", ["99"]),
        ("Restart", ["on-failure"]),
        # Usage, real-time refused: what would fail again at once; and a flight that is over.
        ("RestartPreventExitStatus", ["2 4 14"]),
        ("User", ["fccd"]),
    ],
)
def test_required_settings(name: str, values: list[str]) -> None:
    assert settings(name) == values
