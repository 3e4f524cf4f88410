"""Readings of all sensors that are old when they are used, against JSBSim's truth."""

from __future__ import annotations

import math
import re
from dataclasses import replace

import fcc
import numpy as np
import pytest

from fcc_hil.aircraft import by_name
from fcc_hil.lockstep import measurements
from fcc_hil.noise import SensorNoise
from fcc_hil.plant import Plant
from fcc_hil.state import Controls

_SENSORS = ("attitude", "heading", "body_rates", "specific_force", "airspeed", "altitude")
_HZ = 40


@pytest.mark.parametrize("seed", [1, 2, 3, 2012])
@pytest.mark.parametrize(("interval_ms", "most_degps"), [(250, 8.0), (500, 5.0)])
def test_readings_of_all_sensors_at_long_intervals_are_flown(
    interval_ms: int, most_degps: float, seed: int
) -> None:
    """At 73 kt, a turn by 60 degrees and a climb; 250 ms had 25 degrees per second before."""
    plant = Plant(replace(by_name("c172p"), airspeed_kt=73.0), seed=seed)
    machine = fcc.Machine('[guidance]\nmode = "hold"\n[failsafe]\nsensor_max_age_ms = 600\n')
    noise = SensorNoise(seed)
    pitch_degps: list[float] = []
    for tick in range(42 * _HZ):
        state = plant.state()
        stand = plant.controls
        if tick == 17 * _HZ:
            machine.command(
                heading_rad=(state.heading_rad + math.radians(60.0)) % math.tau,
                altitude_m=state.altitude_m + 60.0,
            )
        surfaces = machine.step(
            measurements(noise.apply(state)),
            missing=() if tick % (interval_ms * _HZ // 1000) == 0 else _SENSORS,
            readback=(stand.throttle, stand.elevator, stand.aileron, stand.rudder),
            switch=tick > 2 * _HZ,
        )
        if surfaces is not None:
            plant.write(
                Controls(
                    elevator=surfaces.elevator,
                    aileron=surfaces.aileron,
                    rudder=surfaces.rudder,
                    throttle=surfaces.throttle,
                )
            )
        plant.step(3)
        if tick > 17 * _HZ:
            pitch_degps.append(math.degrees(state.pitch_rate_radps))
            assert 0.3 < -state.specific_force_z_mps2 / 9.80665 < 2.0
            assert abs(math.degrees(state.roll_rad)) < 35.0
    assert machine.holds_control
    assert np.std(pitch_degps) < most_degps


@pytest.mark.parametrize(("rate_hz", "age_ms", "most_ms"), [(40, 601, 600), (20, 251, 250)])
def test_an_age_that_cannot_be_flown_is_refused(rate_hz: int, age_ms: int, most_ms: int) -> None:
    text = "[loop]\nrate_hz = {}\n[failsafe]\nsensor_max_age_ms = {}\n"
    message = f"is {age_ms}: choose at most {most_ms}: "
    with pytest.raises(ValueError, match=re.escape(message) + f".*loop.rate_hz = {rate_hz}"):
        fcc.Config(text.format(rate_hz, age_ms))
    fcc.Config(text.format(rate_hz, most_ms))
