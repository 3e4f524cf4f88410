"""Each kind of link, with and without a key; MAVProxy in flight; recordings by MAVSDK."""

from __future__ import annotations

import os
import signal
import socket
import time
import tty
from collections.abc import Callable
from contextlib import ExitStack
from functools import partial
from pathlib import Path
from typing import Any

import fcc
import pytest
from mavlink_vehicle import (
    IN_THE_AIR,
    Pymavlink,
    free_port,
    mavproxy,
    mavsdk_system,
    until,
    vehicle,
)
from mavsdk.plugins.log_files import LogFiles
from pymavlink import mavutil
from pymavlink.dialects.v20 import common

KEY = bytes(range(32))
REQUEST_MESSAGE, AUTOPILOT_VERSION = 512, 148


class Line(mavutil.mavfile):  # type: ignore[misc]
    """The other end of a serial line."""

    def __init__(self, fd: int) -> None:
        os.set_blocking(fd, False)
        super().__init__(fd, "line")

    def recv(self, n: int | None = None) -> bytes:
        try:
            return os.read(self.fd, n or 280)
        except BlockingIOError:
            return b""

    def write(self, buf: bytes) -> None:
        os.write(self.fd, buf)

    def close(self) -> None:
        os.close(self.fd)


def serial() -> tuple[str, Callable[[], Any]]:
    ours, theirs = os.openpty()
    tty.setraw(ours)
    return f"serial:{os.ttyname(theirs)}:57600", lambda: Line(ours)


def over(listens: str, connects: str) -> Callable[[], tuple[str, Callable[[], Any]]]:
    def made() -> tuple[str, Callable[[], Any]]:
        address = f"127.0.0.1:{free_port()}"
        return f"{listens}:{address}", lambda: mavutil.mavlink_connection(f"{connects}:{address}")

    return made


def wire_address(wire: str) -> tuple[str, int]:
    _, host, port = wire.split(":")
    return host, int(port)


def answered(link: Any) -> Any:
    """Ask for a message: its answer, or none."""
    link.mav.heartbeat_send(6, 8, 0, 0, 0)
    link.mav.command_long_send(1, 1, REQUEST_MESSAGE, 0, AUTOPILOT_VERSION, *[0] * 6)
    return link.recv_match(type="AUTOPILOT_VERSION", blocking=True, timeout=1.0)


@pytest.mark.parametrize("is_signed", [False, True], ids=["open", "signed"])
@pytest.mark.parametrize(
    "make",
    [serial, over("tcpin", "tcp"), over("udpin", "udpout")],
    ids=["serial", "tcpin", "udpin"],
)
def test_a_station_is_answered_on_each_kind_of_link(
    make: Callable[[], tuple[str, Callable[[], Any]]], is_signed: bool, tmp_path: Path, fccd: Path
) -> None:
    wire, connect = make()
    options = ["--mavlink", wire]
    if is_signed:
        key = tmp_path / "key"
        key.write_text(KEY.hex())
        key.chmod(0o600)
        options += ["--mavlink-key", str(key)]
    with vehicle(tmp_path / "ground", fccd, options=options):
        link = connect()
        if is_signed:
            # Without the key it is as if nobody was there.
            assert not answered(link)
            link.setup_signing(KEY, sign_outgoing=True)
        assert until("an answer", lambda: answered(link)).vendor_id == 0
        link.mav.param_request_list_send(1, 1)
        first = link.recv_match(type="PARAM_VALUE", blocking=True, timeout=5.0)
        names = {first.param_id}
        while len(names) < first.param_count:
            one = link.recv_match(type="PARAM_VALUE", blocking=True, timeout=5.0)
            assert one, f"{len(names)} of {first.param_count} parameters"
            names.add(one.param_id)
        heartbeat = link.recv_match(type="HEARTBEAT", blocking=True, timeout=3.0)
        assert heartbeat.type == common.MAV_TYPE_FIXED_WING
        assert heartbeat.get_signed() == is_signed
        link.close()


def test_who_is_not_the_peer_of_a_link_is_not_heard(tmp_path: Path, fccd: Path) -> None:
    with vehicle(tmp_path / "ground", fccd) as (_, port):
        peer = mavutil.mavlink_connection(f"udpin:127.0.0.1:{port}")
        assert peer.wait_heartbeat(timeout=20.0)
        host, own_port = next(iter(peer.clients))
        foreign = mavutil.mavlink_connection(f"udpout:{host}:{own_port}")
        assert not answered(foreign)
        assert answered(peer)
        foreign.close()
        peer.close()


def test_who_sends_nothing_valid_makes_room_for_a_station(tmp_path: Path, fccd: Path) -> None:
    wire, connect = over("tcpin", "tcp")()
    port = free_port()
    options = ["--mavlink", wire, "--mavlink", f"udpin:127.0.0.1:{port}"]
    with vehicle(tmp_path / "ground", fccd, options=options), ExitStack() as open_ones:
        for _ in range(12):
            other = open_ones.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
            other.sendto(b"x", ("127.0.0.1", port))
            tcp = open_ones.enter_context(socket.create_connection(wire_address(wire)))
            tcp.sendall(b"x")
        for link in (connect(), mavutil.mavlink_connection(f"udpout:127.0.0.1:{port}")):
            assert until("an answer", partial(answered, link))
            link.close()


def test_mavproxy_loads_a_fence_arms_and_chooses_modes(tmp_path: Path, fccd: Path) -> None:
    mission, loiter = 4 << 24 | 4 << 16, 3 << 24 | 4 << 16
    fence = tmp_path / "fence.txt"
    corners = [(44.5, 7.5), (44.5, 8.5), (45.5, 8.5), (45.5, 7.5)]
    rows = [
        f"{n}\t0\t0\t5001\t4\t0\t0\t0\t{north}\t{east}\t0\t1"
        for n, (north, east) in enumerate(corners)
    ]
    fence.write_text("\n".join(["QGC WPL 110", *rows]) + "\n")
    with (
        vehicle(tmp_path / "ground", fccd, IN_THE_AIR) as (ground, port),
        mavproxy(port, tmp_path) as (give, printed),
    ):
        give(f"fence load {fence}")
        until("it is taken", lambda: "TYPE_FENCE: ACCEPTED" in printed())
        until("the fence", lambda: ((ground.vehicle() or {}).get("plan") or {}).get("fence"))

        def corner_lines() -> int:
            give("fence list")
            time.sleep(2.0)
            return sum(line.startswith("5001 ") for line in printed().splitlines())

        until("its list", lambda: corner_lines() >= len(corners))
        give(f"mode {mission}")
        until("the mode", lambda: "DO_SET_MODE: ACCEPTED" in printed())
        give("arm throttle")
        until("armed", lambda: ground.tick()["state"] == "engaged")
        give(f"mode {loiter}")
        until("it circles", lambda: ground.tick()["guidance"]["mode"] == "loiter")
        assert "breach" not in printed()


def test_mavsdk_downloads_a_recording_as_it_is_on_the_board(tmp_path: Path, fccd: Path) -> None:
    with vehicle(tmp_path / "ground", fccd) as (ground, port):
        mavsdk, system = mavsdk_system(port)
        logs = LogFiles(system)
        entry = until("a recording", lambda: [one for one in logs.get_entries() if one.size_bytes])[
            -1
        ]
        path = tmp_path / "downloaded.mcap"
        ended: list[Any] = []
        logs.download_log_file_async(entry, str(path), lambda *said: ended.append(said))
        until("downloaded", lambda: path.exists() and path.stat().st_size >= entry.size_bytes)
        downloaded = path.read_bytes()[: entry.size_bytes]
        files = sorted(tmp_path.rglob("*.mcap"))
        files.remove(path)
        assert len(files) == 1
        # It is still written.
        assert downloaded == files[0].read_bytes()[: entry.size_bytes]
        mavsdk.destroy()
        assert ground.process.poll() is None


def test_of_a_daemon_that_hangs_no_motion_is_told(tmp_path: Path, fccd: Path) -> None:
    with vehicle(tmp_path / "ground", fccd, IN_THE_AIR) as (ground, port):
        station = Pymavlink(port)
        process_id = fcc.Watcher(ground.instance).info["process_id"]
        os.kill(process_id, signal.SIGSTOP)
        try:
            until("the text", lambda: "sends nothing" in station.receive("STATUSTEXT", 5.0).text)
            beat = station.receive("HEARTBEAT", 3.0)
            assert beat.system_status == common.MAV_STATE_CRITICAL
            assert station.receive(["ATTITUDE", "GLOBAL_POSITION_INT"], 1.0) is None
        finally:
            os.kill(process_id, signal.SIGCONT)
        assert station.receive("ATTITUDE", 5.0)
        station.close()
