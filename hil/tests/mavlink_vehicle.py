"""A daemon that speaks MAVLink by its ground station, and stations of PyPI's packages."""

from __future__ import annotations

import math
import os
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from ground_station import Station, make_ground
from mavsdk import ComponentType, Configuration, Mavsdk
from mavsdk.plugins.mission_raw import MissionItem
from pymavlink import mavutil
from pymavlink.dialects.v20 import common

from fcc_hil.tangent_plane import away_m

IN_THE_AIR = """QGC WPL 110
0	1	0	16	0	0	0	0	45.0	8.0	120	1
1	0	3	16	0	0	0	0	45.05	8.0	700	1
2	0	3	16	0	0	0	0	45.05	8.05	700	1
3	0	3	16	0	0	0	0	45.00	8.05	700	1
"""
"""Without a take-off the built-in aircraft begins at 3,000 ft over home."""

NAN = math.nan
WITHIN_S = 20.0


def free_port() -> int:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as found:
        found.bind(("127.0.0.1", 0))
        port: int = found.getsockname()[1]
        return port


@contextmanager
def vehicle(folder: Path, fccd: Path, plan: str = "", options: Sequence[str] = ()) -> Iterator[Any]:
    """Start a daemon and a station that speaks MAVLink to a port; give both."""
    station = os.environ.get("FCC_GROUND")
    assert station, "FCC_GROUND=FILE: the program fcc-ground (`make test-python` sets it)"
    port = free_port()
    folder.mkdir(exist_ok=True)
    if plan:
        (folder / "vehicle.plan").write_text(plan)
    link = ["--mavlink", f"udp:127.0.0.1:{port}", *options]
    ground: Station = make_ground(folder, fccd, station, link)
    try:
        yield ground, port
    finally:
        ground.end()


def mavsdk_system(port: int) -> tuple[Mavsdk, Any]:
    """Connect MAVSDK as a ground station."""
    mavsdk = Mavsdk(Configuration.create_with_component_type(ComponentType.GROUND_STATION))
    mavsdk.add_any_connection(f"udpin://127.0.0.1:{port}")
    system = mavsdk.first_autopilot(WITHIN_S)
    assert system is not None, "MAVSDK finds no autopilot"
    return mavsdk, system


def until(what: str, is_so: Callable[[], Any], within_s: float = WITHIN_S) -> Any:
    deadline = time.monotonic() + within_s
    while time.monotonic() < deadline:
        found = is_so()
        if found:
            return found
        time.sleep(0.1)
    raise AssertionError(f"not within {within_s} s: {what}")


def item(seq: int, north_deg: float, east_deg: float, **other: Any) -> MissionItem:
    """Return an item of a mission, a waypoint 700 m above home unless something else is given."""
    fields: dict[str, Any] = {
        "seq": seq,
        "frame": 3,
        "command": 16,
        "current": int(seq == 0),
        "autocontinue": 1,
        "param1": 0.0,
        "param2": 0.0,
        "param3": 0.0,
        "param4": NAN,
        "x": round(north_deg * 1e7),
        "y": round(east_deg * 1e7),
        "z": 700.0,
        "mission_type": 0,
    }
    return MissionItem(**{**fields, **other})


def same(a: MissionItem, b: MissionItem) -> bool:
    """Return whether two items are equal in every field, as mavsdk_mavlink_tests compares them."""

    def parts(one: MissionItem) -> list[Any]:
        whole = [one.seq, one.frame, one.command, one.x, one.y, one.mission_type, one.autocontinue]
        numbers = [one.param1, one.param2, one.param3, one.param4, one.z]
        return whole + ["nan" if math.isnan(n) else round(n, 4) for n in numbers]

    return parts(a) == parts(b)


def metres(place: tuple[float, float], other: tuple[float, float]) -> float:
    """Return how far apart two places are."""
    latitude_deg, longitude_deg = (np.array([degrees]) for degrees in other)
    return float(away_m(*place, (latitude_deg, longitude_deg))[0])


@contextmanager
def mavproxy(port: int, folder: Path) -> Iterator[tuple[Callable[[str], None], Callable[[], str]]]:
    """Start MAVProxy without a screen: what gives it a line, and what it has printed."""
    printed = folder / "printed.txt"
    with (
        printed.open("w") as out,
        subprocess.Popen(
            [
                *(sys.executable, "-m", "MAVProxy.mavproxy", f"--master=udpin:127.0.0.1:{port}"),
                *("--dialect=common", f"--state-basedir={folder}"),
            ],
            stdin=subprocess.PIPE,
            stdout=out,
            stderr=subprocess.STDOUT,
            text=True,
            cwd=folder,
        ) as process,
    ):
        stdin = process.stdin
        assert stdin

        def give(line: str) -> None:
            stdin.write(f"{line}\n")
            stdin.flush()

        until("the vehicle", lambda: "Received" in printed.read_text())
        try:
            yield give, printed.read_text
        finally:
            # It ends with its input.
            stdin.close()
            process.wait(20.0)


class Pymavlink:
    """A station of pymavlink."""

    def __init__(self, port: int, system: int = 255) -> None:
        self.link = mavutil.mavlink_connection(f"udpin:127.0.0.1:{port}", source_system=system)
        self.mav = self.link.mav
        assert self.link.wait_heartbeat(timeout=WITHIN_S), "no heartbeat"

    def receive(self, kind: str | list[str], within_s: float = 3.0) -> Any:
        return self.link.recv_match(type=kind, blocking=True, timeout=within_s)

    def acks(self, number: int, within_s: float) -> list[int]:
        """Return the results of a command that come within a time."""
        deadline = time.monotonic() + within_s
        results = []
        while (left := deadline - time.monotonic()) > 0:
            ack = self.receive("COMMAND_ACK", left)
            if ack and ack.command == number:
                results.append(ack.result)
        return results

    def long(self, number: int, *parameters: float) -> int:
        """Give a command; return its final result."""
        all_7 = [*parameters, *([0.0] * (7 - len(parameters)))]
        self.mav.command_long_send(1, 1, number, 0, *all_7)
        while ack := self.receive("COMMAND_ACK"):
            if ack.command == number and ack.result != common.MAV_RESULT_IN_PROGRESS:
                return int(ack.result)
        raise AssertionError(f"command {number} has no answer")

    def close(self) -> None:
        self.link.close()
