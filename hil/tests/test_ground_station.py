"""The ground station beside a real daemon, as `make ground` starts both."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import time
import urllib.error
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from ground_station import PATIENCE_S, Station, make_ground, place, waited


@pytest.fixture
def ground(tmp_path: Path, fccd: Path) -> Iterator[Station]:
    station = os.environ.get("FCC_GROUND")
    assert station, "FCC_GROUND=FILE: the program fcc-ground (`make test-python` sets it)"
    started = make_ground(tmp_path, fccd, station)
    try:
        yield started
    finally:
        started.end()


def _plan(north_deg: float) -> dict[str, Any]:
    altitude = {"m": 250.0, "above": "home"}
    takeoff = {"m": 150.0, "above": "home"}
    return {
        "home": {"place": place(47.5, 9.0), "altitude_m": 400.0},
        "items": [
            {"kind": "takeoff", "place": place(47.52, 9.0), "altitude": takeoff},
            {"kind": "waypoint", "place": place(north_deg, 9.0), "altitude": altitude},
            {"kind": "waypoint", "place": place(north_deg, 8.95), "altitude": altitude},
        ],
    }


def test_a_drawn_plan_is_uploaded_and_flown(ground: Station) -> None:
    first = ground.vehicle()["hash"]
    status, saved = ground.ask("PUT", "/api/drafts/survey", {"plan": _plan(47.54)})
    assert status == 200, saved
    process_id = ground.daemon()["process_id"]
    status, uploaded = ground.upload("survey", saved["revision"])
    assert status == 200, uploaded
    # In standby the daemon is started again, with this plan.
    assert uploaded["hash"] == saved["hash"] == ground.vehicle()["hash"] != first
    assert ground.daemon()["process_id"] != process_id
    assert ground.vehicle()["plan"]["items"][1]["place"] == place(47.54, 9.0)
    assert ground.tick()["state"] == "standby"

    status, answer = ground.carried_out("engage")
    assert answer["carried_out"] > 0
    assert ground.tick()["state"] == "engaged"
    # On the runway the autopilot keeps its plan.
    status, other = ground.ask("PUT", "/api/drafts/other", {"plan": _plan(47.55)})
    status, refused = ground.upload("other", other["revision"])
    assert status == 409
    assert "runway" in refused["refused"]
    assert ground.vehicle()["hash"] == saved["hash"]
    waited("the roll", lambda: ground.tick()["actual"]["airspeed_kt"] > 20.0)

    # An older revision, and one with problems, are not uploaded.
    status, refused = ground.upload("survey", saved["revision"] - 1)
    assert status == 409
    status, steep = ground.ask("PUT", "/api/drafts/steep", {"plan": {"items": []}})
    status, refused = ground.upload("steep", steep["revision"])
    assert status == 409
    assert refused["problems"]

    assert ground.command("disengage")[0] == 200
    assert ground.tick()["state"] == "standby"


def test_a_killed_station_costs_the_flight_nothing(ground: Station) -> None:
    ground.carried_out("engage")
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


def test_ctrl_c_ends_both(ground: Station) -> None:
    process_id = ground.daemon()["process_id"]
    ground.end()
    assert not Path(f"/proc/{process_id}").exists()
    with pytest.raises(urllib.error.URLError):
        ground.ask("GET", "/api/status")


def test_a_daemon_prints_the_link_of_the_station_that_runs(tmp_path: Path, fccd: Path) -> None:
    own = tmp_path / "run"
    own.mkdir(mode=0o700)
    environment = {**os.environ, "RUNTIME_DIRECTORY": str(own)}

    def printed() -> str:
        words = [str(fccd), "fly", "--seconds", "1", "--quiet", "--no-recording"]
        done = subprocess.run(words, check=True, env=environment, stderr=subprocess.PIPE, text=True)
        return done.stderr

    words = [str(fccd), "ground", "--json", "--listen", "127.0.0.1:0", "--state", str(tmp_path)]
    with subprocess.Popen(words, env=environment, stdout=subprocess.PIPE, text=True) as station:
        assert station.stdout is not None
        link = json.loads(station.stdout.readline())["link"]
        assert f"ground station: {link}" in printed()
        station.terminate()
        assert station.wait(PATIENCE_S) == 0
    assert "ground station" not in printed()
