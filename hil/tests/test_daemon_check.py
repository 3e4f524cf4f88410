"""`fccd check`: problems of a configuration with line, key and permitted values."""

from __future__ import annotations

import json
import os
from pathlib import Path

import pytest
import tomlkit
from test_daemon_commands import run

CONFIGS = Path(__file__).parents[2] / "config"

WRONG = {
    "an unknown key": (
        '[x-plane]\nsimulater = "127.0.0.1:49000"\n',
        2,
        "x-plane.simulater",
        "`simulator`",
    ),
    "an unknown section": ("[x-plane]\n[lop]\nrate_hz = 40\n", 2, "lop", "`loop`"),
    "a key without its unit": (
        "[built-in]\n[autopilot.envelope]\nmax_bank = 30\n",
        3,
        "autopilot.envelope.max_bank",
        "`max_bank_deg`",
    ),
    "a text for a number": (
        '[x-plane]\n\n[loop]\nrate_hz = "forty"\n',
        4,
        "loop.rate_hz",
        "a number, 20 to 2000",
    ),
    "a fraction for a count": (
        "[x-plane]\nengines = 1.5\n",
        2,
        "x-plane.engines",
        "a whole number, 1 to 8",
    ),
    "a number for a text": ("[x-plane]\nengage_switch = 3\n", 2, "x-plane.engage_switch", "text"),
    "a number for a truth": ("[x-plane]\n[realtime]\nstrict = 1\n", 3, "realtime.strict", "true"),
    "too large": ("[x-plane]\n[loop]\nrate_hz = 5000\n", 3, "loop.rate_hz", "20 to 2000"),
    "too small": ("[x-plane]\nengines = -1\n", 2, "x-plane.engines", "1 to 8"),
    "no number": ("[x-plane]\n[failsafe]\nhold_s = nan\n", 3, "failsafe.hold_s", "0 to 600"),
    "an unknown timer": (
        '[x-plane]\n[loop]\ntimer = "quartz"\n',
        3,
        "loop.timer",
        "timerfd, posix or nanosleep",
    ),
    "an unknown choice": (
        '[x-plane]\n[failsafe]\nthen = "land"\n',
        3,
        "failsafe.then",
        '"standby" or "stop"',
    ),
    "no dataref": (
        '[x-plane]\nengage_switch = "sim/with space"\n',
        2,
        "x-plane.engage_switch",
        "letters, digits, / _ [ ]",
    ),
    "no address": (
        '[x-plane]\nsimulator = "192.168.1.300:49000"\n',
        2,
        "x-plane.simulator",
        "127.0.0.1:49000",
    ),
    "rows without a port": ('[x-plane]\ninput = "data"\n', 1, "x-plane.local_port", "target port"),
    "two aircraft": ("[x-plane]\n[built-in]\n", 2, "built-in", "keep the section"),
    "no aircraft": ("[loop]\nrate_hz = 40\n", None, None, "[x-plane]"),
    "a range upside down": (
        "[built-in]\n[autopilot.envelope]\nmin_airspeed_kt = 120\nmax_airspeed_kt = 110\n",
        3,
        "autopilot.envelope.min_airspeed_kt",
        "less than max_airspeed_kt",
    ),
    # 14 CFR 23.73 in force until 2017: 1.3 times the stalling speed, here 53 kt.
    "an approach at the stalling speed": (
        "[built-in]\n[autopilot.runway]\napproach_kt = 53.0\n",
        3,
        "autopilot.runway.approach_kt",
        "choose 65 to 135",
    ),
    "a rotation above the climb": (
        "[built-in]\n[autopilot.runway]\nrotate_kt = 90.0\nclimb_kt = 70.0\n",
        3,
        "autopilot.runway.rotate_kt",
        "choose 53 to 70",
    ),
    "a rotation below the stalling speed": (
        "[built-in]\n[autopilot.runway]\nrotate_kt = 40.0\n",
        3,
        "autopilot.runway.rotate_kt",
        "choose 53 to 75",
    ),
    "a default that contradicts a value": (
        "[built-in]\n[failsafe]\nall_silent_s = 0.1\n",
        3,
        "failsafe.all_silent_s",
        "; failsafe.sensor_max_age_ms = 250 by default, not in the file",
    ),
    "a stage longer than its tick": (
        "[built-in]\n[budget]\ntick_us = 900\ncontrol_us = 1000\n",
        4,
        "budget.control_us",
        "no more than tick_us",
    ),
    "a tick longer than its period": (
        "[built-in]\n[loop]\nrate_hz = 50\n[budget]\ntick_us = 20001\n",
        5,
        "budget.tick_us",
        "no more than the period, 20000",
    ),
    "a key that is meant": (
        "[built-in]\n[loop]\nrate_hertz = 50\n",
        3,
        "loop.rate_hertz",
        "did you mean `rate_hz`",
    ),
    "a section that is meant": ("[buildin]\n", 1, "buildin", "did you mean `built-in`"),
    "a key of another section": (
        "[built-in]\n[autopilot]\nmax_bank_deg = 25\n",
        3,
        "autopilot.max_bank_deg",
        "did you mean `autopilot.envelope.max_bank_deg`",
    ),
    "a choice that is meant": (
        '[built-in]\ngusts = "modrate"\n',
        2,
        "built-in.gusts",
        'did you mean "moderate"',
    ),
    "a hang that is none": (
        "[built-in]\n[watchdog]\nhang_after_ms = 5\n",
        3,
        "watchdog.hang_after_ms",
        "50 to 60000",
    ),
    "a leg of a hold": (
        '[x-plane]\n[guidance]\nmode = "hold"\nleg_s = 3\n',
        2,
        "guidance",
        "leg_s",
    ),
    "a section by its former name": (
        '[x-plane]\n[course]\nkind = "hold"\n',
        2,
        "course",
        "is called [guidance], its kind mode",
    ),
    "an unknown mode": ('[x-plane]\n[guidance]\nmode = "loop"\n', 3, "guidance.mode", '"hold"'),
    "twice the same": ("[x-plane]\nengines = 1\nengines = 2\n", 3, "x-plane.engines", "keep one"),
    "no TOML": ("[x-plane\n", 1, None, "]"),
}


@pytest.mark.parametrize(("text", "line", "key", "right"), WRONG.values(), ids=WRONG.keys())
def test_a_problem_is_reported_with_its_place_and_the_permitted_values(
    fccd: Path, tmp_path: Path, text: str, line: int | None, key: str | None, right: str
) -> None:
    file = tmp_path / "wrong.toml"
    file.write_text(text)
    ended = run([fccd, "check", file])
    assert ended.returncode == 2
    (log,) = ended.stderr.splitlines()
    place = f"{file}:{line}: " if line else f"{file}: "
    assert log.startswith(place + (f"{key}: " if key else ""))
    assert right in log

    as_json = run([fccd, "check", file, "--json"])
    assert as_json.returncode == 2
    checked = json.loads(as_json.stdout)
    assert checked["file"] == str(file)
    assert checked["ok"] is False
    (problem,) = checked["problems"]
    assert (problem["line"], problem["key"]) == (line, key)
    assert right in problem["message"]


def test_speeds_of_the_cessnas_runway_are_refused_in_a_slow_aircraft(
    fccd: Path, tmp_path: Path
) -> None:
    """Never exceed 60 kt: the Cessna's climb at 75 and approach at 68 kt are above it."""
    file = tmp_path / "slow.toml"
    file.write_text(
        "[built-in]\n[autopilot.envelope]\nstall_airspeed_kt = 25\nmin_airspeed_kt = 28\n"
        "best_glide_airspeed_kt = 32\nmaneuvering_airspeed_kt = 45\nmax_airspeed_kt = 58\n"
        "never_exceed_airspeed_kt = 60\n"
    )
    problems = json.loads(run([fccd, "check", file, "--json"]).stdout)["problems"]
    key = "autopilot.runway"
    high, absent = "58: {} to envelope.max_airspeed_kt", "by default, not in the file"
    climb = high.format("envelope.min_airspeed_kt")
    approach = high.format("1.2 times envelope.stall_airspeed_kt")
    of_climb = f"is 75 {absent}: choose 28 to {climb}"
    of_approach = f"is 68 {absent}: choose 30 to {approach}"
    assert {problem["key"]: problem["message"] for problem in problems} == {
        f"{key}.climb_kt": of_climb,
        f"{key}.approach_kt": of_approach,
    }


def test_the_schema_is_one_that_the_examples_satisfy(fccd: Path) -> None:
    """Of all keys of the shipped configurations, each is one of the schema's."""
    schema = json.loads(run([fccd, "schema"]).stdout)
    assert schema["type"] == "object"
    for name in ("built-in", "x-plane", "servo-board"):
        given = tomlkit.parse((CONFIGS / f"{name}.toml").read_text()).unwrap()
        given.pop("sensor", None)
        given.pop("actuator", None)
        for section, keys in given.items():
            assert keys.keys() <= schema["properties"][section]["properties"].keys()


def test_every_problem_is_reported_in_the_order_of_the_file(fccd: Path, tmp_path: Path) -> None:
    file = tmp_path / "wrong.toml"
    file.write_text("[x-plane]\nengines = 9\nrate_hz = 0\n[failsafe]\nhold_s = -1\n")
    ended = run([fccd, "check", file])
    starts = [line.rpartition(": is ")[0] for line in ended.stderr.splitlines()]
    assert starts == [
        f"{file}:2: x-plane.engines",
        f"{file}:3: x-plane.rate_hz",
        f"{file}:5: failsafe.hold_s",
    ]


def test_one_problem_hides_no_other(fccd: Path, tmp_path: Path) -> None:
    """Problems of syntax, keys, types, choices, ranges and combinations."""
    file = tmp_path / "wrong.toml"
    file.write_text(
        "[x-plane]\n"
        "simulater = 3\n"
        'engines = "two"\n'
        "rate_hz = = 5\n"
        "resubscribe_s = 0\n"
        "[failsafe]\n"
        'then = "land"\n'
        "hold_s = -1\n"
        "hold_s = -2\n"
        "[lop]\n"
        "[autopilot.envelope]\n"
        "min_airspeed_kt = 120\n"
        "max_airspeed_kt = 110\n"
    )
    ended = run([fccd, "check", file])
    assert ended.returncode == 2
    lines = [int(line.split(":")[1]) for line in ended.stderr.splitlines()]
    assert lines == [2, 3, 4, 5, 7, 8, 9, 10, 12], ended.stderr
    problems = json.loads(run([fccd, "check", file, "--json"]).stdout)["problems"]
    assert [problem["line"] for problem in problems] == lines


@pytest.mark.parametrize("what", ["folder", "pipe", "device", "huge"])
def test_a_file_that_is_not_a_configuration_is_refused(
    fccd: Path, tmp_path: Path, what: str
) -> None:
    path = tmp_path / what
    if what == "folder":
        path.mkdir()
    elif what == "pipe":
        os.mkfifo(path)
    elif what == "device":
        path = Path("/dev/zero")
    else:
        path.write_bytes(b"#" * 1_000_001)
    says = {"folder": "a folder", "huge": "more than 1000000 bytes"}.get(what, "a pipe or a device")
    for words in (["check"], ["run", "--config"], ["fly", "--config"]):
        ended = run([fccd, *words, path])
        assert ended.returncode == 2
        assert ended.stderr.startswith(f"{path}: cannot be read: ")
        assert says in ended.stderr


def test_the_default_of_the_switch_is_reported(fccd: Path, tmp_path: Path) -> None:
    file = tmp_path / "right.toml"
    file.write_text("[x-plane]\n")
    ended = run([fccd, "check", file])
    assert ended.returncode == 0
    switch = "x-plane.engage_switch is not given: the engage switch is sim/cockpit2/switches"
    assert switch in ended.stdout
    (remark,) = json.loads(run([fccd, "check", file, "--json"]).stdout)["remarks"]
    assert switch in remark
    file.write_text('[x-plane]\nengage_switch = "sim/mine"\n')
    assert json.loads(run([fccd, "check", file, "--json"]).stdout)["remarks"] == []


def test_invalid_utf_8(fccd: Path, tmp_path: Path) -> None:
    file = tmp_path / "latin-1.toml"
    file.write_bytes("[x-plane]\n# für\n".encode("latin-1"))
    ended = run([fccd, "check", file])
    assert ended.returncode == 2
    assert ended.stderr.startswith(f"{file}:2: ")
    assert "UTF-8" in ended.stderr


def test_a_missing_file(fccd: Path, tmp_path: Path) -> None:
    file = tmp_path / "missing.toml"
    ended = run([fccd, "check", file])
    assert ended.returncode == 2
    assert ended.stderr.startswith(f"{file}: ")
    assert "config/" in ended.stderr
    checked = json.loads(run([fccd, "check", file, "--json"]).stdout)
    assert checked["ok"] is False


@pytest.mark.parametrize("section", ["x-plane", "built-in"])
def test_a_valid_file(fccd: Path, tmp_path: Path, section: str) -> None:
    file = tmp_path / "right.toml"
    file.write_text(f"[{section}]\n")
    ended = run([fccd, "check", file])
    assert (ended.returncode, ended.stderr) == (0, "")
    checked = json.loads(run([fccd, "check", file, "--json"]).stdout)
    assert checked.pop("remarks") is not None
    assert checked == {"file": str(file), "ok": True, "problems": []}


def test_run_refuses_what_check_refuses(fccd: Path, tmp_path: Path) -> None:
    file = tmp_path / "wrong.toml"
    file.write_text("[x-plane]\nengines = 9\n")
    ended = run([fccd, "run", "--config", file, "--json"])
    assert ended.returncode == 2
    assert f"{file}:2: x-plane.engines" in ended.stderr
    assert json.loads(ended.stdout) == {"error": ended.stderr.strip()}
