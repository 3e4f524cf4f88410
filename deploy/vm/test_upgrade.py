"""An upgrade in flight, a removal in flight, and a purge, in sequence."""

from __future__ import annotations

import re
import subprocess
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import pytest
from fault_flights import assert_regular
from fcc_hil.process import StandInProcess

from guest import INSTALL_S, Guest
from service import (
    CONFIG,
    ENGAGED,
    PERIOD_NS,
    RECORDINGS,
    Service,
    assert_control_is_kept,
    flight,
)

NEWER = "99.0-1"
RUNNING = (
    "MainPID",
    "NRestarts",
    "ActiveState",
    "ActiveEnterTimestampMonotonic",
    "ExecMainStartTimestampMonotonic",
    "StatusText",
)


@pytest.fixture(scope="module")
def newer(package: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the package with a higher version and with another line in its unit."""
    folder = tmp_path_factory.mktemp("newer")
    unpacked = folder / "unpacked"
    subprocess.run(["dpkg-deb", "--raw-extract", package, unpacked], check=True)
    control = unpacked / "DEBIAN/control"
    text, changed = re.subn("^Version: .*$", f"Version: {NEWER}", control.read_text(), flags=re.M)
    assert changed == 1
    control.write_text(text)
    (unit,) = unpacked.glob("**/fccd.service")
    unit.write_text(unit.read_text().replace("Description=", "Description=Newer "))
    path = folder / "fccd.deb"
    subprocess.run(
        ["dpkg-deb", "--root-owner-group", "--build", unpacked, path],
        check=True,
        stdout=subprocess.DEVNULL,
    )
    return path


@dataclass
class Story:
    """The results of each step."""

    flown_before: dict[str, str] = field(default_factory=dict)
    flown_after: dict[str, str] = field(default_factory=dict)
    program_before: str = ""
    program_after: str = ""
    needs_reload: str = ""
    overridden: bool = False
    restarted: dict[str, str] = field(default_factory=dict)
    restarted_program: str = ""
    restarted_description: str = ""
    through_the_upgrade: str = ""


def _running(service: Service) -> dict[str, str]:
    return {name: service.show(name) for name in RUNNING}


def _program(service: Service) -> str:
    """Return the file that it runs, according to the kernel."""
    return service.guest.sh(f"readlink /proc/{service.pid}/exe").strip()


Flying = tuple[StandInProcess, Service, Story]


@pytest.fixture(scope="module")
def upgraded(guest: Guest, newer: Path) -> Iterator[Flying]:
    """Upgrade in flight, fly on, and restart the service; then fly again."""
    story = Story()
    with flight(guest) as (simulator, service):
        service.engage(simulator)
        service.fly_on(simulator, 2.0)
        service.wait_for_status("engaged$")
        story.flown_before, story.program_before = _running(service), _program(service)
        guest.agent.write("/root/newer.deb", newer.read_bytes())
        guest.sh("apt-get install --yes /root/newer.deb", within_s=INSTALL_S)
        service.fly_on(simulator, 2.0)
        service.wait_for_status("engaged$")
        story.flown_after, story.program_after = _running(service), _program(service)
        story.needs_reload = service.show("NeedDaemonReload")
        story.overridden = simulator.progress().overridden
        (story.through_the_upgrade,) = service.recordings()
        guest.sh("systemctl restart fccd")
        story.restarted, story.restarted_program = _running(service), _program(service)
        story.restarted_description = service.show("Description")
        yield simulator, service, story


def test_an_upgrade_neither_stops_nor_restarts_the_daemon(upgraded: Flying) -> None:
    _, service, story = upgraded
    version = service.guest.sh("dpkg-query --show --showformat '${Version}' fccd")
    assert version == NEWER
    assert story.flown_before["StatusText"] == "engaged"
    assert story.flown_after == story.flown_before
    assert story.overridden
    # The kernel still runs the old file, which is no longer in any folder.
    assert story.program_before == "/usr/bin/fccd"
    assert story.program_after == "/usr/bin/fccd (deleted)"


def test_no_tick_is_missing_of_a_flight_through_an_upgrade(
    upgraded: Flying, tmp_path: Path
) -> None:
    _, service, story = upgraded
    records = service.records(story.through_the_upgrade, tmp_path)
    assert_regular(records, PERIOD_NS)
    phases = [record.state.phase for record in records]
    first = phases.index(ENGAGED)
    # Until the restart by hand.
    assert_control_is_kept(records[first:-1])
    assert (len(phases) - first) * PERIOD_NS * 1e-9 > 4.0
    found = service.replayed(story.through_the_upgrade)
    assert (found["exit_code"], found["identity"]["differing"]) == (0, 0), found


def test_the_new_version_flies_after_a_restart(upgraded: Flying) -> None:
    _, _, story = upgraded
    # systemd has read the new unit, without a command.
    assert story.needs_reload == "no"
    assert story.restarted_description.startswith("Newer ")
    assert story.restarted["ActiveState"] == "active"
    assert story.restarted["MainPID"] != story.flown_after["MainPID"]
    assert story.restarted_program == "/usr/bin/fccd"


def test_the_edited_configuration_is_kept(upgraded: Flying) -> None:
    simulator, service, _ = upgraded
    assert f":{simulator.port}" in service.guest.sh(f"cat {CONFIG}")


def test_removing_stops_it_and_purging_leaves_the_recordings(upgraded: Flying) -> None:
    """The last test: the package is removed."""
    simulator, service, _ = upgraded
    service.engage_again(simulator)
    service.fly_on(simulator, 2.0)
    guest = service.guest
    before = guest.sh(f"ls {RECORDINGS}").split()
    assert len(before) == 2
    guest.sh("apt-get remove --yes fccd", within_s=INSTALL_S)
    assert not simulator.progress().overridden
    assert "fccd" not in guest.sh("cat /proc/[0-9]*/comm").split()
    assert guest.try_sh("systemctl is-active fccd").out.strip() == "inactive"
    guest.sh(f"test -f {CONFIG}")
    guest.sh("apt-get purge --yes fccd", within_s=INSTALL_S)
    assert guest.sh("ls /etc | grep fccd || true") == ""
    assert guest.sh("find / -xdev -name '*fccd*' -not -path '/root/*'").split() == ["/var/lib/fccd"]
    assert guest.sh("ls /var/lib/fccd").split() == ["recordings"]
    assert guest.sh(f"ls {RECORDINGS}").split() == before
