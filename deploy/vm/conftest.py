"""A booted guest for each module, and the package built by `make test-vm`."""

from __future__ import annotations

import os
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from guest import INSTALL_S, Guest, accelerator

FIGURES = pytest.StashKey[list[str]]()


def pytest_configure(config: pytest.Config) -> None:
    config.stash[FIGURES] = [f"the guest is run by {accelerator()}"]


def pytest_terminal_summary(
    terminalreporter: pytest.TerminalReporter, config: pytest.Config
) -> None:
    """Print the measured times, which are not asserted, because machines differ."""
    terminalreporter.section("measured")
    for line in config.stash[FIGURES]:
        terminalreporter.line(line)


def _path(variable: str) -> Path:
    path = Path(os.environ.get(variable, "nowhere"))
    if not path.exists():
        pytest.fail(f"{variable}: there is no {path}: make test-vm", pytrace=False)
    return path


@pytest.fixture(scope="session")
def figures(pytestconfig: pytest.Config) -> list[str]:
    """Return the lines that are printed at the end."""
    return pytestconfig.stash[FIGURES]


@pytest.fixture(scope="session")
def package() -> Path:
    """Return the Debian package."""
    return _path("DEB")


@pytest.fixture(scope="module")
def bare(tmp_path_factory: pytest.TempPathFactory, figures: list[str]) -> Iterator[Guest]:
    """Boot a machine on which fccd was never installed."""
    with Guest(_path("VM_IMAGE"), tmp_path_factory.mktemp("guest")) as guest:
        figures.append(f"booted in {guest.boot_s:.1f} s")
        yield guest


@pytest.fixture(scope="module")
def guest(bare: Guest, package: Path, figures: list[str]) -> Guest:
    """Return a machine with the package installed, as docs/deploy.md says."""
    begun_s = time.monotonic()
    bare.agent.write("/root/fccd.deb", package.read_bytes())
    bare.sh("apt-get install --yes /root/fccd.deb", within_s=INSTALL_S)
    figures.append(f"installed in {time.monotonic() - begun_s:.1f} s")
    return bare
