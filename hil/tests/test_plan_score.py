"""The score of a plan: flights that are made here, with a known distance from the planned path."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest
from drawn_plan import LATITUDE_DEG, LONGITUDE_DEG

from fcc_hil import plan_file, plan_score
from fcc_hil.flown_plan import FlownPlan
from fcc_hil.plan_score import PlanScore

RADIUS_M = 600.0
LEG_M = 3_000.0
SPEED_MPS = 50.0
TICK_S = 0.025
# Radii of curvature at 47 degrees, WGS-84 (NIMA TR8350.2: a 6,378,137 m, e2 0.00669438).
SQUARE = 1.0 - 0.006_694_38 * math.sin(math.radians(LATITUDE_DEG)) ** 2
MERIDIAN_M = 6_378_137.0 * (1.0 - 0.006_694_38) / SQUARE**1.5
PARALLEL_M = 6_378_137.0 / math.sqrt(SQUARE) * math.cos(math.radians(LATITUDE_DEG))


def _place_deg(north_m: float, east_m: float) -> tuple[float, float]:
    return (
        LATITUDE_DEG + math.degrees(north_m / MERIDIAN_M),
        LONGITUDE_DEG + math.degrees(east_m / PARALLEL_M),
    )


def _plan(tmp_path: Path) -> plan_file.PlanFile:
    """To the north, and at the origin to the east."""
    lines = ["QGC WPL 110"]
    for number, at_m in enumerate([(-LEG_M, 0.0), (-LEG_M, 0.0), (0.0, 0.0), (0.0, LEG_M)]):
        latitude, longitude = _place_deg(*at_m)
        lines.append(f"{number} 0 0 16 0 0 0 0 {latitude:.9f} {longitude:.9f} 900 1")
    path = tmp_path / "corner.waypoints"
    path.write_text("\n".join(lines) + "\n")
    return plan_file.read(path)


def _flown(outside_m: float) -> FlownPlan:
    """So far outside of an arc of RADIUS_M that touches both legs, on which the path is."""
    step_m = SPEED_MPS * TICK_S
    straight = np.arange(0.0, LEG_M - RADIUS_M, step_m)
    turned = np.arange(0.0, math.pi / 2.0, step_m / RADIUS_M)
    zero, out_m = np.zeros_like(straight), RADIUS_M + outside_m
    north = [straight - LEG_M, out_m * np.sin(turned) - RADIUS_M, zero + outside_m]
    east = [zero - outside_m, RADIUS_M - out_m * np.cos(turned), straight + RADIUS_M]
    course = np.concatenate([zero, turned, zero + math.pi / 2.0])
    item = np.concatenate([zero + 2.0, np.full_like(turned, 2.0), zero + 3.0])
    whole = np.ones_like(course)
    return FlownPlan(
        time_s=np.cumsum(whole) * TICK_S,
        latitude_rad=math.radians(LATITUDE_DEG) + np.concatenate(north) / MERIDIAN_M,
        longitude_rad=math.radians(LONGITUDE_DEG) + np.concatenate(east) / PARALLEL_M,
        elevation_m=900.0 * whole,
        airspeed_mps=SPEED_MPS * whole,
        roll_rad=0.4 * whole,
        item=item,
        course_rad=course,
        airspeed_demand_mps=SPEED_MPS * whole,
        altitude_demand_m=900.0 * whole,
        heading_rad=course,
        down_mps=0.0 * whole,
        on_ground=0.0 * whole,
        height_m=900.0 * whole,
    )


def _score(tmp_path: Path, outside_m: float) -> PlanScore:
    reached: dict[int, float] = {1: TICK_S, 2: 2.0, 3: 1e3}
    return plan_score.score(_plan(tmp_path), _flown(outside_m), reached, 800.0)


@pytest.mark.parametrize("outside_m", [0.0, 20.0, -35.0])
def test_a_turn_is_scored_against_the_planned_arc(tmp_path: Path, outside_m: float) -> None:
    """One that is flown steadily beside it is no arc of another radius."""
    (turn,) = _score(tmp_path, outside_m).turns
    assert turn.item == 2
    assert turn.degrees == pytest.approx(90.0, abs=0.1)
    assert turn.radius_m == pytest.approx(RADIUS_M, abs=1.0)
    assert turn.cross_track_rms_m == pytest.approx(abs(outside_m), abs=1.0)
    assert turn.cross_track_max_m == pytest.approx(abs(outside_m), abs=1.0)


def test_legs_are_scored_across_them(tmp_path: Path) -> None:
    for leg in _score(tmp_path, 20.0).legs:
        assert leg.cross_track_rms_m == pytest.approx(20.0, abs=0.2)
        assert leg.seconds == pytest.approx((LEG_M - RADIUS_M) / SPEED_MPS, abs=1.0)


def test_the_figures_have_the_names_that_are_promised(tmp_path: Path) -> None:
    """Those of the issue, and NaN nowhere: JSON has none."""
    score = _score(tmp_path, 0.0)
    document = json.loads(json.dumps(score.document(), allow_nan=False))
    waypoints = {"passed", "closest_m", "altitude_error_ft"}
    assert waypoints <= document["waypoints"][0].keys()
    legs = {"cross_track_rms_m", "cross_track_max_m", "altitude_rms_ft", "airspeed_error_kt"}
    assert legs <= document["legs"][0].keys()
    assert document["landing"] is None
    landing = {"centre_line_m", "along_m", "sink_fpm", "heading_error_deg", "bank_deg"}
    assert landing <= plan_score.LandingScore.__annotations__.keys()
