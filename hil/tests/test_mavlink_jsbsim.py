"""JSBSim by MAVSDK: through the station, the daemon and X-Plane's protocol, in real time."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from ground_station import Station
from mavlink_vehicle import free_port, item, mavsdk_system, metres, same, until
from mavsdk.plugins.action import Action
from mavsdk.plugins.mission_raw import MissionRaw
from mavsdk.plugins.telemetry import FlightMode, Telemetry

from fcc_hil import plan_file, plan_flight, plan_start
from fcc_hil.daemon_rig import DaemonRig
from fcc_hil.settings import Settings
from fcc_hil.units import STANDARD_INHG

AHEAD = """QGC WPL 110
0 0 0 16 0 0 0 0 47.0 8.0 914.4 1
1 0 0 16 0 0 0 0 47.1 8.0 914.4 1
"""
"""JSBSim begins over home at this altitude, to the north."""
KM_DEG = 1.0 / 111.13
"""Of latitude, at 45 degrees."""


@contextmanager
def jsbsim(folder: Path, fccd: Path) -> Iterator[tuple[DaemonRig, int]]:
    """Start JSBSim as X-Plane, a daemon, and a station that speaks MAVLink to a port."""
    plan, port = folder / "ahead.waypoints", free_port()
    plan.write_text(AHEAD)
    begin = plan_start.settings(plan_file.read(plan), Settings(qnh_inhg=STANDARD_INHG))
    text = plan_flight.configuration(plan, "measured", 0.0)
    rig = DaemonRig(fccd, begin, f"{text}[engage]\ncommand_needs_switch = false\n", folder)
    try:
        rig.prepare()
        words: list[str | Path] = [os.environ["FCC_GROUND"], "--config", folder / "fccd.toml"]
        words += ["--fccd", fccd, "--state", folder / "state", "--mavlink", f"udp:127.0.0.1:{port}"]
        station = Station(words, fccd, f"fccd-test-{os.getpid()}-{rig.simulator.port}")
        try:
            yield rig, port
        finally:
            station.end()
    finally:
        rig.close()


def test_mavsdk_flies_jsbsim_to_two_waypoints(tmp_path: Path, fccd: Path) -> None:
    with jsbsim(tmp_path, fccd) as (rig, port):
        mavsdk, system = mavsdk_system(port)
        missions, action, telemetry = MissionRaw(system), Action(system), Telemetry(system)

        def truth(name: str) -> float:
            return float(rig.truth()[name][-1])

        until("it may arm", lambda: telemetry.health().is_armable)
        action.arm()
        until("mission", lambda: telemetry.flight_mode() == FlightMode.MISSION)
        begin = truth("latitude_deg")
        places = [(begin + n * KM_DEG, 8.0) for n in (0.8, 1.5, 9.0)]
        mission = [item(n, *place, frame=0, z=914.4) for n, place in enumerate(places)]
        missions.upload_mission(mission)
        assert all(map(same, mission, missions.download_mission()))

        def wait_for_item(n: int) -> None:
            until(f"item {n}", lambda: missions.mission_progress().current == n, 60.0)

        for n, place in enumerate(places[:2]):
            wait_for_item(n + 1)
            there = truth("latitude_deg"), truth("longitude_deg")
            assert metres(place, there) <= 100.0
            assert abs(truth("altitude_ft") - 3_000.0) <= 50.0
        # What MAVSDK shows against the truth.
        position, attitude = telemetry.position(), telemetry.attitude_euler()
        assert metres((position.latitude_deg, position.longitude_deg), there) < 100.0
        assert abs(attitude.roll_deg - truth("roll_deg")) < 3.0
        missions.pause_mission()
        until("hold", lambda: telemetry.flight_mode() == FlightMode.HOLD)
        until("it circles", lambda: abs(truth("roll_deg")) > 5.0)
        action.return_to_launch()
        until("return", lambda: telemetry.flight_mode() == FlightMode.RETURN_TO_LAUNCH)
        until("it turns home", lambda: 120.0 < truth("heading_deg") % 360.0 < 240.0, 60.0)
        mavsdk.destroy()
