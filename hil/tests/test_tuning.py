"""Tuning: the cost of a flight, the search, and the workers."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import fcc
import pytest
from distributed import LocalCluster
from hypothesis import given, settings
from hypothesis import strategies as st

from fcc_hil import __main__ as commands
from fcc_hil.configurations import value_of
from fcc_hil.score import LegScore, Score
from fcc_hil.truth import Truth
from fcc_hil.tuning import COSTS, SCALE_KEYS, Task, cost_of, flight_cost, tune
from fcc_hil.tuning.cost import NOT_FLOWN, Flight, weighed
from fcc_hil.tuning.identify import first_guess
from fcc_hil.tuning.search import scenarios
from fcc_hil.workers import local_workers, on_dask

ELEVATOR = "autopilot.scale.elevator"
LIMP = "[autopilot.scale]\nelevator = 0.15\n"
"""An elevator with too little gain: altitude oscillates slowly."""


def _task(**changes: object) -> Task:
    wanted: dict[str, object] = {
        "aircraft": "c172p",
        "config": LIMP,
        "keys": (ELEVATOR,),
        "seeds": (1,),
        "evaluations": 14,
        "legs": 1,
    }
    return Task(**{**wanted, **changes})  # type: ignore[arg-type]


def _leg(**changes: float | None) -> LegScore:
    good: dict[str, float | None] = {
        "heading_settle_s": 10.0,
        "heading_overshoot_deg": 0.0,
        "heading_rms_deg": 0.0,
        "altitude_settle_s": 10.0,
        "altitude_overshoot_ft": 0.0,
        "altitude_rms_ft": 0.0,
        "turn_loss_ft": 0.0,
        "airspeed_error_kt": 0.0,
        "lateral_acceleration_g": 0.0,
    }
    return {**good, **changes}  # type: ignore[typeddict-item]


def _flown(*legs: LegScore) -> Score:
    return {"legs": list(legs), "worst": legs[0]}


STILL = Truth([(0.0,) * 12] * 3)


def test_a_cost_is_two_parts_mean_and_one_part_worst() -> None:
    """By hand: altitude RMS 1 and 4 ft: (2 * 2.5 + 4) / 3 = 3, against a good 1 ft."""
    flown = _flown(_leg(altitude_rms_ft=1.0), _leg(altitude_rms_ft=4.0))
    assert weighed(flown, STILL, 20.0, {"altitude_rms_ft": 1.0}) == pytest.approx(3.0)
    assert weighed(flown, STILL, 20.0, {"altitude_rms_ft": 2.0}) == pytest.approx(6.0)


def test_a_leg_that_never_settles_counts_as_two_legs() -> None:
    flown = _flown(_leg(heading_settle_s=None))
    assert weighed(flown, STILL, 20.0, {"heading_settle_s": 1.0}) == pytest.approx(2.0)


def test_oscillating_surfaces_increase_the_cost() -> None:
    """0.1 to and fro at 40 Hz is 4 a second, of one surface of three."""
    rows = [(0.0,) * 8 + (0.1 * (n % 2), 0.0, 0.0, 0.5) for n in range(41)]
    cost = weighed(_flown(_leg()), Truth(rows), 20.0, {"movement": 1.0})
    assert cost == pytest.approx(4.0 / 3.0 / 0.5)


@settings(deadline=None)
@given(st.text(max_size=40))
def test_an_unknown_cost_is_refused(text: str) -> None:
    try:
        cost = cost_of(text)
    except ValueError as error:
        refused = str(error)
    else:
        refused = ""
        assert any(weight > 0.0 for weight in cost.weights.values())
    assert not refused or refused.startswith("cost")


def test_costs_by_name_and_by_weights() -> None:
    assert cost_of("gentle") is COSTS["gentle"]
    assert cost_of("altitude_rms_ft=2,movement=1").weights == {
        "altitude_rms_ft": 2.0,
        "movement": 1.0,
    }
    for wrong in ("altitude_rms_ft=-1", "altitude_rms_ft=nan", "movement=0", "speed=1", ""):
        with pytest.raises(ValueError, match="cost"):
            cost_of(wrong)


def test_the_search_finds_a_wrong_elevator_scale_repeatably(fccd: Path, tmp_path: Path) -> None:
    calls = []
    with local_workers(flight_cost, 1) as fly_all:
        found = tune(_task(), fly_all, lambda flown, least: calls.append((flown, least)))
        again = tune(_task(), fly_all)
    assert found.after < 0.8 * found.before
    assert found.values[ELEVATOR] > 0.2
    assert found == again
    assert calls[-1] == (found.evaluations, found.after)
    file = tmp_path / "found.toml"
    file.write_text(found.config, encoding="utf-8")
    checked = subprocess.run([fccd, "check", file], capture_output=True, text=True, check=False)
    assert checked.returncode == 0, checked.stderr


def test_the_result_is_never_worse_than_the_given_configuration() -> None:
    with local_workers(flight_cost, 1) as fly_all:
        found = tune(_task(config="[autopilot.scale]\npace = 1.0\n", evaluations=3), fly_all)
    assert found.after <= found.before


def test_the_reference_aircraft_has_a_scale_of_one() -> None:
    guess = first_guess("c172p")
    for key in SCALE_KEYS[:-1]:
        assert value_of(guess, key, 0.0) == 1.0
    assert value_of(guess, "autopilot.reference_airspeed_kt", 0.0) == 100.0
    fcc.Autopilot(guess)


def test_a_flight_that_cannot_be_flown_has_the_highest_cost() -> None:
    task = _task()
    bad = [Flight(s, task.cost.weights) for s in scenarios(task, "[autopilot]\nbank = 3\n")]
    with local_workers(flight_cost, 1) as fly_all:
        assert list(fly_all(bad)) == [NOT_FLOWN]


def test_a_cluster_and_processes_fly_the_same() -> None:
    task = _task(seeds=(1, 2))
    flights = [Flight(scenario, task.cost.weights) for scenario in scenarios(task, LIMP)]
    with local_workers(flight_cost, 2) as fly_all:
        here = list(fly_all(flights))
    with (
        LocalCluster(
            n_workers=1, threads_per_worker=1, processes=False, dashboard_address=None
        ) as cluster,
        on_dask(flight_cost, cluster.scheduler_address) as fly_all,
    ):
        there = list(fly_all(flights))
    assert here == there
    assert here[0] != here[1]


def test_without_dask_the_message_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(ValueError, match="pip install"), on_dask(flight_cost, "tcp://127.0.0.1:1"):
        pass


def test_a_missing_cluster_is_reported() -> None:
    with (
        pytest.raises(ValueError, match="no Dask scheduler"),
        on_dask(flight_cost, "tcp://127.0.0.1:9", timeout_s=1.0),
    ):
        pass


@pytest.mark.parametrize(
    ("changes", "match"),
    [
        ({"seeds": ()}, "no seeds"),
        ({"evaluations": 2}, "at least 3"),
        ({"keys": ()}, "at least one key"),
        ({"keys": ("autopilot.altitude.capture_g",)}, "put one into the configuration"),
        ({"config": "[autopilot"}, "configuration"),
    ],
)
def test_invalid_tasks_are_refused(changes: dict[str, object], match: str) -> None:
    with local_workers(flight_cost, 1) as fly_all, pytest.raises(ValueError, match=match):
        tune(_task(**changes), fly_all)


def test_the_command_writes_a_configuration(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    given_file, output = tmp_path / "given.toml", tmp_path / "found.toml"
    given_file.write_text(LIMP, encoding="utf-8")
    arguments = ["tune", "--aircraft", "c172p", "--from", str(given_file), "--search", ELEVATOR]
    arguments += ["--seeds", "1", "--legs", "1", "--evaluations", "6", "--workers", "1"]
    assert commands.main([*arguments, "-o", str(output)]) == 0
    assert "as given" in capsys.readouterr().out
    fcc.Autopilot(output.read_text(encoding="utf-8"))
    with pytest.raises(SystemExit, match="2"):
        commands.main([*arguments, "-o", str(tmp_path / "none" / "x.toml")])
    assert "there is no folder" in capsys.readouterr().err
