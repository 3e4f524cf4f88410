"""Raw sensors on an aircraft of JSBSim, against its truth."""

from __future__ import annotations

from pathlib import Path

import fcc
import numpy as np
import numpy.typing as npt
import pytest

from fcc_hil import raw_flight
from fcc_hil.lockstep_rig import Conditions, LockstepRig
from fcc_hil.plant import Plant
from fcc_hil.standin import Settings

EARTH_M = 6_378_137.0

Array = npt.NDArray[np.float64]


@pytest.fixture(scope="module")
def flown() -> raw_flight.Arrays:
    return raw_flight.fly("board", legs=1)


def _truth(flown: raw_flight.Arrays, sensor: str, *names: str) -> Array:
    """Return what was true when a sensor's readings were taken, as far as its delay is known."""
    taken_s = flown[f"{sensor}_t_s"] - flown[f"{sensor}_delay_s"]
    columns = [np.interp(taken_s, flown["truth_time_s"], flown[f"truth_{n}"]) for n in names]
    return np.stack(columns, axis=-1)


def test_fixes_are_those_of_120_ms_before(flown: raw_flight.Arrays) -> None:
    fixes = flown["gnss_rad_m_mps"]
    assert np.diff(flown["gnss_t_s"]) == pytest.approx(0.2, abs=1e-6)
    errors = fixes[:, 3:] - _truth(flown, "gnss", "north_mps", "east_mps", "down_mps")
    # 870 values: 0.1 m/s within 4 standard deviations of the estimate.
    assert np.std(errors) == pytest.approx(0.1, rel=4.0 / np.sqrt(2.0 * errors.size))
    north_m = (fixes[:, 0] - _truth(flown, "gnss", "latitude_rad")[:, 0]) * EARTH_M
    up_m = fixes[:, 2] - _truth(flown, "gnss", "elevation_m")[:, 0]
    for error_m in (north_m, up_m):
        assert np.max(np.abs(error_m)) < 5.0 * np.hypot(0.5, 1.5)
        # At 50 m/s an error of 20 ms in the delay would be 1 m more in each turn.
        white_m = np.std(np.diff(error_m)) / np.sqrt(2.0)
        assert white_m == pytest.approx(0.5, rel=4.0 / np.sqrt(error_m.size))


def test_axes_and_signs_are_the_aircrafts(flown: raw_flight.Arrays) -> None:
    rates = _truth(flown, "gyroscope", "roll_rate_radps", "pitch_rate_radps", "yaw_rate_radps")
    measured = flown["gyroscope_radps"]
    for axis in range(3):
        slope, _ = np.polyfit(rates[:, axis], measured[:, axis], 1)
        assert slope == pytest.approx(1.0, abs=0.1), axis
    # A coordinated flight: the force is along -z, 1 g on average and more.
    force = np.mean(flown["accelerometer_mps2"], axis=0)
    assert force[2] == pytest.approx(-9.9, abs=0.8)
    assert abs(force[1]) < 1.0
    assert np.linalg.norm(flown["magnetometer_ut"], axis=1) == pytest.approx(50.0, abs=5.0)
    # The first seconds are level, to the north: the field is forward and down.
    first = np.mean(flown["magnetometer_ut"][:400], axis=0)
    assert first == pytest.approx(flown["field_ut"], abs=6.0)


def test_pressures_give_altitude_and_airspeed(flown: raw_flight.Arrays) -> None:
    altitudes_m = fcc.pressure_altitude_m(flown["static_pressure_pa"])
    error_m = altitudes_m - _truth(flown, "static_pressure", "altitude_m")[:, 0]
    assert np.std(np.diff(error_m)) / np.sqrt(2.0) == pytest.approx(0.3, rel=0.15)
    assert abs(np.mean(error_m)) < 8.0
    airspeed_mps = _truth(flown, "differential_pressure", "airspeed_mps")[:, 0]
    # At 100 kt compressibility is 0.6 % of 1/2 rho v^2.
    expected_pa = 0.5 * 1.225 * airspeed_mps**2 * 1.006
    error_pa = flown["differential_pressure_pa"] - expected_pa
    assert abs(np.mean(error_pa)) < 25.0
    assert np.std(error_pa) < 15.0


def test_the_same_seed_gives_the_same_readings(tmp_path: Path) -> None:
    rigs = [
        LockstepRig(
            Settings(aircraft="c172p", seed=seed),
            Plant("c172p", seed=1),
            fcc.Machine(),
            Conditions(raw_sensors="phone"),
        )
        for seed in (5, 5, 6)
    ]
    for rig in rigs:
        rig.fly_to(rig.time_s + 1.0)
    one, same, other = (rig.raw.readings for rig in rigs if rig.raw is not None)
    assert one == same
    assert one != other
    # They are in the record of each tick, and in the file.
    path = rigs[0].save_recording(tmp_path / "raw.mcap")[0]
    records = fcc.Recording(path).records
    assert records["raw_roll_rate_radps"][-1] == one["raw_body_rates"][-1][1]
    assert records["gnss_latitude_rad"][-1] == one["gnss"][-1][1]
    assert len(np.unique(records["gnss_taken_ns"])) in {len(one["gnss"]), len(one["gnss"]) + 1}
