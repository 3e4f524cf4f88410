"""Flight plans: read by another program's reader, and flown with JSBSim by raw sensors."""

from __future__ import annotations

import json
import math
import os
import subprocess
from pathlib import Path

import fcc
import pytest
from pymavlink import mavwp

from fcc_hil import plan_file, plan_flight
from fcc_hil.__main__ import main
from fcc_hil.lockstep_rig import LockstepRig
from fcc_hil.plan_score import PlanScore
from fcc_hil.plant import Weather

PLANS = Path(__file__).parents[2] / "config/plans"
TWELVE_LEGS = PLANS / "twelve-legs.waypoints"
CIRCUIT = PLANS / "circuit.waypoints"


def _run(fccd: Path, *arguments: str | Path) -> subprocess.CompletedProcess[str]:
    words = [str(fccd), "plan", *map(str, arguments)]
    return subprocess.run(words, capture_output=True, text=True, check=False, timeout=20.0)


def _plan(fccd: Path, *arguments: str | Path) -> str:
    done = _run(fccd, *arguments)
    assert done.returncode == 0, done.stderr
    return done.stdout


def _read_by_pymavlink(path: Path) -> list[tuple[float, ...]]:
    loader = mavwp.MAVWPLoader()
    loader.load(str(path))
    return [
        (
            item.frame,
            item.command,
            item.param1,
            item.param2,
            item.param3,
            item.param4,
            round(item.x, 7),
            round(item.y, 7),
            round(item.z, 2),
        )
        for item in map(loader.wp, range(loader.count()))
    ]


def _hash(fccd: Path, path: Path) -> str:
    return str(json.loads(_plan(fccd, "show", "--json", path))["sha256"])


def test_a_landing_that_is_not_flown_ends_the_command_with_an_error(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """A plan with three landings that were given up, and exit code 0."""
    circling = PlanScore([], [], [], [], lands=True)
    monkeypatch.setattr(plan_flight, "fly", lambda *_: (circling, None))
    assert main(["plan", "--plan", str(CIRCUIT)]) == 1
    assert "the landing was not flown" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("plan", "event", "within_s"),
    [
        # Of 600 m to 55 kt at constant acceleration: 42 s.
        (CIRCUIT, "the take-off is given up: rotate_kt is not reached", 43.0),
        # From 100 kt to 65 kt without power.
        (TWELVE_LEGS, "too little energy: speed is held", 30.0),
    ],
)
def test_an_engine_that_does_not_run_is_an_event(plan: Path, event: str, within_s: float) -> None:
    """Issue: on the runway and in the air, where nothing is configured that watches it."""
    rigs: list[LockstepRig] = []

    def watch(rig: LockstepRig) -> bool:
        if not rigs:
            rigs.append(rig)
            rig.plant.fail_engines()
        return any(event in said.text for said in rig.events)

    plan_flight.fly(plan, plan_flight.PlanConditions(), longest_s=within_s, watch=watch)
    (rig,) = rigs
    assert any(event in said.text for said in rig.events)


def test_a_plan_goes_through_pymavlinks_reader(fccd: Path, tmp_path: Path) -> None:
    """Converted to a .plan and back, its reader finds the same items."""
    there, back = tmp_path / "a.plan", tmp_path / "a.waypoints"
    _plan(fccd, "convert", TWELVE_LEGS, there)
    _plan(fccd, "convert", there, back)
    given = _read_by_pymavlink(TWELVE_LEGS)
    assert len(given) == 13
    assert _read_by_pymavlink(back) == given
    assert _hash(fccd, there) == _hash(fccd, back) == _hash(fccd, TWELVE_LEGS)


def test_what_pymavlink_writes_is_read(fccd: Path, tmp_path: Path) -> None:
    loader = mavwp.MAVWPLoader()
    loader.load(str(TWELVE_LEGS))
    written = tmp_path / "b.waypoints"
    loader.save(str(written))
    items = json.loads(_plan(fccd, "show", "--json", written))["plan"]["items"]
    expected = plan_file.read(TWELVE_LEGS).items
    assert len(items) == len(expected)
    for found, item in zip(items, expected, strict=True):
        place = found["place"]
        assert place["latitude_deg"] == pytest.approx(item.latitude_deg, abs=1e-6)
        assert place["longitude_deg"] == pytest.approx(item.longitude_deg, abs=1e-6)


def test_a_plan_is_commanded_from_python(tmp_path: Path) -> None:
    """The set points of other programs: docs/plan.md; 1,000 m are 0.009 degrees of latitude."""
    plan = tmp_path / "north.waypoints"
    plan.write_text(
        "QGC WPL 110\n0 0 0 16 0 0 0 0 47 8 900 1\n"
        + "".join(f"{n} 0 0 16 0 0 0 0 {47 + 0.1 * n} 8 900 1\n" for n in (1, 2, 3))
    )
    config = f'[guidance]\nmode = "plan"\n[plan]\nfile = "{plan}"\n[built-in]\n'
    aircraft, machine = fcc.BuiltInAircraft(config), fcc.Machine(config)
    surfaces = None

    def fly(seconds: float) -> tuple[str, int]:
        nonlocal surfaces
        for _ in range(round(seconds / machine.period_s)):
            measured = aircraft.step(surfaces, machine.period_s)
            surfaces = machine.step(measured, switch=aircraft.switch, readback=aircraft.controls)
        return machine.setpoints.guidance_mode, machine.setpoints.guidance_item

    assert fly(20.0) == ("plan", 1)
    for orders, then in (
        ({"pause": 1.0}, ("loiter", 0)),
        ({"plan_item": 3.0}, ("plan", 3)),
        ({"heartbeat_s": 60.0}, ("plan", 3)),
        ({"return_home": 1.0}, ("return", 0)),
        ({"plan_item": 0.0, "altimeter_setting_pa": 1e5}, ("plan", 3)),
        (
            {
                "go_to_latitude_rad": math.radians(47.1),
                "go_to_longitude_rad": math.radians(8.0),
                "go_to_altitude_m": 950.0,
            },
            ("go-to", 0),
        ),
    ):
        machine.command(**orders)
        assert fly(0.1) == then
    for wrong, words in (
        ({"plan_item": 4.0}, "plan_item is 4: choose 0 to 3"),
        ({"pause": 1.0, "return_home": 1.0}, "several modes are given"),
        ({"go_to_altitude_m": 950.0}, "a place needs all of"),
        ({"pause": 2.0}, "pause is 2: choose 1 to 1"),
        ({"heartbeat_s": -1.0}, "heartbeat_s is -1: choose 0 to 3600"),
        ({"flaps": 1.0}, "there is no set point 'flaps'"),
        ({}, "no set point is given"),
    ):
        with pytest.raises(ValueError, match=words):
            machine.command(**wrong)


def test_legs_are_flown_by_raw_sensors_in_20_kt(tmp_path: Path) -> None:
    """Issue: cross-track RMS at most 10 m, altitude within 15 ft on level legs."""
    plan = tmp_path / "legs.waypoints"
    # Home and 6 items: turns of 30 to 120 degrees; the leg to the fifth climbs.
    plan.write_text("".join(TWELVE_LEGS.read_text().splitlines(keepends=True)[:8]))
    weather = Weather(wind_kt=20.0, wind_from_deg=90.0)
    score, flown = plan_flight.fly(plan, plan_flight.PlanConditions(weather=weather, seed=3))
    assert [waypoint.item for waypoint in score.waypoints if waypoint.passed] == [1, 2, 3, 4, 5, 6]
    assert [leg.item for leg in score.legs] == [2, 3, 4, 5, 6]
    for leg in score.legs:
        assert leg.cross_track_rms_m <= 10.0, leg
        assert leg.airspeed_error_kt <= 2.0, leg
        if leg.item != 5:
            assert leg.altitude_max_ft <= 15.0, leg
    # The fly-over waypoint within its radius of 60 m.
    assert score.waypoints[4].closest_m <= 60.0
    assert math.degrees(abs(flown.roll_rad).max()) < 35.0


def test_a_file_that_is_none_does_not_hide_the_others(fccd: Path, tmp_path: Path) -> None:
    """A pipe without a writer is not waited for."""
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    missing = tmp_path / "missing.plan"
    done = _run(fccd, "check", "--json", pipe, CIRCUIT, missing)
    assert done.returncode == 2
    results = json.loads(done.stdout)
    assert [result["ok"] for result in results] == [False, True, False]
    assert "no file" in results[0]["problems"][0]["message"]
    assert "cannot be read" in results[2]["problems"][0]["message"]
