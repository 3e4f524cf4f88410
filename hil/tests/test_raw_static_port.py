"""A static port that closes while a circuit is flown by raw sensors."""

from __future__ import annotations

import math
from pathlib import Path

import fcc
import numpy as np
import pytest
from first_of import first_of

from fcc_hil.lockstep_rig import LockstepRig
from fcc_hil.plan_flight import PlanConditions, fly
from fcc_hil.plant import Weather

CIRCUIT = Path(__file__).parents[2] / "config" / "plans" / "circuit.waypoints"
CLOSES_M = 60.0
# Those of the plan are at most 300 m over its home.
HIGHEST_M = 400.0


@pytest.mark.parametrize("seed", first_of(71, 72))
def test_the_altimeter_is_flown_without_and_not_the_receiver(seed: int) -> None:
    """A tape over the port, or water in it: the pressure stands, but for the sensor's noise.

    A healthy receiver was doubted for it, and the aircraft climbed to 2,500 m.
    """
    noise = np.random.default_rng(seed)
    closed: dict[str, float] = {}
    height_m = 0.0

    def fault(values: fcc.Measurements, _: float) -> None:
        is_read = not math.isnan(values.static_pressure_pa)
        if is_read and (height_m > CLOSES_M or closed):
            pa = closed.setdefault("pa", values.static_pressure_pa)
            values.static_pressure_pa = pa + noise.normal(0.0, 0.5)

    highest_m = 0.0
    texts: list[str] = []

    def watch(rig: LockstepRig) -> bool:
        nonlocal height_m, highest_m
        texts[:] = [event.text for event in rig.events]
        height_m = rig.plant.state().height_m
        highest_m = max(highest_m, height_m)
        return highest_m > HIGHEST_M

    weather = Weather(wind_kt=8.0, wind_from_deg=60.0, turbulence_severity=2)
    conditions = PlanConditions(seed=seed, weather=weather, sensors="board", raw_fault=fault)
    score, _ = fly(CIRCUIT, conditions, longest_s=900.0, watch=watch)
    assert highest_m <= HIGHEST_M
    assert "now: altitude contradicts the other sensors and is not used" in texts
    assert not any("the satellite receiver" in text for text in texts)
    assert score.landing is not None
