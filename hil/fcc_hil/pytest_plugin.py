"""The pytest plugin: fixtures that fly, and the artifacts of failed tests.

    def test_it_turns(flight):
        flight.engages(by=3)
        flight.flies(to=20)
        flight.settles(heading, within=2, by=17)

A flight is in lockstep unless pytest has the option `--realtime` (the daemon of this machine) or
`--fccd HOST` (that of another), or the test is marked `realtime`. The marks `aircraft` and
`autopilot` configure it.
"""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable, Generator, Iterator
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

import pytest

from . import plan_file, plan_start
from .flight import Flight
from .marks import AutopilotMark, aircraft_mark, autopilot_mark
from .plan_file import PlanFile
from .plant import Plant, TrimError
from .remote_rig import RemoteRig, address_of, address_towards
from .rig import FlightError, Rig
from .sensor_faults import Faults
from .standin import Settings
from .units import STANDARD_INHG

if TYPE_CHECKING:
    import fcc

    from .daemon_rig import DaemonRig

ARTIFACTS = ".flight-artifacts"
_XPLANE_PORT = 49_000
_FLIGHTS = pytest.StashKey[list[Flight]]()
_LISTEN = pytest.StashKey[tuple[str, int]]()

Made = TypeVar("Made")


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add the options: how flights are flown, and where artifacts are saved."""
    group = parser.getgroup("flight", "flights by the flight control computer")
    group.addoption(
        "--realtime",
        action="store_true",
        help="fly in real time with the daemon of this machine, instead of in lockstep",
    )
    group.addoption(
        "--fccd",
        metavar="HOST",
        help="fly in real time with the daemon that runs on HOST, "
        "its [x-plane] simulator set to this machine",
    )
    group.addoption(
        "--fccd-listen",
        metavar="ADDRESS[:PORT]",
        help="where the stand-in listens for that daemon (this machine's address towards "
        f"HOST, port {_XPLANE_PORT})",
    )
    group.addoption(
        "--fccd-program",
        metavar="PATH",
        help="the daemon's program on this machine ($FCCD, or fccd on the path)",
    )
    group.addoption(
        "--flight-artifacts",
        metavar="DIR",
        default=ARTIFACTS,
        help="folder of the plots and recordings of failed tests (%(default)s)",
    )


def pytest_configure(config: pytest.Config) -> None:
    """Declare the marks, and check the options before any flight."""
    for line in (
        "aircraft(name, wind=(from_deg, kt), turbulence=0..7, seed, noise, heading): the aircraft",
        "autopilot(mode, plan, hold_s, leg_s, turn_deg, climb_ft, failsafe_hold_s, all_silent_s, "
        "degraded_s, config): the autopilot's settings",
        "realtime: always in real time",
    ):
        config.addinivalue_line("markers", line)
    host = config.getoption("--fccd")
    listen = config.getoption("--fccd-listen")
    if listen is not None and host is None:
        raise pytest.UsageError("--fccd-listen is for a daemon on another host: give --fccd HOST")
    if host is not None:
        try:
            address_of(host)
            config.stash[_LISTEN] = _listen_at(listen, host)
        except ValueError as error:
            raise pytest.UsageError(f"--fccd {host}: {error}") from error


def _listen_at(listen: str | None, host: str) -> tuple[str, int]:
    if listen is None:
        return address_towards(host), _XPLANE_PORT
    address, _, port = listen.partition(":")
    if port and not (port.isdecimal() and 0 < int(port) < 65_536):
        raise ValueError(f"--fccd-listen {listen}: a port is 1 to 65535")
    return address_of(address), int(port or _XPLANE_PORT)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(
    item: pytest.Item,
) -> Generator[None, pytest.TestReport, pytest.TestReport]:
    """Save the artifacts of a failed test's flights, and report where."""
    report = yield
    flights = item.stash.get(_FLIGHTS, [])
    if report.failed and report.when == "call" and flights:
        from .artifacts import folder_of, leave  # noqa: PLC0415 - plots are slow to load

        root = Path(item.config.getoption("--flight-artifacts"))
        folder = folder_of(item.config.invocation_params.dir / root, item.nodeid)
        lines = []
        for flight in flights:
            try:
                lines += [str(path) for path in leave(flight, folder)]
            except (OSError, RuntimeError) as error:
                lines.append(f"not everything was saved: {error}")
        report.sections.append(("Flight", "\n".join(lines)))
    return report


@pytest.fixture
def aircraft(request: pytest.FixtureRequest) -> Plant:
    """Return an aircraft of JSBSim in trimmed flight, as configured by the mark `aircraft`."""
    settings, plan = _settings(request), _plan(request)
    try:
        if plan is not None:
            return plan_start.plant(
                plan, settings.aircraft, seed=settings.seed, weather=settings.weather
            )
        return Plant(
            settings.aircraft,
            seed=settings.seed,
            heading_deg=settings.heading_deg,
            weather=settings.weather,
        )
    except (TrimError, ValueError) as error:
        pytest.fail(str(error), pytrace=False)


@pytest.fixture
def autopilot(request: pytest.FixtureRequest) -> fcc.Machine:
    """Return the daemon's loop, to be stepped by the test, configured by the mark `autopilot`."""
    try:
        import fcc  # noqa: PLC0415 - only flights in lockstep need it
    except ImportError:
        pytest.fail(
            "there is no module fcc: `pip install ./crates/fcc-py`, or fly with --realtime",
            pytrace=False,
        )
    mark = _autopilot(request)
    try:
        return fcc.Machine(mark.toml())
    except ValueError as error:
        pytest.fail(f"the mark autopilot: {error}", pytrace=False)


@pytest.fixture
def daemon(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[DaemonRig | RemoteRig]:
    """Fly with the daemon in real time: one of this machine, or with --fccd that of HOST."""
    from .daemon_rig import DaemonRig  # noqa: PLC0415 - as the flight in lockstep has its own

    settings, mark, config = _settings(request), _autopilot(request), request.config
    host = config.getoption("--fccd")
    rig: DaemonRig | RemoteRig
    try:
        if host is None:
            if (plan := _plan(request)) is not None:
                settings = plan_start.settings(plan, replace(settings, qnh_inhg=STANDARD_INHG))
            rig = DaemonRig(_program(config), settings, mark.toml(), tmp_path)
        else:
            rig = RemoteRig(host, config.stash[_LISTEN], settings, mark)
    except FlightError as error:
        pytest.fail(str(error), pytrace=False)
    yield rig
    rig.close()


@pytest.fixture
def flight(request: pytest.FixtureRequest) -> Iterator[Flight]:
    """Return a flight: in lockstep, or in real time with --realtime, --fccd or the mark."""
    config, settings, mark = request.config, _settings(request), _autopilot(request)
    is_real_time = (
        config.getoption("--realtime")
        or config.getoption("--fccd") is not None
        or request.node.get_closest_marker("realtime") is not None
    )
    rig: Rig
    if config.getoption("--fccd") is not None and mark.plan is not None:
        pytest.fail("a daemon on another host has its own plan: leave --fccd out", pytrace=False)
    if is_real_time:
        rig = request.getfixturevalue("daemon")
    else:
        machine = request.getfixturevalue("autopilot")
        plant = request.getfixturevalue("aircraft")
        from .lockstep_rig import Conditions, LockstepRig  # noqa: PLC0415 - it needs the module fcc

        between = None if mark.plan is None else Conditions(position=True)
        try:
            rig = LockstepRig(settings, plant, machine, between)
        except FlightError as error:
            pytest.fail(str(error), pytrace=False)
    flown = Flight(rig, mark.pattern, settings.seed, _plan(request))
    request.node.stash.setdefault(_FLIGHTS, []).append(flown)
    yield flown
    rig.close()


@pytest.fixture
def faults(flight: Flight) -> Faults:
    """Return the faults for the flight's sensors."""
    return flight.faults


def _settings(request: pytest.FixtureRequest) -> Settings:
    return _marked(request, "aircraft", aircraft_mark)


def _autopilot(request: pytest.FixtureRequest) -> AutopilotMark:
    return _marked(request, "autopilot", autopilot_mark)


def _plan(request: pytest.FixtureRequest) -> PlanFile | None:
    path = _autopilot(request).plan
    try:
        return None if path is None else plan_file.read(path)
    except (OSError, ValueError) as error:
        pytest.fail(f"the mark autopilot: {error}", pytrace=False)


def _marked(request: pytest.FixtureRequest, name: str, make: Callable[..., Made]) -> Made:
    mark = request.node.get_closest_marker(name)
    try:
        return make() if mark is None else make(*mark.args, **mark.kwargs)
    except (TypeError, ValueError) as error:
        words = str(error).replace(f"{make.__name__}()", "it")
        pytest.fail(f"the mark {name}: {words}", pytrace=False)


def _program(config: pytest.Config) -> Path:
    given = config.getoption("--fccd-program") or os.environ.get("FCCD") or "fccd"
    found = shutil.which(given)
    if found is None:
        pytest.fail(
            f"there is no program {given}: `make build`, and give its "
            "path with --fccd-program or in $FCCD",
            pytrace=False,
        )
    return Path(found)
