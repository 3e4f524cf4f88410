"""A flight by raw sensors without an airspeed sensor, by what another flight has learned."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from fcc_hil.raw_flight import fly, read_learned, write_learned
from fcc_hil.rig import FlightError

SEED = int(os.environ.get("FCC_FIRST_SEED", "33"))
FLIGHTS = int(os.environ.get("FCC_NAVIGATION", "1"))
LEGS = 3
LEARNED = {
    "axial_offset": -0.112,
    "full_thrust_ratio": 0.342,
    "zero_lift_angle_deg": -0.77,
    "one_g_angle_deg": 2.269,
}
"""Of JSBSim's c172p, in a flight of the pattern with the sensors of a board and seed 7."""


@pytest.mark.parametrize("seed", range(SEED, SEED + FLIGHTS))
def test_the_pattern_is_flown_without_an_airspeed_sensor(
    seed: int, measured: Callable[[str, object], None]
) -> None:
    flight = fly("board", navigation="kalman", seed=seed, legs=LEGS, airframe=LEARNED)
    error_kt = flight.errors()["airspeed_kt"]
    measured("board, no airspeed sensor, 3 legs: airspeed RMS, kt", f"{error_kt:.2f}")
    arrays = flight.arrays
    flown = arrays["truth_time_s"] > arrays["engaged_s"]
    errors_mps = (arrays["estimate_airspeed_mps"] - arrays["truth_airspeed_mps"])[flown]
    # Beyond 10 % of 100 kt, one standard deviation, it is not flown by.
    assert float(np.sqrt(np.mean(errors_mps**2))) <= 5.1
    assert len(flight.score["legs"]) == LEGS
    # A failsafe would have held wings level while the pattern turned by 90 degrees.
    assert flight.score["worst"]["heading_rms_deg"] <= 10.0
    # Nothing was learned without the sensor.
    assert flight.learned is None


def test_without_what_was_learned_it_does_not_engage() -> None:
    with pytest.raises(FlightError, match="airspeed is missing"):
        fly("board", navigation="kalman", seed=SEED, legs=1, airframe={})


def test_what_was_learned_is_written_and_read(tmp_path: Path) -> None:
    file = tmp_path / "learned.toml"
    write_learned(file, LEARNED)
    assert read_learned(file) == LEARNED
    file.write_text("[autopilot.airframe]\naxial_offset = 0.0\n", encoding="utf-8")
    with pytest.raises(ValueError, match=r"autopilot\.airframe\.full_thrust_ratio is missing"):
        read_learned(file)
    file.write_bytes(b"\xa7\x00")
    with pytest.raises(ValueError, match=r"learned\.toml is no text: give a file that --learned"):
        read_learned(file)
