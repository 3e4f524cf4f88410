"""Legs and circles with JSBSim's c172p by raw sensors, from its truth."""

from __future__ import annotations

import math
import os
from collections.abc import Callable
from pathlib import Path

import drawn_plan
import fcc
import pytest
from drawn_plan import Drawn

from fcc_hil import plan_flight
from fcc_hil.plan_flight import PlanConditions
from fcc_hil.plan_score import PlanScore
from fcc_hil.plant import Weather
from fcc_hil.units import FT_TO_M

TWELVE_LEGS = Path(__file__).parents[2] / "config/plans/twelve-legs.waypoints"
SEEDS = int(os.environ.get("FCC_GUIDANCE", "0"))
"""Of each: they are slow. Some legs are flown in each run (test_plan)."""
FIRST = int(os.environ.get("FCC_FIRST_SEED", "401"))
each_seed = pytest.mark.parametrize("seed", range(FIRST, FIRST + SEEDS))
FLY_OVERS = (5, 8, 11)
WITHIN_M = 60.0
CLIMBS = (5, 9)
"""Legs to another altitude."""
ALTITUDE_M = 3_000.0 * FT_TO_M
_LOITER_TURNS = 18


@each_seed
@pytest.mark.parametrize(
    "wind", [(0.0, 0.0), *((20.0, from_deg) for from_deg in (0, 90, 180, 270))]
)
def test_twelve_legs(
    wind: tuple[float, float], seed: int, measured: Callable[[str, object], None]
) -> None:
    """Issue: 5 m calm, 10 m in 20 kt; 15 ft on level legs, 2 kt, fly-overs within 60 m."""
    wind_kt, from_deg = wind
    weather = Weather(wind_kt=wind_kt, wind_from_deg=from_deg)
    score, _ = plan_flight.fly(TWELVE_LEGS, PlanConditions(weather=weather, seed=seed))
    measured("seed", seed)
    for what, value in _figures(score).items():
        measured(f"{wind_kt:.0f} kt: {what}", f"{value:.1f}")
    assert all(waypoint.passed for waypoint in score.waypoints)
    assert [leg.item for leg in score.legs] == list(range(2, 13))
    for leg in score.legs:
        assert leg.cross_track_rms_m <= (10.0 if wind_kt else 5.0), leg
        assert leg.airspeed_error_kt <= 2.0, leg
        if leg.item not in CLIMBS:
            assert leg.altitude_max_ft <= 15.0, leg
    for waypoint in score.waypoints:
        if waypoint.item in FLY_OVERS:
            assert waypoint.closest_m <= WITHIN_M, waypoint


def _figures(score: PlanScore) -> dict[str, float]:
    """Return the largest of legs and turns."""
    level = [leg for leg in score.legs if leg.item not in CLIMBS]
    over = [waypoint for waypoint in score.waypoints if waypoint.item in FLY_OVERS]
    return {
        "off a leg, m RMS": max(leg.cross_track_rms_m for leg in score.legs),
        "off a leg, m": max(leg.cross_track_max_m for leg in score.legs),
        "off the altitude of a level leg, ft": max(leg.altitude_max_ft for leg in level),
        "off the airspeed, kt": max(leg.airspeed_error_kt for leg in score.legs),
        "past a fly-over, m": max(waypoint.closest_m for waypoint in over),
        "off a turn, m RMS": max(turn.cross_track_rms_m for turn in score.turns),
        "off a turn, m": max(turn.cross_track_max_m for turn in score.turns),
        "bank in a turn, °": max(turn.bank_max_deg for turn in score.turns),
    }


def _circles(*radii_m: float) -> str:
    """Around places 4 km apart, 1.5 times each, to the north."""
    items = drawn_plan.waypoints((0.0, 0.0), ALTITUDE_M)
    for number, radius_m in enumerate(radii_m, 1):
        at_m = (4_000.0 * number, 0.0)
        items.append(Drawn(_LOITER_TURNS, at_m, ALTITUDE_M, (1.5, 0.0, radius_m, 0.0)))
    return drawn_plan.text(items)


@each_seed
@pytest.mark.parametrize("from_deg", [0.0, 90.0])
def test_circles_in_15_kt(
    from_deg: float, seed: int, tmp_path: Path, measured: Callable[[str, object], None]
) -> None:
    """Issue: 750 m and 1,000 m at 100 kt, within 5 % of the radius, at most 30 degrees of bank."""
    plan = tmp_path / "circles.waypoints"
    plan.write_text(_circles(750.0, 1_000.0, -750.0))
    weather = Weather(wind_kt=15.0, wind_from_deg=from_deg)
    score, _ = plan_flight.fly(plan, PlanConditions(weather=weather, seed=seed))
    assert [circle.radius_m for circle in score.circles] == [750.0, 1_000.0, 750.0]
    for circle in score.circles:
        error = circle.radius_error_max_percent
        measured(f"circle of {circle.radius_m:.0f} m in 15 kt: off the radius, %", f"{error:.1f}")
        assert circle.seconds > math.tau * circle.radius_m / 60.0
        assert circle.radius_error_max_percent <= 5.0
        assert circle.bank_max_deg <= 30.0


def test_a_smaller_circle_is_refused_with_the_smallest_radius(tmp_path: Path) -> None:
    """(V + W)^2/(g tan 30 deg), 100 kt and 15 kt: 618.2 m, so 619 m are given and flown."""
    plan = tmp_path / "circles.waypoints"
    plan.write_text(_circles(618.0))
    with pytest.raises(fcc.ConfigError, match=r"618 m is too small .* give at least 619 m"):
        fcc.Machine(plan_flight.configuration(plan, "kalman", 15.0))
    plan.write_text(_circles(619.0))
    fcc.Machine(plan_flight.configuration(plan, "kalman", 15.0))
