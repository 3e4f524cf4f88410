"""The ground station's package beside the daemon's: its service, page and command."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from fcc_hil.process import StandInProcess

from guest import INSTALL_S, Guest
from service import Service, flight

MOST_EXPOSED = 2.0
AT = "127.0.0.1:8460"

Flying = tuple[StandInProcess, Service]


@pytest.fixture(scope="module")
def flying(guest: Guest, package: Path) -> Iterator[Flying]:
    (station,) = package.parent.glob("fcc-ground_*.deb")
    guest.agent.write("/root/fcc-ground.deb", station.read_bytes())
    guest.sh("apt-get install --yes /root/fcc-ground.deb", within_s=INSTALL_S)
    assert guest.try_sh("systemctl is-active fcc-ground").out.strip() == "inactive"
    assert guest.sh("dpkg --verify fcc-ground") == ""
    with flight(guest) as (simulator, service):
        service.engage(simulator)
        guest.sh("systemctl enable --now fcc-ground")
        service.wait_until(lambda: "#token=" in journal(guest), "the station prints its link")
        yield simulator, service


def journal(guest: Guest) -> str:
    return guest.sh("journalctl --unit fcc-ground --output cat")


def ask(guest: Guest, method: str, path: str, token: str = "", body: str = "") -> tuple[int, str]:
    """Return the status and the content of an answer, without a program that Debian lacks."""
    lines = [f"{method} {path} HTTP/1.1", f"Host: {AT}", "Connection: close"]
    if token:
        lines.append(f"Authorization: Bearer {token}")
    if body:
        lines += ["Content-Type: application/json", f"Content-Length: {len(body)}"]
    guest.agent.write("/root/request", ("\r\n".join(lines) + "\r\n\r\n" + body).encode())
    words = f"exec 3<>/dev/tcp/{AT.replace(':', '/')}; cat /root/request >&3; cat <&3"
    head, _, content = guest.sh(f"bash -c '{words}'").partition("\r\n\r\n")
    return int(head.split()[1]), content


def test_the_page_and_the_daemon_are_found(flying: Flying) -> None:
    _, service = flying
    status, page = ask(service.guest, "GET", "/")
    assert (status, "<title>" in page) == (200, True)
    status, answer = ask(service.guest, "GET", "/api/status")
    (daemon,) = json.loads(answer)["daemons"]
    assert (status, daemon["process_id"]) == (200, service.pid)
    listed = json.loads(ask(service.guest, "GET", "/api/flights")[1])
    recorded = {Path(file).name for file in service.recordings()}
    assert {one["file"] for one in listed} == recorded != set()


def test_a_command_needs_the_token(flying: Flying) -> None:
    simulator, service = flying
    (token,) = re.findall(r"#token=(\S+)", journal(service.guest))
    owner = service.guest.sh("stat --format '%U:%G %a' /var/lib/fcc-ground/token").strip()
    assert owner == "fccd:fccd 600"
    (daemon,) = json.loads(ask(service.guest, "GET", "/api/status")[1])["daemons"]
    deadline_ms = 1000 * (int(service.guest.sh("date +%s")) + 30)
    order = {"number": 1, "deadline_ms_utc": deadline_ms, "command": "disengage"}
    path, body = f"/api/live/{daemon['instance']}/command", json.dumps(order)
    assert ask(service.guest, "POST", path, "", body)[0] == 401
    assert service.status == "engaged"
    status, answer = ask(service.guest, "POST", path, token, body)
    assert status == 200, answer
    service.wait_for_status("standby")
    service.wait_until(lambda: not simulator.progress().overridden, "the controls are released")
    service.engage_again(simulator)


def test_little_is_exposed_and_nothing_is_denied(flying: Flying) -> None:
    _, service = flying
    output = service.guest.sh("systemd-analyze security --no-pager fcc-ground")
    found = re.search(r"Overall exposure level for fcc-ground.service: ([\d.]+)", output)
    assert found is not None, output
    assert float(found[1]) <= MOST_EXPOSED
    verified = service.guest.try_sh("systemd-analyze verify fcc-ground.service")
    assert (verified.exit_code, verified.out + verified.err) == (0, "")
    refused = re.compile("denied|not permitted|EPERM|EACCES|failed", re.I)
    assert [line for line in journal(service.guest).splitlines() if refused.search(line)] == []
    assert "seccomp" not in service.guest.sh("dmesg")


def test_a_station_that_is_killed_costs_the_flight_nothing(flying: Flying) -> None:
    simulator, service = flying
    service.guest.sh("systemctl kill --signal KILL fcc-ground")
    service.fly_on(simulator, 5.0)
    assert (service.status, service.show("NRestarts")) == ("engaged", "0")
    again = "systemctl is-active fcc-ground"
    service.wait_until(lambda: service.guest.try_sh(again).exit_code == 0, "it is started again")
    service.wait_until(lambda: "#token=" in journal(service.guest), "it prints its link again")


def test_removed_it_leaves_the_daemon_flying(flying: Flying) -> None:
    simulator, service = flying
    service.guest.sh("apt-get purge --yes fcc-ground", within_s=INSTALL_S)
    assert service.guest.try_sh("systemctl is-active fcc-ground").exit_code != 0
    service.fly_on(simulator, 2.0)
    assert service.status == "engaged"
