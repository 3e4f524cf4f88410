"""What the autopilot does by itself, flown to its end with JSBSim by raw sensors.

Where it happens, the legs, the wind and the sensors' errors are drawn from the seed.
"""

from __future__ import annotations

import os
from collections.abc import Callable

import contingency_flight
import fence_flight
import numpy as np
import pytest
import terrain_flight

FENCES = int(os.environ.get("FCC_FENCES", "1"))
FLIGHTS = int(os.environ.get("FCC_CONTINGENCIES", "0"))
"""Of each of the others: they are slow, and flown with the built-in aircraft in each run."""
FIRST = int(os.environ.get("FCC_FIRST_SEED", "101"))
Measured = Callable[[str, object], None]
each_seed = pytest.mark.parametrize("seed", range(FIRST, FIRST + FLIGHTS))
WIND_KT = 20.0


@pytest.mark.parametrize("seed", range(FIRST, FIRST + FENCES))
def test_the_fence_is_not_crossed(seed: int, measured: Measured) -> None:
    """In 20 kt from anywhere, in any direction, in turbulence: 0 times; then it returns."""
    drawn = np.random.default_rng(seed)
    course_deg, wind_from_deg = drawn.uniform(0.0, 360.0, 2)
    score = fence_flight.fly(
        seed, course_deg=course_deg, wind_from_deg=wind_from_deg, wind_kt=WIND_KT, turbulence=2
    )
    print(f"\nseed {seed}, course {course_deg:.0f}, wind from {wind_from_deg:.0f}: {score}")
    measured("seed", seed)
    measured("fence: not crossed", score.nearest_m > 0.0)
    measured("fence: inside it, m", f"{score.nearest_m:.0f}")
    assert score.nearest_m > 0.0
    # No earlier than needed: 30 m are the margin, the rest is for the wind's estimate.
    assert score.nearest_m < 300.0
    assert score.home_m < 0.6 * fence_flight.RADIUS_M


@each_seed
def test_a_position_is_lost_for_a_minute(seed: int, measured: Measured) -> None:
    """Issue: at most 150 m off in 20 kt, and the plan is resumed: its last leg within 10 m."""
    reckoned, score, watch = contingency_flight.lose_position(seed, wind_kt=WIND_KT, lasts_s=60.0)
    print(f"\nseed {seed}, lost after {watch.lost_after_s:.0f} s: {reckoned}, {score.legs[-1]}")
    measured("seed", seed)
    measured("position lost for a minute: error, m", f"{reckoned.error_m:.0f}")
    measured("position lost for a minute: error, share of 2 sigma", f"{reckoned.of_stated:.2f}")
    measured(
        "position lost for a minute: last leg, m RMS", f"{score.legs[-1].cross_track_rms_m:.1f}"
    )
    assert watch.modes[:3] == ["plan", "return", "plan"]
    assert "there is a position again: flying on" in watch.events
    assert reckoned.error_m <= 150.0
    assert reckoned.of_stated <= 1.0
    assert [waypoint.item for waypoint in score.waypoints if waypoint.passed] == [1, 2, 3]
    assert score.legs[-1].item == 3
    assert score.legs[-1].cross_track_rms_m <= 10.0


@each_seed
def test_a_position_is_lost_for_good(seed: int, measured: Measured) -> None:
    """Issue: the area of home is reached, within the stated uncertainty."""
    reckoned, watch = contingency_flight.lose_position_for_good(seed, wind_kt=WIND_KT)
    print(f"\nseed {seed}, lost after {watch.lost_after_s:.0f} s: {reckoned}")
    measured("seed", seed)
    measured("position lost for good: returns", watch.modes == ["plan", "return"])
    measured("position lost for good: error, m", f"{reckoned.error_m:.0f}")
    measured("position lost for good: error, share of 2 sigma", f"{reckoned.of_stated:.2f}")
    assert watch.modes == ["plan", "return"]
    assert reckoned.of_stated <= 1.0
    # A circle is flown within 5 % of its radius.
    assert reckoned.off_circle_m <= reckoned.stated_m + 0.05 * contingency_flight.CIRCLE_M


@each_seed
def test_a_commander_is_lost(seed: int, measured: Measured) -> None:
    """It returns when the promised time is over, and circles within 5 % of the radius."""
    reckoned, watch = contingency_flight.lose_commander(seed, wind_kt=WIND_KT, promised_s=10.0)
    print(f"\nseed {seed}, lost after {watch.lost_after_s:.0f} s: {reckoned}")
    measured("command link lost: returns", watch.modes == ["plan", "return"])
    measured("command link lost: off the circle at home, m", f"{reckoned.off_circle_m:.0f}")
    assert watch.modes == ["plan", "return"]
    assert "command link lost, no heartbeat in time: returning" in watch.events
    assert reckoned.off_circle_m <= 0.05 * contingency_flight.CIRCLE_M


@each_seed
def test_a_battery_is_used_up(seed: int, measured: Measured) -> None:
    """It lands: on a runway of 30 m, below 400 ft/min."""
    landing, watch = contingency_flight.use_battery(seed, wind_kt=8.0)
    print(f"\nseed {seed}, {watch.lost_after_s:.0f} s: {landing}")
    measured("battery low: lands", landing is not None)
    if landing is not None:
        measured("battery low: touchdown, ft/min", f"{landing.sink_fpm:.0f}")
        measured("battery low: off the centre line, m", f"{abs(landing.centre_line_m):.1f}")
    assert "the battery is low: landing" in watch.events
    assert landing is not None
    assert max(abs(landing.centre_line_m), landing.roll_out_m) < 15.0
    assert landing.sink_fpm < 400.0


@each_seed
def test_no_ridge_is_flown_into(seed: int, measured: Measured) -> None:
    """Ridges of 800 to 2,320 m, 3,000 ft high, in 20 kt from anywhere: over them, or away."""
    ridge_m = 400.0 + 80.0 * (seed - FIRST)
    wind_from_deg = seed * 97.0 % 360.0
    score = terrain_flight.fly(seed, ridge_m, wind_from_deg, WIND_KT)
    print(f"\nseed {seed}, ridge {ridge_m:.0f} m, wind from {wind_from_deg:.0f}: {score}")
    measured("ridge: cleared", score.nearest_m > 0.0)
    measured("ridge: least height over it, m", f"{score.nearest_m:.0f}")
    assert score.nearest_m > 0.0
    assert score.arrives != ("terrain is ahead: turning away: returning" in score.told)


def test_in_cold_air_the_ridge_is_cleared_by_the_height_that_a_receiver_shows() -> None:
    """At 3,000 ft, 54 m over the ridge in standard air.

    514 m above home, where the altimeter was set, it is some 70 m lower at 35 K less: 4 % for
    each 10 K (ICAO Doc 8168, III-1-4-1).
    """
    score = terrain_flight.fly(FIRST, 460.0, 270.0, 0.0, off_standard_k=-35.0)
    assert score.nearest_m > 15.0
    assert "terrain is ahead: climbing" in score.told
    assert score.arrives
