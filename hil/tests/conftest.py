"""The programs under test, from environment variables."""

from __future__ import annotations

import os
import signal
from pathlib import Path

import hypothesis
import pytest

# The duration of an example depends on the machine's load only.
hypothesis.settings.register_profile(
    "busy-machine", deadline=None, suppress_health_check=[hypothesis.HealthCheck.too_slow]
)
hypothesis.settings.load_profile("busy-machine")


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


@pytest.fixture(scope="session")
def fccd() -> Path:
    """Return the daemon."""
    return _program("FCCD", "cargo build --release -p fcc-daemon")


@pytest.fixture(scope="session")
def faulty_fccd() -> Path:
    """Return the daemon built with faults to inject."""
    return _program(
        "FCCD_INJECTION",
        "cargo build --release -p fcc-daemon --features fault-injection "
        "--target-dir target/injection",
    )
