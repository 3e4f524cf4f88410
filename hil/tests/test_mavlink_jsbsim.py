"""JSBSim by MAVSDK: through the station, the daemon and X-Plane's protocol, in real time."""

from __future__ import annotations

import json
import os
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from ground_station import Station
from mavlink_vehicle import free_port, item, mavsdk_system, metres, same, until
from mavsdk.plugins.action import Action
from mavsdk.plugins.mavlink_direct import MavlinkDirect
from mavsdk.plugins.mavlink_direct.mavlink_direct import MavlinkMessage
from mavsdk.plugins.mission_raw import MissionRaw
from mavsdk.plugins.telemetry import FlightMode, LandedState, Telemetry

from fcc_hil import plan_file, plan_flight, plan_start
from fcc_hil.daemon_rig import DaemonRig
from fcc_hil.settings import Settings
from fcc_hil.units import STANDARD_INHG

DO_LAND_START = 189
KM_DEG = 1.0 / 111.13
"""Of latitude, at 45 degrees."""
AIM_KM = 4.3
"""Where it is to touch down, north of where it takes off: a circuit would take twice as long."""
TAKE_OFF = f"""QGC WPL 110
0 0 0 16 0 0 0 0 45.0 8.0 120.0 1
1 0 3 22 15 0 0 0 {45.0 + 1.0 * KM_DEG} 8.0 65.0 1
2 0 3 16 0 0 0 0 {45.0 + 1.8 * KM_DEG} 8.0 75.0 1
3 0 3 16 0 0 0 0 {45.0 + 9.0 * KM_DEG} 8.0 75.0 1
"""


@contextmanager
def jsbsim(folder: Path, fccd: Path) -> Iterator[tuple[DaemonRig, int]]:
    """Start JSBSim as X-Plane, a daemon, and a station that speaks MAVLink to a port."""
    plan, port = folder / "take-off.waypoints", free_port()
    plan.write_text(TAKE_OFF)
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


def test_mavsdk_flies_jsbsim_from_take_off_to_the_stop_after_landing(
    tmp_path: Path, fccd: Path
) -> None:
    with jsbsim(tmp_path, fccd) as (rig, port):
        mavsdk, system = mavsdk_system(port)
        missions, action, telemetry = MissionRaw(system), Action(system), Telemetry(system)

        def truth(name: str) -> float:
            return float(rig.truth()[name][-1])

        def there() -> tuple[float, float]:
            return truth("latitude_deg"), truth("longitude_deg")

        def mode(wanted: FlightMode, within_s: float = 20.0) -> None:
            until(str(wanted), lambda: telemetry.flight_mode() == wanted, within_s)

        until("it may arm", lambda: telemetry.health().is_armable)
        assert telemetry.landed_state() == LandedState.ON_GROUND
        action.arm()
        missions.start_mission()
        mode(FlightMode.TAKEOFF)
        mode(FlightMode.MISSION, 90.0)
        assert telemetry.in_air()
        until("item 3", lambda: missions.mission_progress().current == 2, 60.0)
        assert metres((45.0 + 1.8 * KM_DEG, 8.0), there()) <= 100.0
        # What MAVSDK shows against the truth.
        position, attitude = telemetry.position(), telemetry.attitude_euler()
        assert metres((position.latitude_deg, position.longitude_deg), there()) < 100.0
        assert abs(position.absolute_altitude_m - truth("altitude_ft") * 0.3048) < 15.0
        assert abs(attitude.roll_deg - truth("roll_deg")) < 3.0

        missions.pause_mission()
        mode(FlightMode.HOLD)
        until("it circles", lambda: abs(truth("roll_deg")) > 5.0)
        landing = [
            item(0, 45.0 + 1.9 * KM_DEG, 8.0, z=75.0),
            item(1, 45.0 + 2.0 * KM_DEG, 8.0, command=DO_LAND_START, z=75.0),
            # The approach takes 0.8 of the airspeed of the first legs.
            item(2, 0.0, 0.0, frame=2, command=178, param2=42.0, param3=-1.0, param4=0.0, z=0.0),
            item(3, 45.0 + 3.0 * KM_DEG, 8.0, z=75.0),
            item(4, 45.0 + AIM_KM * KM_DEG, 8.0, command=21, param1=60.0, z=0.0),
        ]
        missions.upload_mission(landing)
        assert all(map(same, landing, missions.download_mission()))
        action.return_to_launch()
        mode(FlightMode.RETURN_TO_LAUNCH)
        fields = {"target_system": 1, "target_component": 1, "command": DO_LAND_START}
        command = MavlinkMessage("COMMAND_LONG", 255, 190, 1, 1, json.dumps(fields))
        answer = MavlinkDirect(system).send_command(command)
        assert json.loads(answer.fields_json)["result"] == 0
        mode(FlightMode.LAND, 120.0)
        until("stopped", lambda: telemetry.raw_gps().velocity_m_s < 0.1, 120.0)
        until("landed", lambda: telemetry.landed_state() == LandedState.ON_GROUND)
        # It stops on a runway of 600 m, behind the place that it aims at.
        aim = 45.0 + AIM_KM * KM_DEG, 8.0
        assert there()[0] > aim[0]
        assert metres(aim, there()) < 600.0
        action.disarm()
        until("disarmed", lambda: not telemetry.armed())
        mavsdk.destroy()
        recording = tmp_path / "flight.mcap"
        rig.save_recording(recording)
    report = json.loads(subprocess.check_output([fccd, "report", "--json", recording]))
    touch_down = report["flown_plan"]["touch_down"]
    assert touch_down["sink_fpm"] <= 300.0
    assert abs(touch_down["centre_line_m"]) <= 5.0
