"""Flights by MAVSDK: what its scripts do, on the built-in aircraft."""

from __future__ import annotations

import time
from pathlib import Path

from mavlink_vehicle import IN_THE_AIR, item, mavsdk_system, same, until, vehicle
from mavsdk.plugins.action import Action
from mavsdk.plugins.mission_raw import MissionRaw
from mavsdk.plugins.telemetry import FlightMode, Telemetry

DO_LAND_START = 189
AIM_KM = 3.7
"""Where it is to touch down, north of where it takes off."""
KM_DEG = 1.0 / 111.13
"""Of latitude, at 45 degrees."""


def test_mavsdk_uploads_flies_pauses_replaces_and_returns(tmp_path: Path, fccd: Path) -> None:
    with vehicle(tmp_path / "ground", fccd, IN_THE_AIR) as (ground, port):
        mavsdk, system = mavsdk_system(port)
        missions, action, telemetry = MissionRaw(system), Action(system), Telemetry(system)
        mission = [item(0, 45.06, 8.0), item(1, 45.06, 8.06), item(2, 45.0, 8.06)]
        missions.upload_mission(mission)
        got = missions.download_mission()
        assert len(got) == 3
        assert all(map(same, mission, got))
        # The daemon has it, as the page sees it.
        flown = ground.vehicle()["plan"]["items"]
        assert flown[0]["place"] == {"latitude_deg": 45.06, "longitude_deg": 8.0}

        until("it may arm", lambda: telemetry.health().is_armable)
        action.arm()
        until("mission", lambda: telemetry.flight_mode() == FlightMode.MISSION)
        assert telemetry.armed()
        assert telemetry.in_air()
        tick = ground.tick()
        assert tick["state"] == "engaged"
        # Telemetry against what `fccd top` reads from shared memory, by another program.
        position = telemetry.position()
        assert abs(position.latitude_deg - 45.0) < 0.1
        speed_kt = telemetry.fixedwing_metrics().airspeed_m_s * 3600.0 / 1852.0
        assert abs(speed_kt - tick["actual"]["airspeed_kt"]) < 5.0

        missions.pause_mission()
        until("hold", lambda: telemetry.flight_mode() == FlightMode.HOLD)
        other = [item(0, 45.07, 8.0), item(1, 45.07, 8.07), item(2, 45.0, 8.07), item(3, 45.0, 8.0)]
        missions.upload_mission(other)
        assert len(missions.download_mission()) == 4
        assert len(ground.vehicle()["plan"]["items"]) == 4
        missions.start_mission()
        until("mission again", lambda: telemetry.flight_mode() == FlightMode.MISSION)
        missions.set_current_mission_item(2)
        until("item 2", lambda: missions.mission_progress().current == 2)

        action.goto_location(45.03, 8.03, 900.0, 0.0)
        until("go to", lambda: ground.tick()["guidance"]["mode"] == "go-to")
        begin = time.monotonic()
        action.return_to_launch()
        # The limit: p99 of a command 100 ms; here one, on a busy machine.
        assert time.monotonic() - begin < 1.0
        until("return", lambda: telemetry.flight_mode() == FlightMode.RETURN_TO_LAUNCH)
        mavsdk.destroy()
    assert ground.process.poll() == 0
