"""The flight suite: its quick part flown and checked against limits, and its judgement."""

from __future__ import annotations

import argparse
import json
import subprocess
from dataclasses import replace
from pathlib import Path

import fcc
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fcc_hil import __main__ as commands
from fcc_hil.commands import seeds
from fcc_hil.configurations import configuration, pattern_of, value_of, with_values
from fcc_hil.pattern import TimedPattern
from fcc_hil.suite import Case, cases, fly_all, fly_case
from fcc_hil.suite.limits import broken, limits
from fcc_hil.suite.matrix import HEAVY, LIGHT, SEEDS, TUNING_SEEDS, scenario_of

QUICK = [case for case in cases() if case.is_quick]


@pytest.mark.parametrize("case", QUICK, ids=[case.name for case in QUICK])
def test_within_its_limits(case: Case) -> None:
    assert fly_case(case).broken == ()


def test_no_seed_was_used_in_tuning() -> None:
    assert not set(SEEDS) & set(TUNING_SEEDS)


def test_every_aircraft_is_in_the_quick_part_and_every_case_has_its_own_name() -> None:
    assert {case.scenario.aircraft for case in QUICK} == {*LIGHT, *HEAVY}
    names = [case.name for case in cases()]
    assert len(set(names)) == len(names)


def test_the_same_suite_twice_is_the_same_to_the_last_bit() -> None:
    """However many processes fly it, and in whatever order they end."""
    names = (
        "c172x: noise, 25 ms late, turbulence 3",
        "c172p: engaged in a turn",
        "737: 10 kt from 90°",
    )
    chosen = [
        replace(case, seeds=case.seeds[:1], scenario=replace(case.scenario, legs=1))
        for case in cases()
        if case.name in names or case.is_peer
    ]
    assert len(chosen) == len(names) + 1
    alone = {outcome.case.name: outcome.digest for outcome in fly_all(chosen, workers=1)}
    together = {outcome.case.name: outcome.digest for outcome in fly_all(chosen, workers=2)}
    assert alone == together
    assert len(set(alone.values())) == len(chosen)


def test_the_edges_of_speed_and_weight_are_flown() -> None:
    edges = [case for case in cases() if case.group == "speeds and loads"]
    assert len(edges) == 4 * 3 * 2
    heavy = next(case for case in edges if case.name.startswith("c172p: 1.3 Vs, heavy"))
    assert heavy.scenario.airspeed_kt == pytest.approx(1.3 * 52.6, abs=1.5)
    assert heavy.scenario.plant().fdm["inertia/weight-lbs"] == pytest.approx(2_400.0, abs=0.1)


def test_another_seed_is_another_flight() -> None:
    calm = scenario_of("c172p")
    noisy = Case("noisy", "", replace(calm, legs=1, noise=True), limits(), seeds=(1,))
    assert fly_case(noisy).digest != fly_case(replace(noisy, seeds=(2,))).digest


def test_exceeded_limits_are_described() -> None:
    asked = limits(altitude_rms_ft=0.9, heading_settle_s=16.6, turn_loss_ft=1.0)
    figures = {"altitude_rms_ft": 0.91, "heading_settle_s": None, "turn_loss_ft": 1.0}
    words = broken(figures, asked)
    assert words == [
        "altitude_rms_ft: 0.91 exceeds 0.9 ft",
        "heading_settle_s: some leg never settles; the limit is 16.6 s",
    ]
    assert broken({"turn_loss_ft": float("nan")}, limits(turn_loss_ft=1.0))
    with pytest.raises(ValueError, match="no figure 'speed'"):
        limits(speed=1.0)


def test_a_flight_that_fails_fails_its_case_only() -> None:
    calm = scenario_of("c172p")
    wrong = Case("wrong", "", replace(calm, config="[autopilot]\nbank = 3\n"), limits())
    outcome = fly_case(wrong)
    assert "there is no such key" in outcome.broken[0]
    assert outcome.document()["legs"] == []


def test_the_command_writes_table_json_and_picture(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    figures, picture = tmp_path / "suite.json", tmp_path / "suite.png"
    asked = ["suite", "--only", "c172p: calm", "--workers", "1"]
    assert commands.main([*asked, "--json", str(figures), "--picture", str(picture)]) == 0
    log = capsys.readouterr().out
    assert "c172p: calm" in log
    assert "times real time" in log
    document = json.loads(figures.read_text(encoding="utf-8"))
    assert len(document["cases"][0]["legs"]) == 8
    assert picture.read_bytes().startswith(b"\x89PNG")

    impossible = replace(cases()[1], limits=limits(altitude_rms_ft=0.0))
    monkeypatch.setattr("fcc_hil.suite.matrix.cases", lambda: [impossible])
    assert commands.main(asked) == 1
    assert "altitude_rms_ft" in capsys.readouterr().out
    assert commands.main(["suite", "--only", "nothing"]) == 1
    assert "matches no case" in capsys.readouterr().err


def test_lockstep_is_much_faster_than_real_time() -> None:
    """Nominally 900 times, in processor time; this is far below what a loaded machine does."""
    flown = fly_case(Case("short", "", replace(scenario_of("c172p"), legs=2), limits()))
    assert flown.simulated_s > 60.0 * flown.cpu_s


@pytest.mark.parametrize("aircraft", [*LIGHT, *HEAVY])
def test_the_daemon_takes_each_configuration(aircraft: str, fccd: Path, tmp_path: Path) -> None:
    text = configuration(aircraft)
    fcc.Autopilot(text)
    if not text:
        assert aircraft in ("c172p", "c172x", "c172r")
        return
    file = tmp_path / f"{aircraft}.toml"
    file.write_text(text, encoding="utf-8")
    checked = subprocess.run([fccd, "check", file], capture_output=True, text=True, check=False)
    assert checked.returncode == 0, checked.stderr


def test_a_value_is_set_and_the_others_are_unchanged() -> None:
    text = "# why\n[guidance]\nmode = 'hold' # so\n[autopilot.scale]\npace = 0.5\n"
    changed = with_values(text, {"autopilot.scale.pace": 0.75, "autopilot.heading.lead_s": 0.3})
    assert "# why" in changed
    assert "# so" in changed
    assert value_of(changed, "autopilot.scale.pace", 1.0) == 0.75
    assert value_of(changed, "autopilot.heading.lead_s", 1.0) == 0.3
    assert value_of(changed, "autopilot.heading.roll_gain_per_s", 3.1) == 3.1
    fcc.Autopilot(changed)
    assert pattern_of("[guidance]\nleg_s = 50\n") == TimedPattern(leg_s=50.0)
    with pytest.raises(ValueError, match="guidance"):
        value_of("[guidance]\nleg_s = 'long'\n", "guidance.leg_s", 20.0)
    with pytest.raises(ValueError, match="configuration"):
        value_of("[guidance", "guidance.leg_s", 20.0)


@settings(deadline=None)
@given(st.lists(st.integers(0, 10_000), min_size=1, max_size=20))
def test_seeds_are_read_as_written(numbers: list[int]) -> None:
    assert seeds(",".join(map(str, numbers))) == tuple(numbers)


@settings(deadline=None)
@given(st.text(max_size=20))
def test_other_text_is_refused_or_seeds(text: str) -> None:
    try:
        found = seeds(text)
    except argparse.ArgumentTypeError:
        return
    assert all(number >= 0 for number in found)


def test_seeds_of_a_range() -> None:
    assert seeds("3,7-9") == (3, 7, 8, 9)
    for wrong in ("9-7", "-3", "1-99999", "", "a"):
        with pytest.raises(argparse.ArgumentTypeError):
            seeds(wrong)
