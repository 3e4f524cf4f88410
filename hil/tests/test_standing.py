"""The simulated aircraft on its wheels."""

from __future__ import annotations

import math

import pytest

from fcc_hil.plant import Plant, Weather


@pytest.mark.parametrize("kt", [4.0, 8.0, 15.0])
@pytest.mark.parametrize("from_deg", [90.0, 270.0])
def test_it_stands_in_wind_exactly_from_the_side(kt: float, from_deg: float) -> None:
    """JSBSim's c172p turned over within 7 s in 8 kt from 270 degrees.

    Its pitch on the wheels is 2.4 degrees.
    """
    weather = Weather(wind_kt=kt, wind_from_deg=from_deg)
    plant = Plant("c172p", weather=weather, heading_deg=0.0, runway_elevation_ft=394.0)
    for _ in range(200):
        plant.step(12)
        state = plant.state()
        assert abs(math.degrees(state.pitch_rad) - 2.4) < 2.0
        assert abs(math.degrees(state.roll_rad)) < 2.0
