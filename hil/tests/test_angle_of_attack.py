"""A vane that jams, with JSBSim's truth."""

from __future__ import annotations

import math

import fcc
import pytest

from fcc_hil.lockstep import as_controls, as_surfaces, measurements
from fcc_hil.plant import Plant
from fcc_hil.units import FT_TO_M

_ENGAGED_S = 2.0
_JAMS_S = 8.0
_ENDS_S = 30.0


@pytest.mark.fault(
    "Sensors",
    "angle of attack wrong: jammed, beyond ±90°",
    "none: [middle value](envelope.md#speed-and-stall) is used",
    "",
    "continues",
)
@pytest.mark.parametrize("jammed_deg", [15.0, -20.0, 172.0])
def test_a_jammed_vane_is_flown_through(jammed_deg: float) -> None:
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
        farthest_ft = max(farthest_ft, abs(state.altitude_m - start_m) / FT_TO_M)
    assert machine.holds_control
    assert farthest_ft < 200.0
    assert not any("not used" in text or "failsafe" in text for text in texts)
