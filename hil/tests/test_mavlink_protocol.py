"""What other programs assert of a vehicle, against the station beside a real daemon.

The cases of missions and commands are those of hamishwillee/mavsdk_mavlink_tests (2026-10),
written anew: its suite is no package.
"""

from __future__ import annotations

import re
import socket
import time
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from mavlink_vehicle import (
    NAN,
    Pymavlink,
    free_port,
    item,
    mavproxy,
    mavsdk_system,
    same,
    until,
    vehicle,
)
from mavsdk.plugins.mission_raw import MissionRaw, MissionRawError
from pymavlink.dialects.v20 import common

ACCEPTED, DENIED, UNSUPPORTED = 0, 2, 3
INT32_MAX = 2**31 - 1
SUPPORTED = {
    *(17, 20, 21, 22, 176, 178, 186, 189, 191, 192, 193, 224, 262, 300, 400, 410, 510, 511, 512),
    *(520, 2600, 43000, 43001, 43002),
}
"""The table of docs/mavlink.md; 32100 is of another dialect."""


@pytest.fixture(scope="module")
def standing(tmp_path_factory: pytest.TempPathFactory, fccd: Path) -> Iterator[tuple[Any, int]]:
    """Return the built-in aircraft on its runway, with the circuit as its plan."""
    with vehicle(tmp_path_factory.mktemp("ground"), fccd) as started:
        yield started


def test_the_table_of_the_document_is_this_one() -> None:
    document = Path(__file__).parents[2] / "docs/mavlink.md"
    rows = [line.split("|") for line in document.read_text().splitlines() if "| `" in line]
    numbers = [number.strip() for row in rows for number in row[2].split(",")]
    found = {int(number) for number in numbers if number.isdigit()}
    assert found - {32100} == SUPPORTED


def test_mavsdk_reads_back_every_list_and_each_frame_is_kept_or_refused(
    standing: tuple[Any, int],
) -> None:
    mavsdk, system = mavsdk_system(standing[1])
    missions = MissionRaw(system)
    try:
        takeoff = item(0, 45.03, 8.0, command=22, param1=8.0, z=150.0)
        mission = [takeoff, item(1, 45.06, 8.0, z=300.0), item(2, 45.06, 8.06, z=300.0)]
        missions.upload_mission(mission)
        assert all(map(same, mission, missions.download_mission()))
        corners = [(44.5, 7.5), (44.5, 8.5), (45.5, 8.5), (45.5, 7.5)]
        fence = [
            item(n, *at, frame=0, command=5001, param1=4.0, param4=0.0, z=0.0, mission_type=1)
            for n, at in enumerate(corners)
        ]
        missions.upload_geofence(fence)
        assert all(map(same, fence, missions.download_geofence()))
        rally = [item(0, 45.01, 8.01, command=5100, param4=0.0, z=200.0, mission_type=2)]
        missions.upload_rally_points(rally)
        assert all(map(same, rally, missions.download_rallypoints()))
        # One upload changes one list.
        assert len(missions.download_mission()) == 3
        plan = standing[0].vehicle()["plan"]
        assert (len(plan["fence"]["polygons"]), len(plan["rally"])) == (1, 1)
        for frame in (1, 4, 7, 8, 9, 12, 13, 20, 21):
            with pytest.raises(MissionRawError):
                missions.upload_mission([item(0, 45.03, 8.0, frame=frame)])
            assert len(missions.download_mission()) == 3, f"frame {frame}"
        # 2: numbers that are not scaled, for commands without a place.
        speed = item(1, 0.0, 0.0, frame=2, command=178, param2=46.0, param3=-1.0, param4=0.0, z=0.0)
        with_speed = [takeoff, speed, item(2, 45.06, 8.0, z=300.0)]
        missions.upload_mission(with_speed)
        assert all(map(same, with_speed, missions.download_mission()))
        missions.clear_mission()
        assert missions.download_mission() == []
        missions.upload_mission(mission)
        assert len(missions.download_geofence()) == 4
    finally:
        mavsdk.destroy()


def test_every_command_has_one_final_answer_in_both_encodings(standing: tuple[Any, int]) -> None:
    station = Pymavlink(standing[1])
    mav = station.mav
    numbers = [n for n in common.enums["MAV_CMD"] if n < 65535 and n not in (400, 300, 22)]
    assert len(numbers) > 160
    results: dict[int, list[int]] = {}
    for number in numbers:
        mav.command_long_send(1, 1, number, 0, 0, 0, 0, 0, NAN, NAN, 0)
        mav.command_int_send(1, 1, 6, number, 0, 0, 0, 0, 0, 0, INT32_MAX, INT32_MAX, 0)
        results[number] = [a.result for a in (station.receive("COMMAND_ACK") for _ in "ab") if a]
    for number in (9999, 65000):
        results[number] = [station.long(number), UNSUPPORTED]
    late = station.acks(0, 1.5)
    assert not late
    for number, both in results.items():
        assert len(both) == 2, f"command {number}: {both}"
        is_unsupported = UNSUPPORTED in both
        assert is_unsupported == (number not in SUPPORTED), f"command {number}: {both}"
    station.close()


def test_a_message_is_sent_as_often_as_it_is_asked_for(standing: tuple[Any, int]) -> None:
    station = Pymavlink(standing[1])
    assert station.long(511, 30, 20_000) == ACCEPTED
    assert station.long(511, 33, -1) == ACCEPTED
    assert station.long(511, 9999, 1000) == DENIED
    station.acks(0, 0.5)
    counts: Counter[str] = Counter()
    until_s = time.monotonic() + 3.0
    while time.monotonic() < until_s:
        message = station.link.recv_match(blocking=True, timeout=0.2)
        if message:
            counts[message.get_type()] += 1
    # 50 Hz, and never.
    assert counts["ATTITUDE"] > 100
    assert counts["GLOBAL_POSITION_INT"] == 0
    assert station.link.mav.total_receive_errors == 0
    assert station.long(511, 30, 0) == station.long(511, 33, 0) == ACCEPTED
    station.close()


def test_pymavlink_reads_and_sets_parameters(standing: tuple[Any, int]) -> None:
    station = Pymavlink(standing[1])
    station.mav.param_request_list_send(1, 1)
    found: dict[str, float] = {}
    count = 1
    while len(found) < count:
        value = station.receive("PARAM_VALUE")
        assert value, f"{len(found)} of {count}"
        found[value.param_id], count = value.param_value, value.param_count
    # Of the built-in aircraft: docs/envelope.md has 53 kt.
    assert found["SPD_STALL_MPS"] == pytest.approx(53 * 1852 / 3600, abs=0.05)

    def set_to(name: str, value: float) -> float:
        station.mav.param_set_send(1, 1, name.encode(), value, common.MAV_PARAM_TYPE_REAL32)
        answer = station.receive("PARAM_VALUE")
        assert answer
        assert answer.param_id == name
        return float(answer.param_value)

    assert set_to("SPD_STALL_MPS", 10.0) == found["SPD_STALL_MPS"]
    assert set_to("QNH_HPA", 1020.0) == 1020.0
    until("the daemon has it", lambda: standing[0].tick()["altimeter_setting_hpa"] == 1020.0)
    assert set_to("QNH_HPA", 10.0) == 1020.0, "outside of its limits"
    assert set_to("QNH_HPA", 1013.25) == pytest.approx(1013.25)
    station.close()


def test_mavproxy_loads_lists_and_changes_a_mission(
    standing: tuple[Any, int], tmp_path: Path
) -> None:
    ground, port = standing
    plan = tmp_path / "way.txt"
    plan.write_text(
        "QGC WPL 110\n"
        "0\t1\t3\t22\t8\t0\t0\t0\t45.03\t8.0\t150\t1\n"
        "1\t0\t3\t16\t0\t0\t0\t0\t45.06\t8.0\t300\t1\n"
        "2\t0\t3\t16\t0\t0\t0\t0\t45.06\t8.05\t300\t1\n"
    )

    def altitudes() -> list[float]:
        # None while the daemon is started again with the plan.
        plan = (ground.vehicle() or {}).get("plan") or {"items": []}
        return [one["altitude"]["m"] for one in plan["items"] if "altitude" in one]

    with mavproxy(port, tmp_path) as (give, printed):

        def listed() -> list[tuple[int, float]]:
            give("wp list")
            time.sleep(2.0)
            lines = [line for line in printed().splitlines() if " p1=" in line]
            rows = [line.split()[:5] for line in lines]
            return [(int(words[0]), float(words[4])) for words in rows[-3:]]

        give(f"wp load {plan}")
        until("the mission", lambda: altitudes() == [150.0, 300.0, 300.0])
        give("wp changealt 2 250")
        until("one item", lambda: altitudes() == [150.0, 300.0, 250.0])
        # It asks once, and gets no answer while the daemon starts again.
        until("the list", lambda: listed() == [(22, 150.0), (16, 300.0), (16, 250.0)])
        give("param show QNH_HPA")
        until("the parameter", lambda: re.search(r"QNH_HPA\s+1013.25", printed()))


def test_control_is_taken_and_the_page_and_other_stations_wait(standing: tuple[Any, int]) -> None:
    ground, port = standing
    station = Pymavlink(port)
    other = common.MAVLink(station.link, srcSystem=42, srcComponent=190)
    assert station.long(32100, 1, 0, 10, 255) == ACCEPTED
    station.mav.heartbeat_send(6, 8, 0, 0, 0)
    other.command_long_send(1, 1, 20, 0, *([0] * 7))
    ack = station.receive("COMMAND_ACK")
    assert (ack.command, ack.result, ack.target_system) == (20, 10, 42), "NOT_IN_CONTROL"
    status, refused = ground.command("engage")
    assert status == 409
    assert "system number 255" in refused["refused"]
    assert station.long(32100, 0, 0, 10, 255) == ACCEPTED
    until("the page may", lambda: "system number" not in str(ground.command("pause")))
    station.close()


def test_foreign_senders_are_not_heard(standing: tuple[Any, int]) -> None:
    station = Pymavlink(standing[1])
    (address,) = station.link.clients
    station.close()
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as foreign:
        foreign.bind(("127.0.0.1", free_port()))
        foreign.settimeout(1.0)
        mav = common.MAVLink(None, srcSystem=255, srcComponent=190)
        frame = common.MAVLink_command_long_message(1, 1, 512, 0, 148, 0, 0, 0, 0, 0, 0).pack(mav)
        foreign.sendto(frame, address)
        with pytest.raises(TimeoutError):
            foreign.recv(300)
