"""The programs under test, from environment variables."""

from __future__ import annotations

import fcntl
import os
import signal
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path

import hypothesis
import pytest

from fcc_hil.standin import BEACON_GROUP

# The duration of an example depends on the machine's load only.
hypothesis.settings.register_profile(
    "busy-machine", deadline=None, suppress_health_check=[hypothesis.HealthCheck.too_slow]
)
hypothesis.settings.load_profile("busy-machine")


def pytest_configure(config: pytest.Config) -> None:
    config.addinivalue_line(
        "markers",
        "fault(section, fault, detection, after, reaction): a row of docs/faults.md; "
        "`scripts/tables` writes it",
    )


# Under nohup a hang-up is ignored, and the started programs inherit that.
signal.signal(signal.SIGHUP, signal.SIG_DFL)


def _program(variable: str, build: str) -> Path:
    path = os.environ.get(variable)
    if not path:
        pytest.fail(f"{variable} is not set: `{build}`, and give the program's path", pytrace=False)
    program = Path(path)
    if not os.access(program, os.X_OK):
        pytest.fail(f"{variable}: {program} is no program: `{build}`", pytrace=False)
    return program


@pytest.fixture
def beacon(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[str, int]]:
    """Return X-Plane's multicast group: of tests that run side by side, one uses it at a time."""
    shared = tmp_path_factory.getbasetemp().parent / "beacon.lock"
    with shared.open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        yield BEACON_GROUP


@pytest.fixture(scope="session")
def fccd() -> Path:
    """Return the daemon."""
    return _program("FCCD", "make build")


@pytest.fixture(scope="session")
def faulty_fccd() -> Path:
    """Return the daemon built with faults to inject."""
    return _program("FCCD_INJECTION", "make tested")


@pytest.fixture(scope="session")
def lockstep() -> Path:
    """Return the multicopter's controller as a process."""
    return _program("FCC_LOCKSTEP", "make tested")


@pytest.fixture
def scratch() -> Iterator[Path]:
    """Give a folder that other users can enter; those of pytest are closed to them."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        folder.chmod(0o755)
        yield folder


@pytest.fixture(scope="session")
def measured() -> Callable[[str, object], None]:
    """Append a figure of a flight to what a goal writes results from (`scripts/results`)."""

    def append(what: str, value: object) -> None:
        if path := os.environ.get("FCC_MEASURED"):
            with Path(path).open("a", encoding="utf-8") as file:
                file.write(f"{what}\t{value}\n")

    return append
