"""A glide without power and its landing with JSBSim, by raw sensors, from its truth."""

from __future__ import annotations

import math
import os
from collections.abc import Callable

import glide_flight

from fcc_hil.workers import local_workers

SEEDS = int(os.environ.get("FCC_GLIDES", "1"))
FIRST = int(os.environ.get("FCC_FIRST_SEED", "101"))
MOST_SINK_FPM = 500.0


def test_without_its_engine_it_lands_on_the_runway(measured: Callable[[str, object], None]) -> None:
    """Issue: from 3,000 ft within glide, at most 500 ft/min, 18 of 20."""
    seeds = range(FIRST, FIRST + SEEDS)
    good = 0
    with local_workers(glide_flight.fly_drawn, None if SEEDS > 1 else 1) as fly:
        for seed, score in zip(seeds, fly(seeds), strict=True):
            is_good = score.on_runway and score.sink_fpm <= MOST_SINK_FPM
            print(f"\nseed {seed}: {glide_flight.draw(seed)}, {score}, good: {is_good}")
            measured("seed", seed)
            measured("good", is_good)
            measured("on the runway", score.on_runway)
            measured("touchdown, ft/min", f"{score.sink_fpm:.0f}")
            measured("touches behind the aim, m", f"{score.touch_m[0]:.0f}")
            assert math.isfinite(score.sink_fpm)
            good += is_good
    print(f"{good} of {SEEDS}")
    assert good >= 0.9 * SEEDS
