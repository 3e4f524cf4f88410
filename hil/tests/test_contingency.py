"""What the autopilot does by itself, with JSBSim by raw sensors."""

from __future__ import annotations

import os

import numpy as np
import pytest

from fcc_hil import fence_flight

SEEDS = int(os.environ.get("FCC_FENCES", "1"))


@pytest.mark.parametrize("seed", range(101, 101 + SEEDS))
def test_the_fence_is_not_crossed(seed: int) -> None:
    """In 20 kt from anywhere, in any direction, in turbulence: 0 times; then it returns."""
    drawn = np.random.default_rng(seed)
    course_deg, wind_from_deg = drawn.uniform(0.0, 360.0, 2)
    score = fence_flight.fly(
        seed, course_deg=course_deg, wind_from_deg=wind_from_deg, wind_kt=20.0, turbulence=2
    )
    print(f"\nseed {seed}, course {course_deg:.0f}, wind from {wind_from_deg:.0f}: {score}")
    assert score.nearest_m > 0.0
    # No earlier than needed: 30 m are the margin, the rest is for the wind's estimate.
    assert score.nearest_m < 300.0
    assert score.home_m < 0.6 * fence_flight.RADIUS_M
