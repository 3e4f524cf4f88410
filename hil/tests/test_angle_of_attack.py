"""A vane that jams, with JSBSim's truth: doubted, left out, and flown on without."""

from __future__ import annotations

import math

import fcc
import pytest

from fcc_hil.lockstep import as_controls, as_surfaces, measurements
from fcc_hil.plant import Plant
from fcc_hil.units import FT_TO_M

_CONDITION = "angle of attack contradicts lift and path and is not used"
_ENGAGED_S = 2.0
_JAMS_S = 8.0
_ENDS_S = 30.0


@pytest.mark.parametrize(
    ("jammed_deg", "reason"),
    [
        (15.0, "neither lift nor path agrees with it"),
        (-20.0, "neither lift nor path agrees with it"),
        (172.0, "it is beyond 90 degrees or no number"),
    ],
)
def test_a_jammed_vane_is_doubted_and_flown_on_without(jammed_deg: float, reason: str) -> None:
    """Before: the nose went to -31 degrees, and the aircraft into the ground, without an event."""
    plant = Plant("c172p", seed=7391)
    machine = fcc.Machine('[guidance]\nmode = "hold"\n')
    start_m = plant.state().altitude_m
    texts: list[str] = []
    farthest_ft = 0.0
    steps = round(machine.period_s * 120)
    while plant.time_s < _ENDS_S:
        plant.step(steps)
        state = plant.state()
        values = measurements(state)
        jammed = plant.time_s > _JAMS_S
        values.angle_of_attack_rad = (
            math.radians(jammed_deg) if jammed else state.angle_of_attack_rad
        )
        surfaces = machine.step(
            values, readback=as_surfaces(plant.controls), switch=plant.time_s > _ENGAGED_S
        )
        plant.write(plant.trim if surfaces is None else as_controls(surfaces))
        texts += [event.text for event in machine.events()]
        if not jammed:
            assert not any("angle of attack" in text for text in texts)
        farthest_ft = max(farthest_ft, abs(state.altitude_m - start_m) / FT_TO_M)
    assert machine.holds_control
    assert farthest_ft < 200.0
    assert any(_CONDITION in text for text in texts)
    assert any("angle of attack of sensor" in text and reason in text for text in texts)
