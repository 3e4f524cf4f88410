"""A flight plan by the daemon, over X-Plane's protocol, in real time."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from fcc_hil.__main__ import main

PLAN = """QGC WPL 110
0 0 0 16 0 0 0 0 47.0 8.0 914.4 1
1 0 0 16 0 60 0 0 47.013 8.0 914.4 1
2 0 0 16 0 60 0 0 47.025 8.013 914.4 1
"""
"""1.4 km to the north, and 1.7 km after a turn of 37 degrees."""


def test_legs_are_flown_over_x_planes_protocol(
    fccd: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Issue: cross-track RMS of legs at most 10 m in 20 kt, airspeed within 2 kt."""
    plan, figures, picture = (tmp_path / name for name in ("a.waypoints", "a.json", "a.png"))
    plan.write_text(PLAN)
    words = ["plan", "--realtime", "--fccd", fccd, "--plan", plan, "--json", figures]
    words += ["--plot", picture, "--wind", 20, "--wind-from", 270]
    assert main([str(word) for word in words]) == 0, capsys.readouterr().err
    score = json.loads(figures.read_text())
    assert [waypoint["passed"] for waypoint in score["waypoints"]] == [True, True]
    (leg,) = score["legs"]
    assert leg["cross_track_rms_m"] <= 10.0
    assert leg["airspeed_error_kt"] <= 2.0
    assert leg["altitude_max_ft"] <= 15.0
    assert picture.read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"


def test_what_the_protocol_does_not_have_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    plan = tmp_path / "a.waypoints"
    plan.write_text(PLAN)
    assert main(["plan", "--realtime", "--plan", str(plan), "--no-range-finder"]) == 1
    assert "--no-range-finder with --realtime" in capsys.readouterr().err
