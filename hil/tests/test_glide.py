"""A glide without power and its landing with JSBSim, by raw sensors, from its truth."""

from __future__ import annotations

import math
import os

from fcc_hil import glide_flight

SEEDS = int(os.environ.get("FCC_GLIDES", "1"))
MOST_SINK_FPM = 500.0


def test_without_its_engine_it_lands_on_the_runway() -> None:
    """Issue: from 3,000 ft within glide, at most 500 ft/min, 18 of 20."""
    good = 0
    for seed in range(101, 101 + SEEDS):
        drawn = glide_flight.draw(seed)
        score = glide_flight.fly(seed, drawn)
        print(f"\nseed {seed}: {drawn}, {score}")
        assert math.isfinite(score.sink_fpm)
        good += score.on_runway and score.sink_fpm <= MOST_SINK_FPM
    print(f"{good} of {SEEDS}")
    assert good >= 0.9 * SEEDS
