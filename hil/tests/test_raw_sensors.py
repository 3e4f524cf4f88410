"""Raw sensors on an aircraft of JSBSim, against its truth."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import fcc
import numpy as np
import numpy.typing as npt
import pytest

from fcc_hil import raw_calibration, raw_flight
from fcc_hil.lockstep_rig import Conditions, LockstepRig
from fcc_hil.plant import Plant
from fcc_hil.raw_sensors import FIELD_UT
from fcc_hil.raw_turning import turned_over
from fcc_hil.standin import Settings

FIRST = int(os.environ.get("FCC_FIRST_SEED", "21"))
FLIGHTS = int(os.environ.get("FCC_NAVIGATION", "1"))
EARTH_M = 6_378_137.0

Array = npt.NDArray[np.float64]


@pytest.fixture(scope="module")
def flown() -> raw_flight.Arrays:
    return raw_flight.fly("board", legs=1).arrays


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


@pytest.mark.parametrize("seed", range(FIRST, FIRST + FLIGHTS))
@pytest.mark.parametrize("sensors", ["phone", "board"])
def test_the_pattern_is_flown_by_raw_sensors_alone(
    sensors: str, seed: int, measured: Callable[[str, object], None]
) -> None:
    """Seeds on which no parameter was chosen."""
    flight = raw_flight.fly(sensors, navigation="kalman", seed=seed)
    errors, worst = flight.errors(), flight.score["worst"]
    measured("seed", seed)
    for what, error in errors.items():
        measured(f"{sensors}: {' RMS, '.join(what.split('_'))}", f"{error:.2f}")
    assert len(flight.score["legs"]) == 8
    assert errors["roll_deg"] <= 1.5
    assert errors["pitch_deg"] <= 1.5
    assert errors["heading_deg"] <= 3.0
    # Three standard deviations of the barometer's 2 m.
    assert errors["altitude_ft"] <= 20.0
    assert worst["altitude_settle_s"] is not None
    # As with ideal sensors in this air.
    assert worst["airspeed_error_kt"] <= 15.0


def test_a_calibration_leaves_what_the_sensors_cannot_know() -> None:
    """The drawn biases of a phone are 80 mg and 1 deg/s; calibrated it is aligned to a degree."""
    found = raw_calibration.calibrate("phone", seed=8, field_ut=FIELD_UT)
    again = raw_calibration.calibrate("phone", seed=8, field_ut=FIELD_UT)
    assert np.array_equal(found.accelerometer.bias, again.accelerometer.bias)
    still = fcc.RawTruth(
        roll_rad=0.5,
        specific_force_y_mps2=-9.80665 * np.sin(0.5),
        specific_force_z_mps2=-9.80665 * np.cos(0.5),
        static_pressure_pa=101_325.0,
        air_temperature_k=288.15,
    )
    raw = fcc.RawSensors("phone", still, seed=8, field_ut=FIELD_UT)
    forces = []
    for step in range(1, 200):
        raw.step(_at(still, step * 0.025))
        read = fcc.Measurements()
        raw.read(read)
        found.apply(read)
        if np.isfinite(read.raw_specific_force_x_mps2):
            forces.append([getattr(read, f"raw_specific_force_{axis}_mps2") for axis in "xyz"])
    x, y, z = np.mean(forces, axis=0)
    assert np.arctan2(-y, -z) == pytest.approx(0.5, abs=np.radians(0.5))
    assert np.linalg.norm([x, y, z]) == pytest.approx(9.80665, abs=0.03)


def _at(truth: fcc.RawTruth, time_s: float) -> fcc.RawTruth:
    names = (
        "roll_rad",
        "specific_force_y_mps2",
        "specific_force_z_mps2",
        "static_pressure_pa",
        "air_temperature_k",
    )
    return fcc.RawTruth(time_s=time_s, **{name: getattr(truth, name) for name in names})


def test_ages_say_when_readings_were_taken() -> None:
    machine = fcc.Machine()
    measured = fcc.Measurements(airspeed_mps=50.0, altitude_m=900.0)
    for _ in range(3):
        machine.step(measured, ages_s={"airspeed": 0.1})
    records = machine.records()
    ages_ns = records["woke_ns"] - records["airspeed_taken_ns"]
    assert list(ages_ns) == [100_000_000] * 3
    assert list(records["woke_ns"] - records["altitude_taken_ns"]) == [0] * 3
    with pytest.raises(ValueError, match=r"ages_s: there is no reading 'wind': choose of attitude"):
        machine.step(measured, ages_s={"wind": 0.1})
    with pytest.raises(ValueError, match=r'ages_s\["airspeed"\] is -1: choose 0 to 10'):
        machine.step(measured, ages_s={"airspeed": -1.0})


def test_a_flight_by_raw_sensors_is_replayed_to_the_last_bit(fccd: Path, tmp_path: Path) -> None:
    config = tmp_path / "raw.toml"
    config.write_text(
        '[built-in]\ngusts = "light"\nraw_sensors = "board"\nengage_at_s = 15.0\n'
        '[navigation]\nmethod = "kalman"\n[guidance]\nmode = "timed-pattern"\n'
    )
    words: list[str | Path] = [fccd, "fly", "--lockstep", "--quiet", "--config", config]
    words += ["--seconds", "60", "--recordings", tmp_path / "recordings"]
    subprocess.run(words, capture_output=True, check=True, timeout=60)
    (recording,) = (tmp_path / "recordings").glob("*.mcap")
    # What was flown by differs from what the built-in aircraft's sensors of attitude gave.
    records = fcc.Recording(recording).records
    assert len(records) > 2_600
    assert np.std(records["roll_rad"] - records["estimated_roll_rad"]) > 2e-3
    words = [fccd, "replay", "--json", recording]
    done = subprocess.run(words, capture_output=True, check=True, timeout=60, text=True)
    assert json.loads(done.stdout)["identity"]["differing"] == 0
    page = tmp_path / "page.html"
    words = [fccd, "replay", "--navigation", "--html", page, "--json", recording]
    done = subprocess.run(words, capture_output=True, check=True, timeout=60, text=True)
    (result,) = json.loads(done.stdout)["navigation"]
    (roll,) = (of for of in result["differences"] if of["quantity"] == "roll")
    assert roll["rms_from_flown"] < 0.5
    assert "<svg" in page.read_text("utf-8")


def test_the_built_in_aircraft_engages_in_gusts_by_default(fccd: Path, tmp_path: Path) -> None:
    config = tmp_path / "raw.toml"
    words: list[str | Path] = [fccd, "fly", "--lockstep", "--config", config, "--seconds", "1"]
    words += ["--recordings", tmp_path / "recordings"]
    for seed in range(1, 4):
        config.write_text(
            f'[built-in]\ngusts = "moderate"\nraw_sensors = "phone"\nseed = {seed}\n'
            '[navigation]\nmethod = "kalman"\n'
        )
        done = subprocess.run(words, capture_output=True, check=True, timeout=60, text=True)
        said = done.stdout + done.stderr
        assert "standby -> engaged" in said
        # What no sensor measures, navigation knows.
        assert re.search(r"leg 0 .* alt +\d+→.* (?:[89]\d|1\d\d)→", said)


def test_a_gyroscope_that_is_turned_over_is_calibrated_and_else_refused() -> None:
    """Scale and cross axes of 2 %, the tolerances of the MPU-3050 (PS-MPU-3050A-00)."""
    shape = np.array([[1.02, -0.02, 0.01], [0.02, 0.98, 0.015], [-0.01, -0.02, 1.01]])
    bias = np.array([0.02, -0.01, 0.005])
    motion = [motion for number, motion in enumerate(turned_over(0.0)) if number % 2 == 0]
    times_s = np.array([motion.time_s for motion in motion])
    rates, force = (
        np.array([[getattr(motion, name) for name in names] for motion in motion])
        for names in (
            ("roll_rate_radps", "pitch_rate_radps", "yaw_rate_radps"),
            [f"specific_force_{axis}_mps2" for axis in "xyz"],
        )
    )
    given = rates @ shape.T + bias
    found = fcc.calibrate_gyroscope(gyroscope=(times_s, given), accelerometer=(times_s, force))
    # It is integrated at 100 Hz.
    assert np.array(found["matrix"]) == pytest.approx(np.linalg.inv(shape), abs=1e-4)
    assert found["bias"] == pytest.approx(bias, abs=1e-9)
    assert found["sigma"] < 1e-4
    assert found["residual_rad"] < 1e-4
    early = times_s < 30.0
    with pytest.raises(ValueError, match="ended too early: 0 of 3 are there"):
        fcc.calibrate_gyroscope(
            gyroscope=(times_s[early], given[early]),
            accelerometer=(times_s[early], force[early]),
        )
    with pytest.raises(ValueError, match="mounted in another way than the accelerometer"):
        fcc.calibrate_gyroscope(
            gyroscope=(times_s, given[:, [1, 2, 0]]), accelerometer=(times_s, force)
        )
    with pytest.raises(TypeError):
        fcc.calibrate_gyroscope(gyroscope=(times_s, given))  # type: ignore[call-arg]


def test_calibrate_refuses_with_the_reason() -> None:
    with pytest.raises(ValueError, match="too few samples: take at least 12"):
        fcc.calibrate(np.eye(3), 9.81)
    with pytest.raises(ValueError, match=r"samples is of shape \(3,\): give \(n, 3\)"):
        fcc.calibrate([1.0, 2.0, 3.0], 9.81)
    with pytest.raises(ValueError, match="strength is -1"):
        fcc.calibrate(np.eye(3), -1.0)


def test_calibrate_names_an_outlier_and_another_unit() -> None:
    drawn = np.random.default_rng(1).normal(size=(40, 3))
    samples = 9.80665 * drawn / np.linalg.norm(drawn, axis=1)[:, None]
    assert fcc.calibrate(samples, 9.80665)["residual"] < 1e-6
    in_g = samples / 9.80665
    with pytest.raises(ValueError, match=r"a strength of about 1\.000, and 9\.80665 was given"):
        fcc.calibrate(in_g, 9.80665)
    samples[7] *= 3.0
    with pytest.raises(ValueError, match="sample 7, counted from 0, contradicts the others"):
        fcc.calibrate(samples, 9.80665)


def test_calibrate_gives_the_matrix_of_what_it_says() -> None:
    drawn = np.random.default_rng(1).normal(size=(60, 3))
    force = 9.80665 * drawn / np.linalg.norm(drawn, axis=1)[:, None]
    bias, gain = np.array([0.1, -0.2, 0.3]), np.diag([1.02, 0.97, 1.01])
    found = fcc.calibrate(force @ gain + bias, 9.80665)
    assert np.asarray(found["matrix"]) == pytest.approx(np.linalg.inv(gain), abs=1e-6)
    assert found["bias"] == pytest.approx(bias, abs=1e-6)


def test_a_mounting_is_levelled_and_its_dip_made_constant() -> None:
    # A shelf that rises by 5 deg forward, and the rotation about y of any textbook.
    sin, cos = np.sin(np.radians(5.0)), np.cos(np.radians(5.0))
    about_y = np.array([[cos, 0.0, sin], [0.0, 1.0, 0.0], [-sin, 0.0, cos]])
    assert np.array(fcc.levelled([9.81 * sin, 0.0, -9.81 * cos])) == pytest.approx(about_y)
    with pytest.raises(ValueError, match="does not point up"):
        fcc.levelled([0.0, 0.0, 9.81])
    # Rotations: a determinant of 1.
    turns = np.linalg.qr(np.random.default_rng(2).normal(size=(40, 3, 3)))[0]
    turns *= np.linalg.det(turns)[:, None, None]
    down, field = turns @ [0.0, 0.0, 1.0], turns @ [21.0, 0.0, 45.0]
    found = np.array(fcc.constant_dip(down, field @ about_y))
    assert found == pytest.approx(about_y, abs=1e-6)
    # A sensor whose x axis points right; then 30 deg nose up.
    right = fcc.level_and_nose_up([0.0, 0.0, -9.81], [0.0, -9.81 * 0.5, -9.81 * 0.75**0.5])
    assert np.array(right) == pytest.approx(
        np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    )
    with pytest.raises(ValueError, match="are parallel"):
        fcc.level_and_nose_up([0.0, 0.0, -9.81], [0.0, 0.0, -9.7])
    with pytest.raises(ValueError, match="down has 40 rows, and field has 39"):
        fcc.constant_dip(down, field[1:])
    with pytest.raises(ValueError, match="give 12 attitudes or more"):
        fcc.constant_dip(down[:3], field[:3])


def test_what_no_aircraft_can_have_is_refused_with_the_range() -> None:
    air = {"static_pressure_pa": 101_325.0, "air_temperature_k": 288.15}
    start = fcc.RawTruth(**air)
    fcc.RawSensors("phone", start, seed=2**64 - 1, field_ut=[21.1, 0.0, 45.3])
    for changes, message in (
        ({"roll_rad": float("nan")}, "roll_rad is NaN: choose -3.14"),
        ({"time_s": 1e12}, "time_s is .*: choose 0 to 10000000"),
        ({"static_pressure_pa": -1.0}, "static_pressure_pa is -1: choose 5000 to 110000"),
        ({"differential_pressure_pa": -1e6}, "differential_pressure_pa is .*: choose -10000 to"),
        ({"north_mps": 1e300}, "north_mps is .*: choose -450 to 450"),
        ({"position_altitude_m": 1e6}, "position_altitude_m is .*: choose -500 to 20000"),
    ):
        with pytest.raises(ValueError, match=message):
            fcc.RawSensors("phone", fcc.RawTruth(**{**air, **changes}))
    for seed in (-1, 2**64):
        with pytest.raises(ValueError, match=rf"seed is {seed}: choose a whole number, 0 to 1844"):
            fcc.RawSensors("phone", start, seed=seed)
    with pytest.raises(TypeError, match=r"seed is 1\.5: choose a whole number"):
        fcc.RawSensors("phone", start, seed=1.5)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match=r"field_ut\[2\] is .*: choose -800 to 800"):
        fcc.RawSensors("phone", start, field_ut=[0.0, 0.0, 1e308])
    with pytest.raises(ValueError, match=r"field_ut is of shape \(2,\): give \(3,\)"):
        fcc.RawSensors("phone", start, field_ut=[0.0, 0.0])


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--seed", "-1"], "give a whole number from 0 to 4294967295"),
        (["--seed", str(2**70)], "give a whole number from 0 to 4294967295"),
        (["--out", "."], "'.' is a folder: give a file"),
        (["--out", "file/raw.npz"], "there is no folder 'file': create it"),
        (["--json", "file/raw.json"], "there is no folder 'file': create it"),
    ],
)
def test_what_cannot_be_flown_or_written_is_refused_before_the_flight(
    words: list[str], message: str, tmp_path: Path
) -> None:
    (tmp_path / "file").touch()
    refused = subprocess.run(
        [sys.executable, "-m", "fcc_hil", "raw", *words],
        capture_output=True,
        check=False,
        cwd=tmp_path,
        text=True,
        timeout=30,
    )
    assert refused.returncode == 2
    assert message in refused.stderr
    assert "Traceback" not in refused.stderr


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
