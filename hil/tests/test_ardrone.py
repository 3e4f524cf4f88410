"""The built-in multicopter as an AR.Drone, flown by programs of others, untouched."""

from __future__ import annotations

import json
import shutil
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path

import pytest
from daemon_under_test import DaemonUnderTest

HERE = Path(__file__).parent
NODE = HERE.parent / "node"
SUCCESS = 0
# A full stick's, of firmware 2.4.8, indoors.
TILT_DEG, YAW_DPS = 12.0, 100.0
FLY, LAND = 290_718_208, 290_717_696


def flying(fccd: Path, folder: Path, address: str) -> DaemonUnderTest:
    path = folder / "ardrone.toml"
    path.write_text(
        f'vehicle = "multicopter"\n[ardrone]\naddress = "{address}"\n'
        '[built-in]\nwind_mps = 0.0\ngusts = "none"\n'
        f'[recording]\nfolder = "{folder}/recordings"\n'
    )
    return DaemonUnderTest([fccd, "fly", "--config", path, "--json"], folder)


def client(name: str, address: str) -> list[str | Path]:
    if name == "pyardrone":
        return [sys.executable, HERE / "fly_pyardrone.py", address]
    node = shutil.which("node")
    assert node, "node is not installed: apt-get install nodejs"
    return [node, NODE / "fly.mjs", address]


@pytest.mark.parametrize(
    ("name", "address"), [("ar-drone", "127.42.0.1"), ("pyardrone", "127.42.0.2")]
)
def test_a_client_takes_off_flies_a_figure_and_lands(
    fccd: Path, tmp_path: Path, name: str, address: str
) -> None:
    with flying(fccd, tmp_path, address) as daemon:
        daemon.wait_for("standby -> engaged")
        done = subprocess.run(
            client(name, address), capture_output=True, text=True, check=False, timeout=90.0
        )
        assert done.returncode == SUCCESS, done.stderr
        ending = daemon.end(signal.SIGINT)
    told = json.loads(done.stdout)
    # What the sticks have done, and nothing else.
    assert told["states"][told["states"].index("TRANS_TAKEOFF") :] == [
        *["TRANS_TAKEOFF", "HOVERING", "FLYING", "HOVERING", "FLYING", "HOVERING"],
        *["TRANS_LANDING", "LANDED"],
    ]
    assert all(0.7 < height_m < 1.3 for height_m in told["heights"])
    least_deg = min(pitch_deg for pitch_deg, _ in told["forward"])
    assert least_deg == pytest.approx(-0.5 * TILT_DEG, abs=2.0)
    assert 500.0 < told["forward"][-1][1] < 2_500.0
    turned_deg = (told["headings"][-1] - told["headings"][0]) % 360.0
    assert turned_deg == pytest.approx(0.5 * YAW_DPS * 2.0, abs=20.0)
    assert ending.exit_code == SUCCESS
    assert ending.report["failsafes"] == 0


def test_a_silent_client_leads_to_a_hover_and_a_landing_and_others_are_not_read(
    fccd: Path, tmp_path: Path
) -> None:
    drone = ("127.42.0.3", 5556)
    with (
        flying(fccd, tmp_path, drone[0]) as daemon,
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as its,
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as others,
    ):
        its.bind(("127.42.1.1", 0))
        others.bind(("127.42.1.2", 0))
        daemon.wait_for("standby -> engaged")
        # Half forward: 0.5 as the bits of a float.
        forward = f"AT*PCMD={{}},1,0,{-1_090_519_040},0,0\r"
        for number in range(200):
            its.sendto(f"AT*REF={2 * number},{FLY}\r".encode(), drone)
            its.sendto(forward.format(2 * number + 1).encode(), drone)
            others.sendto(f"AT*REF=1,{LAND}\r".encode(), drone)
            others.sendto(b"no command\r", drone)
            time.sleep(0.03)
        daemon.wait_for("mode: hover, was stick")
        silent_s = time.monotonic()
        daemon.wait_for("mode: land, was hover")
        assert time.monotonic() - silent_s == pytest.approx(10.0, abs=1.5)
        daemon.wait_for("mode: idle, was land")
        assert "commands come from an AR.Drone client at 127.42.1.1" in daemon.log
        assert "no AT command" not in daemon.log
        assert daemon.log.count("command: land") == 1
        ending = daemon.end(signal.SIGINT)
    assert ending.exit_code == SUCCESS
