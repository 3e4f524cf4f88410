"""Whole flights of the built-in aircraft in one call, and Python in the loop."""

from __future__ import annotations

import threading
import time
import warnings
from pathlib import Path

import fcc
import numpy as np
import pytest

FOOT_M = 0.3048
CONFIGS = Path(__file__).parents[2] / "config"
SLOWEST_TIMES_REAL_TIME = 100.0
"""It is some thousands; a machine that does much else must not fail this."""


def test_the_timed_pattern_is_flown_and_scored() -> None:
    flight = fcc.fly()
    assert flight.state == "engaged"
    # The switch goes on at 2 s and counts a tick later; then a hold of 20 s and 8 legs of 20 s.
    assert flight.seconds == pytest.approx(182.0, abs=0.05)
    assert len(flight.records) == len(flight.truth) == 7_281
    assert flight.score is not None
    assert len(flight.score["legs"]) == 8
    # The pattern's own criteria in shared terms: turned within 20 s, climbed within it.
    assert flight.score["worst"]["heading_settle_s"] < 20.0
    assert flight.score["worst"]["altitude_settle_s"] < 20.0
    turned = np.unwrap(flight.truth["heading_rad"])
    assert np.degrees(turned[-1] - turned[0]) == pytest.approx(8 * 90.0, abs=4.0)
    assert np.ptp(flight.truth["altitude_m"]) == pytest.approx(150 * FOOT_M, abs=6.0)
    assert flight.times_real_time > SLOWEST_TIMES_REAL_TIME
    assert flight.timing["ticks"] == 7_281
    modes = [event.text for event in flight.events if event.kind == "mode-changed"]
    assert modes == ["mode: timed-pattern, was none"]


def test_every_direction_is_in_one_turn() -> None:
    """Eight turns of 90° are two full ones; the columns are those that name a heading in rad."""
    records = fcc.fly().records
    names = [name for name in records.dtype.names or () if name.endswith("heading_rad")]
    assert len(names) >= 4, names
    for name in names:
        assert np.all((records[name] >= 0.0) & (records[name] < 2.0 * np.pi)), name
    off = records["estimated_heading_rad"] - records["heading_rad"]
    engaged = records["state"] == fcc.STATES.index("engaged")
    # By the shorter way at north.
    assert np.degrees(np.abs(np.angle(np.exp(1j * off[engaged])))).max() < 5.0
    assert np.degrees(np.median(np.abs(off[engaged]))) < 1.0


def test_the_same_seed_flies_the_same_flight_to_the_last_bit() -> None:
    rough = fcc.Config().replace({"built-in.gusts": "severe", "built-in.seed": 7})
    one, same = fcc.fly(rough, seconds=20.0), fcc.fly(rough, seconds=20.0)
    assert one.records.tobytes() == same.records.tobytes()
    assert one.truth.tobytes() == same.truth.tobytes()
    other = fcc.fly(rough.replace({"built-in.seed": 8}), seconds=20.0)
    assert one.truth.tobytes() != other.truth.tobytes()


def test_the_gil_is_released() -> None:
    """Another thread counts on while a flight of half an hour is flown."""
    over = threading.Event()
    counted = 0

    def fly() -> None:
        fcc.fly(seconds=2_000.0, keep=False)
        over.set()

    thread = threading.Thread(target=fly)
    thread.start()
    while not over.is_set() and counted < 100:
        counted += 1
        time.sleep(0.001)
    assert counted >= 20
    thread.join()


def test_a_controller_in_python_flies_with_a_warning() -> None:
    asked = []

    def controller(
        time_s: float,
        measurements: fcc.Measurements,
        setpoints: fcc.Setpoints,
        surfaces: fcc.Surfaces,
    ) -> fcc.Surfaces:
        asked.append(time_s)
        assert measurements.airspeed_mps > 0.0
        assert setpoints.altitude_m > 0.0
        return surfaces

    with pytest.warns(RuntimeWarning, match="not real time"):
        guided = fcc.fly(seconds=20.0, controller=controller)
    # It proposes what the autopilot does, so nothing is changed.
    assert guided.records.tobytes() == fcc.fly(seconds=20.0).records.tobytes()
    assert len(asked) == np.count_nonzero(guided.records["state"] == 1)


def test_a_sensor_in_python_breaks_another() -> None:
    def freeze(time_s: float, measurements: fcc.Measurements) -> fcc.Measurements | None:
        if time_s < 10.0:
            return None
        measurements.altitude_m = float("nan")
        return measurements

    with pytest.warns(RuntimeWarning):
        flight = fcc.fly(seconds=12.0, sensor=freeze)
    failures = [event.text for event in flight.events if "-> failsafe" in event.text]
    assert len(failures) == 1
    assert "altitude is missing or too old" in failures[0]
    failed = flight.records["state"] == 2
    failed_at_s = flight.records["plant_time_s"][np.argmax(failed)]
    assert failed_at_s == pytest.approx(10.25, abs=0.06)


def test_an_exception_in_the_loop_is_raised() -> None:
    def sensor(time_s: float, measurements: fcc.Measurements) -> None:
        del measurements
        if time_s > 1.0:
            raise KeyError("broken")

    def controller(*_: object) -> int:
        return 3

    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)
        with pytest.raises(KeyError, match="broken"):
            fcc.fly(sensor=sensor)
        with pytest.raises(TypeError, match="Surfaces"):
            fcc.fly(controller=controller)  # type: ignore[arg-type]


def test_a_flight_that_ends_on_the_ground_says_how() -> None:
    """Held in a spin: some 10,000 ft/min (FAA-H-8083-3C, chapter 5: 500 ft in a turn of 3 s)."""

    def pro_spin(*_: object) -> fcc.Surfaces:
        return fcc.Surfaces(elevator=1.0, rudder=1.0)

    low = fcc.Config().replace({"built-in.altitude_ft": 4000.0, "built-in.ground_ft": 1000.0})
    with pytest.warns(RuntimeWarning, match="not real time"):
        flight = fcc.fly(low, controller=pro_spin)
    assert flight.state == "stopped"
    assert flight.ending.startswith("the aircraft hit the ground")
    assert flight.impact is not None
    assert flight.impact["altitude_ft"] == pytest.approx(1000.0, abs=2.0)
    assert 6_000.0 < flight.impact["sink_rate_fpm"] < 12_000.0
    assert flight.impact["pitch_deg"] < -30.0
    assert flight.events[-1].time_s == pytest.approx(flight.impact["time_s"], abs=0.1)
    turned = np.ptp(np.unwrap(flight.truth["heading_rad"])) / (2.0 * np.pi)
    assert turned > 3.0
    assert fcc.fly(seconds=1.0).impact is None


@pytest.mark.parametrize("seed", [2, 13])
def test_severe_gusts_are_survived(seed: int) -> None:
    """The two worst of the seeds 1 to 20; before, four of the first five fell to the ground."""
    flight = fcc.fly(fcc.Config().replace({"built-in.gusts": "severe", "built-in.seed": seed}))
    assert flight.state == "engaged"
    assert flight.impact is None
    assert np.min(flight.truth["altitude_m"]) > 2_200.0 * FOOT_M
    stalled = flight.truth["angle_of_attack_rad"] > np.radians(17.2)
    assert np.count_nonzero(stalled) < 10


def test_in_real_time_time_passes() -> None:
    fast = fcc.Config().replace({"built-in.engage_at_s": 1.2, "loop.rate_hz": 100.0})
    began_s = time.monotonic()
    flight = fcc.fly(fast, seconds=0.3, real_time=True)
    assert time.monotonic() - began_s >= 1.4
    assert flight.timing["timer"] == "timerfd"
    assert flight.timing["ticks"] + flight.timing["missed"] >= 150


def test_a_plan_by_replace_is_flown_as_one_of_a_text() -> None:
    """The circuit's home is 45 N, 8 E, 120 m, in line 0 of its file."""
    plan = {"guidance.mode": "plan", "plan.file": str(CONFIGS / "plans/circuit.waypoints")}
    config = fcc.Config.load(CONFIGS / "built-in.toml").replace(plan)
    assert (config["built-in.latitude_deg"], config["built-in.longitude_deg"]) == (45.0, 8.0)
    assert config["built-in.ground_ft"] == pytest.approx(120.0 / FOOT_M)
    flight = fcc.fly(config)
    modes = [event.text for event in flight.events if event.kind == "mode-changed"]
    assert modes[0] == "mode: take-off, was none"
    assert "mode: land, was plan" in modes
    # It ends itself when the aircraft stands, 683 s after the begin.
    assert 600.0 < flight.seconds < 800.0


def test_another_plan_by_replace_brings_its_own_begin(tmp_path: Path) -> None:
    other = tmp_path / "other.waypoints"
    lines = (CONFIGS / "plans/circuit.waypoints").read_text()
    other.write_text(lines.replace("\t45.", "\t46."))
    plan = f'[guidance]\nmode = "plan"\n[plan]\nfile = "{CONFIGS}/plans/circuit.waypoints"\n'
    first = fcc.Config(plan)
    assert first["built-in.latitude_deg"] == 45.0
    assert first.replace({"plan.file": str(other)})["built-in.latitude_deg"] == 46.0
    with pytest.raises(fcc.ConfigError, match=r"plan\.file: .*cannot be read"):
        first.replace({"plan.file": "no-such.plan"})


def test_a_flight_that_never_engages_raises_the_reason() -> None:
    def blind(time_s: float, measurements: fcc.Measurements) -> fcc.Measurements:
        del time_s
        measurements.altitude_m = float("nan")
        return measurements

    with (
        pytest.warns(RuntimeWarning, match="not real time"),
        pytest.raises(fcc.EngageError, match=r"not engaged: .*altitude is missing or too old"),
    ):
        fcc.fly(seconds=1.0, sensor=blind)


def test_x_planes_aircraft_is_refused() -> None:
    x_plane = "[x-plane]\n"
    with pytest.raises(fcc.FlightError, match="x-plane"):
        fcc.fly(x_plane)
    with pytest.raises(fcc.FlightError, match="x-plane"):
        fcc.BuiltInAircraft(x_plane)
