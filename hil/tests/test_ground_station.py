"""The ground station beside a real daemon, as `make ground` starts both."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import time
import urllib.error
import urllib.request
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).parents[2]
PATIENCE_S = 30.0


def _waited(what: str, found: Callable[[], Any]) -> Any:
    deadline = time.monotonic() + PATIENCE_S
    while time.monotonic() < deadline:
        value = found()
        if value:
            return value
        time.sleep(0.1)
    raise AssertionError(f"it took too long: {what}")


class Ground:
    """`scripts/ground`, and what its page asks."""

    def __init__(self, folder: Path, fccd: str, station: str) -> None:
        self.instance = f"ground-{os.getpid()}"
        self.fccd = fccd
        environment = {**os.environ, "FCCD": fccd, "STATION": station, "GROUND": str(folder)}
        self.process = subprocess.Popen(
            [str(ROOT / "scripts/ground"), "--listen", "127.0.0.1:0", "--json"],
            cwd=ROOT,
            env={**environment, "INSTANCE": self.instance},
            stdout=subprocess.PIPE,
            text=True,
            start_new_session=True,
        )
        assert self.process.stdout is not None
        link = json.loads(self.process.stdout.readline())["link"]
        self.address, self.token = link.split("/#token=")
        self.number = 0
        _waited("the daemon", self.daemon)

    def ask(self, method: str, path: str, body: Any = None) -> tuple[int, Any]:
        headers = {"Authorization": f"Bearer {self.token}", "Content-Type": "application/json"}
        data = None if body is None else json.dumps(body).encode()
        request = urllib.request.Request(self.address + path, data, headers, method=method)
        try:
            with urllib.request.urlopen(request, timeout=PATIENCE_S) as answer:
                return answer.status, json.load(answer)
        except urllib.error.HTTPError as error:
            return error.code, json.load(error)

    def order(self) -> dict[str, int]:
        self.number += 1
        return {"number": self.number, "deadline_ms_utc": int(time.time() * 1000) + 10_000}

    def command(self, command: Any) -> tuple[int, Any]:
        path = f"/api/live/{self.instance}/command"
        return self.ask("POST", path, {**self.order(), "command": command})

    def upload(self, draft: str, revision: int) -> tuple[int, Any]:
        body = {**self.order(), "draft": draft, "revision": revision, "item": 1}
        return self.ask("POST", f"/api/live/{self.instance}/plan", body)

    def vehicle(self) -> Any:
        return self.ask("GET", f"/api/live/{self.instance}/plan")[1]

    def daemon(self) -> Any:
        found = self.ask("GET", "/api/status")[1]["daemons"]
        return next((one for one in found if one["instance"] == self.instance), None)

    def tick(self) -> Any:
        """Return the newest tick, as `fccd top` shows it."""
        command = [self.fccd, "top", "--json", "--instance", self.instance]
        return json.loads(subprocess.check_output(command))["tick"]

    def end(self) -> None:
        if self.process.poll() is None:
            os.killpg(self.process.pid, signal.SIGINT)
            self.process.wait(PATIENCE_S)


@pytest.fixture
def ground(tmp_path: Path, fccd: str) -> Iterator[Ground]:
    station = os.environ.get("FCC_GROUND")
    assert station, "FCC_GROUND=FILE: the program fcc-ground (`make test-python` sets it)"
    started = Ground(tmp_path, str(fccd), station)
    try:
        yield started
    finally:
        started.end()


def _place(latitude_deg: float, longitude_deg: float) -> dict[str, float]:
    return {"latitude_deg": latitude_deg, "longitude_deg": longitude_deg}


def _plan(north_deg: float) -> dict[str, Any]:
    altitude = {"m": 250.0, "above": "home"}
    takeoff = {"m": 150.0, "above": "home"}
    return {
        "home": {"place": _place(47.5, 9.0), "altitude_m": 400.0},
        "items": [
            {"kind": "takeoff", "place": _place(47.52, 9.0), "altitude": takeoff},
            {"kind": "waypoint", "place": _place(north_deg, 9.0), "altitude": altitude},
            {"kind": "waypoint", "place": _place(north_deg, 8.95), "altitude": altitude},
        ],
    }


def test_a_drawn_plan_is_uploaded_and_flown(ground: Ground) -> None:
    first = ground.vehicle()["hash"]
    status, saved = ground.ask("PUT", "/api/drafts/survey", {"plan": _plan(47.54)})
    assert status == 200, saved
    process_id = ground.daemon()["process_id"]
    status, uploaded = ground.upload("survey", saved["revision"])
    assert status == 200, uploaded
    # In standby the daemon is started again, with this plan.
    assert uploaded["hash"] == saved["hash"] == ground.vehicle()["hash"] != first
    assert ground.daemon()["process_id"] != process_id
    assert ground.vehicle()["plan"]["items"][1]["place"] == _place(47.54, 9.0)
    assert ground.tick()["state"] == "standby"

    status, answer = _waited("engage", lambda: _accepted(ground.command("engage")))
    assert answer["carried_out"] > 0
    assert ground.tick()["state"] == "engaged"
    # On the runway the autopilot keeps its plan.
    status, other = ground.ask("PUT", "/api/drafts/other", {"plan": _plan(47.55)})
    status, refused = ground.upload("other", other["revision"])
    assert status == 409
    assert "runway" in refused["refused"]
    assert ground.vehicle()["hash"] == saved["hash"]
    _waited("the roll", lambda: ground.tick()["actual"]["airspeed_kt"] > 20.0)

    # An older revision, and one with problems, are not uploaded.
    status, refused = ground.upload("survey", saved["revision"] - 1)
    assert status == 409
    status, steep = ground.ask("PUT", "/api/drafts/steep", {"plan": {"items": []}})
    status, refused = ground.upload("steep", steep["revision"])
    assert status == 409
    assert refused["problems"]

    assert ground.command("disengage")[0] == 200
    assert ground.tick()["state"] == "standby"


def _accepted(answer: tuple[int, Any]) -> tuple[int, Any] | None:
    """None while the daemon, just started, does not engage yet."""
    return answer if answer[0] == 200 else None


def test_a_killed_station_costs_the_flight_nothing(ground: Ground) -> None:
    _waited("engage", lambda: _accepted(ground.command("engage")))
    before = ground.tick()["number"]
    children = f"/proc/{ground.process.pid}/task/{ground.process.pid}/children"
    pids = [int(pid) for pid in Path(children).read_text().split()]
    stations = [pid for pid in pids if "fcc-ground" in Path(f"/proc/{pid}/comm").read_text()]
    # The shell that watches it ends the daemon with it, so that is stopped meanwhile.
    os.kill(ground.process.pid, signal.SIGSTOP)
    os.kill(stations[0], signal.SIGKILL)
    time.sleep(2.0)
    after = ground.tick()
    assert after["state"] == "engaged"
    assert after["number"] > before + 60
    os.kill(ground.process.pid, signal.SIGCONT)
    ground.process.wait(PATIENCE_S)


def test_ctrl_c_ends_both(ground: Ground) -> None:
    process_id = ground.daemon()["process_id"]
    ground.end()
    assert not Path(f"/proc/{process_id}").exists()
    with pytest.raises(urllib.error.URLError):
        ground.ask("GET", "/api/status")
