"""Take-off and landing with JSBSim, by raw sensors, from its truth."""

from __future__ import annotations

import json
import math
import os
import subprocess
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import fcc
import pytest

from fcc_hil import plan_flight
from fcc_hil.configurations import configuration, without_section
from fcc_hil.plan_flight import PlanConditions
from fcc_hil.plan_score import LandingScore, PlanScore, TakeoffScore
from fcc_hil.plant import Weather

CIRCUIT = Path(__file__).parents[2] / "config/plans/circuit.waypoints"
"""To the north."""
SEEDS = int(os.environ.get("FCC_LANDINGS", "1"))
FIRST = int(os.environ.get("FCC_FIRST_SEED", "201"))
BESIDE = int(os.environ.get("FCC_LANDINGS_BESIDE", "0"))
"""Of other aircraft, and without a precise receiver and a range finder."""
WINDS = {
    "calm": (0.0, 0.0),
    "8 kt across from the left": (8.0, 270.0),
    "8 kt across from the right": (8.0, 90.0),
    "10 kt head": (10.0, 0.0),
    "5 kt tail": (5.0, 180.0),
}
FLOWN = WINDS if SEEDS > 1 else ["8 kt across from the right"]
HALF_RUNWAY_M = 15.0
GROUND_ROLL_M = 890.0 * 0.3048
"""At sea level without wind: handbook of the 172P (1981), section 5."""


PRECISE = PlanConditions(sensors="board-rtk")
PLAIN = PlanConditions(sensors="board", without=frozenset({"range"}))
CUBS_SPEEDS = {" 178 0 46 ": " 178 0 33 ", " 178 0 41 ": " 178 0 30 "}
"""65 and 58 kt, in place of 89 and 80 kt."""


def _fly(wind: str, seed: int, conditions: PlanConditions, plan: Path = CIRCUIT) -> PlanScore:
    speed_kt, from_deg = WINDS[wind]
    weather = Weather(wind_kt=speed_kt, wind_from_deg=from_deg, turbulence_severity=2)
    return plan_flight.fly(plan, replace(conditions, weather=weather, seed=seed))[0]


Measured = Callable[[str, object], None]


def _keep(measured: Measured, what: str, seed: int, score: PlanScore) -> None:
    takeoff, landing = score.takeoff, score.landing
    measured("seed", seed)
    is_good = takeoff is not None and landing is not None and _is_good(takeoff, landing)
    measured(f"{what}: good", is_good)
    measured("all: good", is_good)
    if takeoff is not None:
        measured(f"{what}: take-off run, m", f"{takeoff.run_m:.0f}")
    if landing is not None:
        measured(f"{what}: touchdown, ft/min", f"{landing.sink_fpm:.0f}")
        measured(f"{what}: off the centre line, m", f"{abs(landing.centre_line_m):.1f}")


def _is_good(takeoff: TakeoffScore, landing: LandingScore) -> bool:
    return (
        max(takeoff.centre_line_m, abs(landing.centre_line_m)) <= 5.0
        and landing.sink_fpm <= 200.0
        and max(abs(takeoff.heading_error_deg), abs(landing.heading_error_deg)) <= 5.0
    )


@pytest.mark.parametrize("wind", FLOWN)
def test_take_off_circuit_and_landing(wind: str, measured: Measured) -> None:
    """Issue: all on 30 m of runway, below 400 ft/min; 90 % on its middle, slower and straight."""
    good = 0
    for seed in range(FIRST, FIRST + SEEDS):
        score = _fly(wind, seed, PRECISE)
        takeoff, landing = score.takeoff, score.landing
        print(f"\n{wind}, seed {seed}: {takeoff}, {landing}")
        _keep(measured, wind, seed, score)
        assert takeoff is not None
        assert landing is not None
        assert takeoff.centre_line_m < HALF_RUNWAY_M
        assert max(abs(landing.centre_line_m), landing.roll_out_m) < HALF_RUNWAY_M
        assert landing.sink_fpm < 400.0
        # Half as long again: 5 kt from behind, and a brisk hand on the throttle.
        assert takeoff.run_m < 1.5 * GROUND_ROLL_M
        assert all(waypoint.passed for waypoint in score.waypoints)
        good += _is_good(takeoff, landing)
    assert good >= 0.9 * SEEDS


def _on_the_runway(wind: str, seed: int, score: PlanScore) -> LandingScore:
    takeoff, landing = score.takeoff, score.landing
    print(f"\n{wind}, seed {seed}: {takeoff}, {landing}")
    assert takeoff is not None
    assert landing is not None
    print("good" if _is_good(takeoff, landing) else "not good")
    assert takeoff.centre_line_m < HALF_RUNWAY_M
    assert max(abs(landing.centre_line_m), landing.roll_out_m) < HALF_RUNWAY_M
    return landing


def _with_speeds_of(aircraft: str, tmp_path: Path) -> tuple[PlanConditions, Path]:
    """Return its configuration, and the circuit at its speeds."""
    text = configuration(aircraft)
    for section in ("guidance", "x-plane"):
        text = without_section(text, section)
    circuit = CIRCUIT.read_text()
    for of_cessna, of_cub in CUBS_SPEEDS.items() if aircraft == "J3Cub" else ():
        circuit = circuit.replace(of_cessna.replace(" ", "\t"), of_cub.replace(" ", "\t"))
    plan = tmp_path / f"{aircraft}.waypoints"
    plan.write_text(circuit)
    return replace(PRECISE, aircraft=aircraft, config=text), plan


@pytest.mark.parametrize("seed", range(FIRST, FIRST + BESIDE))
@pytest.mark.parametrize(
    ("aircraft", "wind"),
    [
        *(("c172r", wind) for wind in WINDS),
        *(("J3Cub", wind) for wind in ("calm", "10 kt head")),
    ],
)
def test_other_aircraft_land(
    aircraft: str, wind: str, seed: int, tmp_path: Path, measured: Measured
) -> None:
    """Issue: with the same gains and their speeds; on 30 m of runway, below 400 ft/min.

    JSBSim's J3Cub tips over where it stands, its brakes set, in 8 kt across; in 5 kt from behind
    it does not take off.
    """
    conditions, plan = _with_speeds_of(aircraft, tmp_path)
    score = _fly(wind, seed, conditions, plan)
    _keep(measured, f"{aircraft}, {wind}", seed, score)
    assert _on_the_runway(wind, seed, score).sink_fpm < 400.0


@pytest.mark.parametrize("seed", range(FIRST, FIRST + BESIDE))
@pytest.mark.parametrize("wind", WINDS)
def test_by_a_plain_receiver_without_a_range_finder(
    wind: str, seed: int, measured: Measured
) -> None:
    """Issue: on 30 m of runway, below 300 ft/min."""
    score = _fly(wind, seed, PLAIN)
    _keep(measured, f"c172p, plain receiver, no range finder, {wind}", seed, score)
    assert _on_the_runway(wind, seed, score).sink_fpm < 300.0


@pytest.mark.parametrize("off_ft", [-30.0, 30.0])
def test_without_a_range_finder_by_an_altimeter_that_is_off(off_ft: float) -> None:
    """Issue: below 300 ft/min. Near sea level 30 ft are 109 Pa (ICAO 7488: 12.0 Pa a metre)."""

    def misread(raw: fcc.Measurements, _time_s: float) -> None:
        if math.isfinite(raw.static_pressure_pa):
            raw.static_pressure_pa -= 109.0 * off_ft / 30.0

    conditions = replace(PLAIN, raw_fault=misread)
    landing = _on_the_runway("calm", FIRST, _fly("calm", FIRST, conditions))
    assert landing.sink_fpm < 300.0


def test_a_flight_ends_when_its_plan_has_landed(fccd: Path, tmp_path: Path) -> None:
    """With `--seconds` it does not, and has not flown the plan: exit code 19."""
    words: list[str | Path] = [fccd, "fly", "--lockstep", "--json", "--quiet", "--no-recording"]
    words += ["--plan", CIRCUIT]
    for more, code, ending in (
        ([], 0, "the plan is flown to its end"),
        (["--seconds", "60"], 19, "the time to fly is over, and the plan is not flown to its end"),
    ):
        done = subprocess.run(
            [*words, *more], cwd=tmp_path, capture_output=True, text=True, check=False
        )
        assert done.returncode == code, done.stderr
        assert json.loads(done.stdout)["ending"].startswith(ending)


def test_the_waypoint_before_a_straight_approach_is_no_landing(fccd: Path, tmp_path: Path) -> None:
    """In line with the runway it was reached as the landing began, and ended the flight there."""
    plan = tmp_path / "straight.waypoints"
    plan.write_text(
        "QGC WPL 110\n"
        "0 1 0 16 0 0 0 0 45.0 8.0 0 1\n"
        "1 0 3 16 0 0 0 0 44.92 8.0 250 1\n"
        "2 0 3 16 0 0 0 0 44.946 8.0 250 1\n"
        "3 0 3 21 200 0 0 0 45.0 8.0 0 1\n"
    )
    words: list[str | Path] = [fccd, "fly", "--lockstep", "--json", "--quiet", "--plan", plan]
    words += ["--recordings", tmp_path]
    done = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True, check=True)
    assert json.loads(done.stdout)["ending"] == "the plan is flown to its end"
    (recording,) = tmp_path.glob("*.mcap")
    last = fcc.Recording(recording).records[-1]
    assert last["weight_on_wheels"] == 1.0
    assert math.hypot(last["north_mps"], last["east_mps"]) < 1.0
