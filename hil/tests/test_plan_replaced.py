"""A plan is replaced in flight, by the daemon's own commands and from Python."""

from __future__ import annotations

import json
import os
import subprocess
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import fcc
import pytest
from daemon_under_test import DaemonUnderTest

PLANS = Path(__file__).parents[2] / "config/plans"
TWELVE_LEGS = PLANS / "twelve-legs.waypoints"
REFUSED = 11
HOME = (47.0, 8.0)


def _write(path: Path, places: Sequence[tuple[float, float]]) -> Path:
    """Write a plan of waypoints, at the altitude at which the built-in aircraft begins."""
    rows = [(number, 16, *place) for number, place in enumerate([HOME, *places])]
    lines = [f"{n} 0 0 {command} 0 0 0 0 {lat} {lon} 914.4 1" for n, command, lat, lon in rows]
    path.write_text("\n".join(["QGC WPL 110", *lines, ""]))
    return path


@pytest.fixture
def instance(request: pytest.FixtureRequest) -> str:
    """Return a name that no other daemon has."""
    return f"r{os.getpid()}-{abs(hash(request.node.name)) % 10**6}"


def _json(fccd: Path, *words: str | Path) -> tuple[int, Any]:
    done = subprocess.run(
        [fccd, *words, "--json"], capture_output=True, text=True, check=False, timeout=60.0
    )
    return done.returncode, json.loads(done.stdout)


def test_the_daemon_flies_another_plan_and_its_recording_has_it(
    fccd: Path, tmp_path: Path, instance: str
) -> None:
    """The replay is another process: it has nothing but the recording."""
    first = _write(tmp_path / "first.waypoints", [(47.2, 8.0), (47.2, 8.2)])
    second = _write(tmp_path / "second.waypoints", [(47.0, 8.3), (47.1, 8.2), (47.1, 8.0)])
    bad = tmp_path / "bad.waypoints"
    bad.write_text(second.read_text().replace(" 16 0 0 0 0 47.1 8.2", " 82 0 0 0 0 147.1 8.2"))
    words: list[str | Path] = [fccd, "fly", "--plan", first, "--instance", instance, "--json"]
    words += ["--recordings", tmp_path / "recordings", "--seconds", "600"]
    with DaemonUnderTest(words, tmp_path) as daemon:
        daemon.wait_for("mode: plan, was none")
        watcher, commander = fcc.Watcher(instance), fcc.Commander(instance)
        before = watcher.latest(15.0)
        assert before is not None

        def command(*words: str | Path) -> tuple[int, Any]:
            return _json(fccd, "command", "plan", *words, "--instance", instance)

        code, refused = command("replace", bad)
        assert code == REFUSED
        assert "bad.waypoints: item 2: line 4: command: 82 is not supported" in refused["why"]
        code, refused = command("replace", second, "--item", "4")
        assert code == REFUSED
        assert "item to begin with: 4: there is no such item: give 1 to 3" in refused["why"]
        with pytest.raises(fcc.CommandError, match=r"no\.plan: cannot be read"):
            commander.replace_plan(tmp_path / "no.plan")
        code, done = command("replace", second, "--item", "2")
        assert code == 0, done
        daemon.wait_for("the plan is replaced, and flown from item 2")
        # Its own items may be commanded, and no more.
        assert command("item", "3")[0] == 0
        code, refused = command("item", "4")
        assert code == REFUSED, refused
        now = watcher.latest(15.0)
        assert now is not None
        expected = int(fcc.Plan.read(second).hash[:16], 16)
        assert int(now["desired_plan_hash"]) == expected != int(before["desired_plan_hash"])
        assert commander.replace_plan(first) > done["tick"]
        code, _ = _json(fccd, "command", "stop", "--instance", instance)
        assert code == 0
        ending = daemon.end()
    (path,) = ending.report["recording"]["files"]
    recorded = fcc.Recording(path).records
    since = recorded["tick"] >= done["tick"]
    assert int(recorded["desired_plan_hash"][since][0]) == expected
    assert set(recorded["desired_plan_hash"][~since]) == {before["desired_plan_hash"]}
    code, replayed = _json(fccd, "replay", path)
    assert (code, replayed["identity"]["differing"]) == (0, 0), replayed
    _, report = _json(fccd, "report", path)
    shown = [(plan["hash"], plan["tick"]) for plan in report["replaced_plans"]]
    assert shown[0] == (f"{expected >> 16:012x}", done["tick"])
    assert shown[1][0] == fcc.Plan.read(first).hash[:12]


def test_a_machine_flies_another_plan(tmp_path: Path) -> None:
    first = _write(tmp_path / "first.waypoints", [(47.2, 8.0), (47.2, 8.2)])
    second = _write(tmp_path / "second.waypoints", [(47.0, 8.3), (47.1, 8.2)])
    text = f'[guidance]\nmode = "plan"\n[plan]\nfile = "{first}"\n'
    machine, aircraft = fcc.Machine(text), fcc.BuiltInAircraft(text)
    with pytest.raises(fcc.PlanError, match="there is no such item"):
        machine.replace_plan(second, item=3)
    surfaces = None
    for tick in range(400):
        measured = aircraft.step(surfaces, machine.period_s)
        surfaces = machine.step(measured, switch=aircraft.switch, readback=aircraft.controls)
        if tick == 300:
            machine.replace_plan(second, item=2)
    assert machine.setpoints.plan_hash == int(fcc.Plan.read(second).hash[:16], 16)
    assert machine.setpoints.guidance_item == 2
    (path,) = machine.record_to(tmp_path / "recorded")
    assert fcc.replay(path)["identical"] is True


def test_a_plan_is_read_checked_and_written(tmp_path: Path) -> None:
    plan = fcc.Plan.read(TWELVE_LEGS)
    assert len(plan) == 12
    assert len(plan.items) == 12
    assert plan.check() == []
    converted = tmp_path / "a.plan"
    plan.write(converted)
    again = fcc.Plan.read(converted)
    assert again == plan
    assert (again.hash, hash(again)) == (plan.hash, hash(plan))
    assert fcc.Plan(plan.to_text("wpl")) == plan
    assert json.loads(plan.to_text("plan"))["fileType"] == "Plan"
    # Stronger than the airspeed of 100 kt.
    problems = plan.check("[plan]\nwind_kt = 120\n")
    assert problems
    assert all(set(problem) == {"item", "field", "message"} for problem in problems)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", "the first line has to be QGC WPL 110"),
        ("QGC WPL 110\n0 0 0 16 0 0 0 0 47 8 0 1\n1 0 0 82 0 0 0 0 47 8 0 1\n", "item 1: line 3"),
    ],
)
def test_what_is_no_plan_is_refused_with_its_item(text: str, says: str) -> None:
    with pytest.raises(fcc.PlanError, match=says):
        fcc.Plan(text)


def test_wrong_arguments_of_a_plan(tmp_path: Path) -> None:
    plan = fcc.Plan.read(TWELVE_LEGS)
    with pytest.raises(ValueError, match="there is no format 'csv': choose plan or wpl"):
        plan.to_text("csv")
    with pytest.raises(ValueError, match="the format is not known by its name"):
        plan.write(tmp_path / "a.csv")
    with pytest.raises(FileNotFoundError, match=r"no\.plan"):
        fcc.Plan.read(tmp_path / "no.plan")
    with pytest.raises(FileNotFoundError, match=r"none/a\.plan"):
        plan.write(tmp_path / "none" / "a.plan")
