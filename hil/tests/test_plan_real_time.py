"""A flight plan by the daemon, over X-Plane's protocol, in real time."""

from __future__ import annotations

import json
import os
from pathlib import Path

import numpy as np
import pytest

from fcc_hil.__main__ import main

LEGS = """QGC WPL 110
0 0 0 16 0 0 0 0 47.0 8.0 914.4 1
1 0 0 16 0 60 0 0 47.013 8.0 914.4 1
2 0 0 16 0 60 0 0 47.025 8.013 914.4 1
"""
"""1.4 km to the north, and 1.7 km after a turn of 37 degrees."""
SHORT = """QGC WPL 110
0 0 0 16 0 0 0 0 47.0 8.0 914.4 1
1 0 0 16 0 60 0 0 47.0095 8.0 914.4 1
2 0 0 16 0 60 0 0 47.0148 8.0008 914.4 1
"""
"""1.1 km to the north, and 590 m after a turn of 6 degrees."""
RIDGE_DEG, RIDGE_M, GROUND_M = 47.0125, 700.0, 400.0
PLANS = [SHORT, LEGS] if os.environ.get("FCC_PLAN_REAL_TIME") == "1" else [SHORT]


def _tiles(folder: Path) -> Path:
    """Write a ridge from west to east between the waypoints."""
    for south in (46, 47):
        latitude = south + 1.0 - np.arange(1_201) / 1_200.0
        rise = (RIDGE_M - GROUND_M) * np.exp(-(((latitude - RIDGE_DEG) / 0.002) ** 2))
        posts = np.repeat(np.round(GROUND_M + rise)[:, None], 1_201, axis=1)
        for west in (7, 8):
            (folder / f"N{south}E00{west}.hgt").write_bytes(posts.astype(">i2").tobytes())
    return folder


@pytest.mark.parametrize("text", PLANS)
def test_legs_are_flown_over_x_planes_protocol(
    fccd: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], text: str
) -> None:
    """Issue: cross-track RMS of legs at most 10 m in 20 kt, airspeed within 2 kt.

    Over the ridge of its tiles, which are the ground of the simulator, too.
    """
    plan, figures, picture = (tmp_path / name for name in ("a.waypoints", "a.json", "a.png"))
    plan.write_text(text)
    words = ["plan", "--realtime", "--fccd", fccd, "--plan", plan, "--json", figures]
    words += ["--plot", picture, "--wind", 20, "--wind-from", 270, "--terrain", _tiles(tmp_path)]
    assert main([str(word) for word in words]) == 0, capsys.readouterr().err
    score = json.loads(figures.read_text())
    assert [waypoint["passed"] for waypoint in score["waypoints"]] == [True, True]
    (leg,) = score["legs"]
    assert leg["cross_track_rms_m"] <= 10.0
    assert leg["airspeed_error_kt"] <= 2.0
    assert leg["altitude_max_ft"] <= 15.0
    assert score["terrain"]["collides"] is False
    assert score["terrain"]["lowest_m"] == pytest.approx(914.4 - RIDGE_M, abs=8.0)
    assert score["terrain"]["latitude_deg"] == pytest.approx(RIDGE_DEG, abs=0.0005)
    assert picture.read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"


def test_what_the_protocol_does_not_have_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    plan = tmp_path / "a.waypoints"
    plan.write_text(SHORT)
    assert main(["plan", "--realtime", "--plan", str(plan), "--no-range-finder"]) == 1
    assert "--no-range-finder with --realtime" in capsys.readouterr().err
