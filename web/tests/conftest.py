"""The real station beside the real daemon, for the page in a browser."""

from __future__ import annotations

import contextlib
import os
import shutil
import signal
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest
from ground_station import ROOT, Station, make_ground
from playwright.sync_api import Browser, sync_playwright

from air import Air, Visit
from visitor import Visitor, chromium


def _program(variable: str) -> Path:
    path = os.environ.get(variable)
    assert path, f"{variable}=FILE is not set: `make test-page` sets it"
    return Path(path)


@pytest.fixture(scope="session")
def browser() -> Iterator[Browser]:
    with sync_playwright() as playwright:
        opened = chromium(playwright)
        yield opened
        opened.close()


@pytest.fixture(scope="session")
def fccd() -> Path:
    return _program("FCCD")


@pytest.fixture(scope="session")
def station_program() -> Path:
    return _program("FCC_GROUND")


@pytest.fixture
def visit(browser: Browser) -> Iterator[Visit]:
    with contextlib.ExitStack() as ends:

        def make(station: Station, size: str = "desktop", *, token: bool = True) -> Visitor:
            link = station.link if token else station.address
            visitor = Visitor(browser, link, size, aircraft=station.instance)
            ends.callback(visitor.context.close)
            return visitor

        yield make


@pytest.fixture
def air(tmp_path: Path, fccd: Path, station_program: Path) -> Iterator[Air]:
    with contextlib.ExitStack() as ends:
        yield Air(tmp_path, fccd, station_program, ends)


@pytest.fixture(scope="session")
def flown(tmp_path_factory: pytest.TempPathFactory, fccd: Path) -> Path:
    """Return a folder with the recording of a plan, flown as fast as it computes."""
    folder = tmp_path_factory.mktemp("flown")
    plan = ROOT / "config/plans/circuit.waypoints"
    words: list[str | Path] = [
        fccd,
        "fly",
        "--lockstep",
        "--quiet",
        "--plan",
        plan,
        "--recordings",
        folder,
    ]
    subprocess.run(words, check=True, stdout=subprocess.DEVNULL)
    return folder


@pytest.fixture(scope="session")
def cruise(
    tmp_path_factory: pytest.TempPathFactory, fccd: Path, station_program: Path, flown: Path
) -> Iterator[Air]:
    """Give one that flies on through all tests of a worker, with a flight that has landed."""
    folder = tmp_path_factory.mktemp("cruise")
    shutil.copytree(flown, folder / "recordings")
    with contextlib.ExitStack() as ends:
        started = Air(folder, fccd, station_program, ends)
        started.station.carried_out("engage")
        yield started


@pytest.fixture
def ground(tmp_path: Path, fccd: Path, station_program: Path) -> Iterator[Station]:
    """Give what `make ground` starts: the aircraft on its runway."""
    started = make_ground(tmp_path, fccd, str(station_program))
    try:
        yield started
    finally:
        started.end()


@pytest.fixture(autouse=True)
def _hang_up() -> None:
    # Under nohup a hang-up is ignored, and the started programs inherit that.
    signal.signal(signal.SIGHUP, signal.SIG_DFL)
