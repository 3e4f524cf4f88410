"""The stream of a flight, decoded by node-mavlink: another implementation than ours.

`make test-mavlink` streams an hour; `make test` some seconds.
"""

from __future__ import annotations

import json
import os
import shutil
import socket
import subprocess
import time
from pathlib import Path
from typing import Any

import pytest
from mavlink_vehicle import IN_THE_AIR, vehicle
from pymavlink.dialects.v20 import common

NODE = Path(__file__).parents[1] / "node"
STREAMS = (30, 33, 74, 24, 62, 1, 2, 245, 42, 231, 436, 242, 437)
"""All that are sent by themselves."""
SECONDS = 20.0


def decoded(stream: Path) -> Any:
    node = shutil.which("node")
    assert node, "node is not installed: apt-get install nodejs"
    assert (NODE / "node_modules").is_dir(), "`make test-mavlink` installs node-mavlink"
    return json.loads(subprocess.check_output([node, NODE / "decode.mjs", stream]))


def assert_whole(found: Any, stream: Path) -> None:
    assert found["unknown"] == {}
    problems = ("crcErrors", "notKnownToSplitter", "gaps", "wrong")
    assert {name: found[name] for name in problems} == dict.fromkeys(problems, 0)
    assert found["bytes"] == stream.stat().st_size


def test_node_mavlink_decodes_the_stream_of_a_daemon(tmp_path: Path, fccd: Path) -> None:
    stream = tmp_path / "stream"
    with (
        vehicle(tmp_path / "ground", fccd, IN_THE_AIR) as (_, port),
        stream.open("wb") as out,
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as heard,
    ):
        heard.bind(("127.0.0.1", port))
        heard.settimeout(5.0)
        mav = common.MAVLink(None, srcSystem=255, srcComponent=190)
        frame, address = heard.recvfrom(300)
        out.write(frame)
        for number in STREAMS:
            ask = mav.command_long_encode(1, 1, 511, 0, number, 20_000, 0, 0, 0, 0, 0)
            heard.sendto(ask.pack(mav), address)
        # Once each: what is sent on request only.
        for number in (148, 410, 435, 235):
            ask = mav.command_long_encode(1, 1, 512, 0, number, 0, 0, 0, 0, 0, 0)
            heard.sendto(ask.pack(mav), address)
        heard.sendto(mav.param_request_list_encode(1, 1).pack(mav), address)
        ends = time.monotonic() + SECONDS
        while time.monotonic() < ends:
            out.write(heard.recv(300))
    found = decoded(stream)
    assert_whole(found, stream)
    assert found["names"]["ATTITUDE"] > 45 * (SECONDS - 1)
    assert {"PARAM_VALUE", "AVAILABLE_MODES", "AUTOPILOT_VERSION"} <= set(found["names"])


@pytest.mark.skipif("FCC_MAVLINK_STREAM" not in os.environ, reason="`make test-mavlink`")
def test_node_mavlink_decodes_the_stream_of_an_hour() -> None:
    """It is written by the tests of fcc-mavlink, in lockstep."""
    stream = Path(os.environ["FCC_MAVLINK_STREAM"])
    found = decoded(stream)
    print(json.dumps(found))
    assert_whole(found, stream)
    assert found["names"]["ATTITUDE"] >= 48 * int(os.environ["FCC_MAVLINK_SECONDS"])
