"""The daemon's command line as used by programs: JSON, exit codes, completions."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest

# Keys for other programs; they must not change.
TIMING = {
    "rate_hz",
    "timer",
    "ticks",
    "missed",
    "period_ms",
    "lateness_us",
    "realtime",
    "cpu_percent",
    "page_faults",
    "early_wake",
}
PERIOD = {"mean", "median", "min", "max", "range", "within_2_percent"}
LATENESS = {"p50", "p99", "p99_9", "max"}
REALTIME = {
    "policy",
    "priority",
    "cpu",
    "cpu_because",
    "memory_locked",
    "stack_prefaulted",
    "timer_slack_ns",
    "cpu_dma_latency_us",
    "refused",
}
LEG = {
    "number",
    "heading_settle_s",
    "heading_overshoot_deg",
    "heading_rms_deg",
    "altitude_settle_s",
    "altitude_overshoot_ft",
    "altitude_rms_ft",
    "turn_loss_ft",
    "airspeed_error_kt",
    "lateral_acceleration_g",
}

NOT_RECORDED = 14

_RUN_S = 60.0


def run(words: Sequence[str | Path]) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [str(word) for word in words],
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        timeout=_RUN_S,
        check=False,
    )


def assert_timing(timing: dict[str, Any]) -> None:
    assert set(timing) == TIMING
    assert set(timing["period_ms"]) == PERIOD
    assert set(timing["lateness_us"]) == LATENESS
    assert set(timing["realtime"]) == REALTIME
    assert isinstance(timing["realtime"]["refused"], list)
    assert 0.0 <= timing["period_ms"]["within_2_percent"] <= 1.0


@pytest.mark.parametrize("timer", ["timerfd", "posix", "nanosleep"])
def test_timing_as_json(fccd: Path, timer: str) -> None:
    ended = run([fccd, "timing", "--rate", "100", "--seconds", "1", "--timer", timer, "--json"])
    assert ended.returncode == 0, ended.stderr
    (timing,) = json.loads(ended.stdout)
    assert_timing(timing)
    assert timing["rate_hz"] == 100.0
    assert timing["timer"] == timer
    # A second of periods; some may have been missed on a busy machine.
    assert timing["ticks"] + timing["missed"] >= 100


@pytest.mark.parametrize("when", ["auto", "on", "off"])
def test_timing_wakes_early_if_permitted(fccd: Path, when: str) -> None:
    words: list[str | Path] = [
        fccd,
        "timing",
        "--rate",
        "100",
        "--seconds",
        "0.2",
        "--early-wake",
        when,
        "--json",
    ]
    ended = run(words)
    assert ended.returncode == 0, ended.stderr
    (timing,) = json.loads(ended.stdout)
    granted = timing["realtime"]["priority"] > 0
    expected = {"auto": granted, "on": True, "off": False}[when]
    assert (timing["early_wake"] is not None) == expected
    refused = [one["request"] for one in timing["realtime"]["refused"]]
    assert ("early wake" in refused) == (when == "auto" and not granted)


def test_timing_measures_each_rate(fccd: Path) -> None:
    words = ["timing", "--rate", "100", "--rate", "200", "--seconds", "0.2", "--json"]
    ended = run([fccd, *words])
    assert ended.returncode == 0, ended.stderr
    assert [timing["rate_hz"] for timing in json.loads(ended.stdout)] == [100.0, 200.0]


def test_fly_as_json(fccd: Path) -> None:
    ended = run([fccd, "fly", "--seconds", "45", "--lockstep", "--json"])
    assert ended.returncode == 0, ended.stderr
    report = json.loads(ended.stdout)
    assert_timing(report["timing"])
    assert set(report["flight"]) == {"legs", "worst"}
    assert report["scored_by"] == "truth"
    # 20 s of hold and one leg of 20 s; the second has only begun.
    (leg,) = report["flight"]["legs"]
    assert set(leg) == LEG
    assert {"number": 1} | report["flight"]["worst"] == leg
    assert leg["heading_settle_s"] is not None
    assert report["ending"] == "the time to fly is over"


def test_fly_prints_a_status_each_second_unless_quiet(fccd: Path) -> None:
    aloud = run([fccd, "fly", "--seconds", "5", "--lockstep"])
    lines = [line for line in aloud.stderr.splitlines() if " alt " in line]
    assert len(lines) == 2 + 5 + 1, "2 s before engaging, 5 after, both ends counted"
    quiet = run([fccd, "fly", "--seconds", "5", "--lockstep", "--quiet"])
    assert " alt " not in quiet.stderr


def test_lockstep_prints_the_score_and_no_timing(fccd: Path) -> None:
    ended = run([fccd, "fly", "--seconds", "45", "--lockstep", "--quiet"])
    assert ended.returncode == 0, ended.stderr
    assert "Missed" not in ended.stdout, "no time passes that could be kept"
    assert "scored by the true values" in ended.stdout
    for column in ("≤2°", "over", "RMS", "≤10 ft", "loss", "speed", "side"):
        assert ended.stdout.count(column) >= 2, "in the table, and below it what it means"
    in_real_time = run([fccd, "fly", "--seconds", "1", "--quiet", "--no-recording"])
    assert "Missed" in in_real_time.stdout


def test_a_flight_that_was_not_recorded_has_its_own_exit_code(fccd: Path, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("in the way of a folder")
    ended = run([fccd, "fly", "--seconds", "1", "--lockstep", "--recordings", tmp_path / "file"])
    assert ended.returncode == NOT_RECORDED, ended.stderr
    assert "NOT RECORDED" in ended.stdout


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["run"], "--config"),
        (["run", "--config", "no-such.toml"], "no-such.toml: cannot be read"),
        (["timing", "--timer", "quartz"], "choose timerfd, posix or nanosleep"),
        (["timing", "--rate", "0"], "give 1 to 2000 Hz"),
        (["fly", "--seconds", "-1"], "give 0.1 to 1000000 seconds"),
        (["land"], "land"),
        ([], "Usage"),
    ],
)
def test_a_wrong_command_line_gives_a_message(fccd: Path, words: list[str], says: str) -> None:
    ended = run([fccd, *words])
    assert ended.returncode == 2
    assert says in ended.stderr
    assert ended.stdout == ""


def test_help_names_the_exit_codes(fccd: Path) -> None:
    ended = run([fccd, "--help"])
    assert ended.returncode == 0
    assert "3  the flight entered failsafe" in ended.stdout
    assert "12  another program uses the simulator" in ended.stdout
    assert "14  the flight succeeded, but was not recorded" in ended.stdout


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_completions(fccd: Path, tmp_path: Path, shell: str) -> None:
    ended = run([fccd, "completions", shell])
    assert ended.returncode == 0
    for command in ("fly", "run", "timing", "check"):
        assert command in ended.stdout
    # Not in `fccd --help` either.
    for hidden in ("publisher", "release-helper", "end-with"):
        assert hidden not in ended.stdout
    if shell == "bash":
        script = tmp_path / "fccd.bash"
        script.write_text(ended.stdout)
        parsed = run(["bash", "-n", script])
        assert (parsed.returncode, parsed.stderr) == (0, "")
