"""The plugin as used in tests: messages of failures, and artifacts."""

from __future__ import annotations

import json
import os
import subprocess
from pathlib import Path

import pytest
from recordings import RECORD, by_index

# What is loaded here stays: a run of pytest inside another forgets what it loads.
import fcc_hil.artifacts
import fcc_hil.daemon_rig
import fcc_hil.lockstep_rig  # noqa: F401

IMPORTS = "import pytest\nfrom fcc_hil import airspeed, altitude, bank, heading\n"
NOWHERE = "/proc/none"
"""A folder that cannot be created, because plots take longer than flights."""

FAILING = """
@pytest.mark.aircraft("c172p", turbulence=3, seed=4)
def test_too_strict(flight, faults):
    flight.engages(by=3)
    faults.bias(airspeed, by=5, after=2)
    flight.stays(heading, within=0.01, to=5)
"""


def _run(pytester: pytest.Pytester, text: str, *options: str) -> pytest.RunResult:
    pytester.makepyfile(IMPORTS + text)
    return pytester.runpytest_inprocess("-p", "no:cacheprovider", *options)


def _left(result: pytest.RunResult) -> list[Path]:
    """Return the files of which the report says that they were left behind."""
    lines = [Path(line) for line in result.outlines if line.startswith("/")]
    return [path for path in lines if path.suffix in {".png", ".csv", ".mcap"}]


def test_a_failed_requirement_prints_required_and_flown_values(
    pytester: pytest.Pytester,
) -> None:
    result = _run(pytester, FAILING, "--flight-artifacts", NOWHERE)
    result.assert_outcomes(failed=1)
    result.stdout.fnmatch_lines(
        [
            ">       flight.stays(heading, within=0.01, to=5)",
            "E *RequirementError: required: heading stays within 0.0 deg of * from 0 s to 5 s",
            "E *flown:    at *s heading is * deg, * off; at worst: at * s heading is *",
        ]
    )
    assert "flight.py" not in result.stdout.str().partition("short test summary")[0]


def test_a_failed_test_saves_a_plot_the_truth_and_a_recording(
    pytester: pytest.Pytester,
) -> None:
    result = _run(pytester, FAILING)
    plot, truth, recording = _left(result)
    assert plot.read_bytes().startswith(b"\x89PNG")
    header, *rows = truth.read_text().splitlines()
    assert header.startswith("time_s,heading_deg,altitude_ft")
    # 2 s of standby, the two readings of the switch that engage, and 5 s, at 40 Hz.
    assert len(rows) == 1 + 80 + 2 + 200
    ticks = [message for message in by_index(recording) if message.topic == RECORD]
    assert len(ticks) == len(rows) - 1
    assert (
        plot.parent.name == "test_a_failed_test_saves_a_plot_the_truth_and_a_recording"
        ".py_test_too_strict"
    )
    assert plot.parent.parent == pytester.path / ".flight-artifacts"


def test_the_daemon_reports_on_and_replays_a_lockstep_recording(
    pytester: pytest.Pytester, fccd: Path
) -> None:
    recording = _left(_run(pytester, FAILING))[-1]
    report = subprocess.run([fccd, "report", "--json", recording], capture_output=True, check=True)
    assert json.loads(report.stdout)
    replay = subprocess.run([fccd, "replay", recording], capture_output=True, check=True, text=True)
    assert "0 differ" in replay.stdout


def test_the_folder_for_them_is_an_option(pytester: pytest.Pytester, tmp_path: Path) -> None:
    result = _run(pytester, FAILING, "--flight-artifacts", str(tmp_path / "here"))
    assert {path.parent.parent for path in _left(result)} == {tmp_path / "here"}


def test_a_folder_that_cannot_be_created_is_reported_after_the_failure(
    pytester: pytest.Pytester,
) -> None:
    result = _run(pytester, FAILING, "--flight-artifacts", NOWHERE)
    result.assert_outcomes(failed=1)
    result.stdout.fnmatch_lines(["*RequirementError: required:*", "not everything was saved: *"])


def test_a_passed_test_saves_nothing(pytester: pytest.Pytester) -> None:
    result = _run(pytester, "def test_it(flight):\n    flight.engages(by=3)\n")
    result.assert_outcomes(passed=1)
    assert not (pytester.path / ".flight-artifacts").exists()


def test_aircraft_and_autopilot_can_be_stepped_by_a_test(pytester: pytest.Pytester) -> None:
    result = _run(
        pytester,
        """
        from fcc_hil.lockstep import measurements

        @pytest.mark.aircraft("c172x", heading=90)
        @pytest.mark.autopilot("hold")
        def test_it(aircraft, autopilot):
            assert aircraft.aircraft.name == "c172x"
            for _ in range(80):
                aircraft.step(3)
                autopilot.step(measurements(aircraft.state()), switch=False)
            assert autopilot.step(measurements(aircraft.state()), switch=True) is None
            assert autopilot.step(measurements(aircraft.state()), switch=True) is not None
            assert abs(autopilot.setpoints.heading_rad - 1.5708) < 0.02
        """.replace("\n        ", "\n"),
    )
    result.assert_outcomes(passed=1)


@pytest.mark.parametrize(
    ("mark", "words"),
    [
        ('aircraft("c17")', "*mark aircraft: *no aircraft 'c17'*choose one of: c172p*"),
        ("aircraft(wind=10)", "*wind is 10: give from where*"),
        ("aircraft(turbulence=8)", "*turbulence is 8: give 0 to 7*"),
        ("aircraft(seed=1.5)", "*seed is 1.5: give a whole number*"),
        ('aircraft(heading=float("nan"))', "*heading is nan: give a finite number*"),
        ("aircraft(gusts=3)", "*mark aircraft: *unexpected keyword argument 'gusts'*"),
        ('autopilot("loops")', "*mode is 'loops': choose timed-pattern or hold*"),
        ("autopilot(leg_s=0)", "*leg_s is 0: give 1 to 86400 s*"),
        ('autopilot(config="[autopilot]\\nbank = 3\\n")', "*mark autopilot: *no such key*"),
        ('autopilot(config="[loop]\\nrate_hz = 50\\n")', "*50 Hz does not fit*20, 40, 60 or 120*"),
    ],
)
def test_wrong_marks_are_reported(pytester: pytest.Pytester, mark: str, words: str) -> None:
    result = _run(pytester, f"@pytest.mark.{mark}\ndef test_it(flight):\n    pass\n")
    result.assert_outcomes(errors=1)
    result.stdout.fnmatch_lines([words])
    assert "Traceback" not in result.stdout.str()


@pytest.mark.parametrize(
    ("call", "words"),
    [
        ('flight.stays(altitude("kg"), within=1)', "*altitude is measured in 'ft' or 'm', *'kg'"),
        ("flight.stays(heading, within=float('nan'))", "*within is nan: give a finite number"),
        ("flight.stays('speed', within=1)", "*no quantity 'speed'; choose one of heading*"),
        ("faults.loss('engine')", "*no quantity 'engine'; choose one of heading*"),
    ],
)
def test_wrong_arguments_of_a_test_are_reported(
    pytester: pytest.Pytester, call: str, words: str
) -> None:
    text = f"def test_it(flight, faults):\n    flight.engages(by=3)\n    {call}\n"
    result = _run(pytester, text, "--flight-artifacts", NOWHERE)
    result.assert_outcomes(failed=1)
    result.stdout.fnmatch_lines([f"E *ValueError: {words}"])


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--fccd", "a..b"), "*--fccd a..b: no address for the host 'a..b'*"),
        (("--fccd", "127.0.0.1", "--fccd-listen", "127.0.0.1:0"), "*a port is 1 to 65535*"),
        (("--fccd-listen", "127.0.0.1"), "*give --fccd HOST*"),
    ],
)
def test_wrong_options_end_the_run_before_it_begins(
    pytester: pytest.Pytester, options: tuple[str, ...], words: str
) -> None:
    result = _run(pytester, "def test_it():\n    pass\n", *options)
    assert result.ret == pytest.ExitCode.USAGE_ERROR
    result.stderr.fnmatch_lines([words])


def test_a_missing_program_is_reported(pytester: pytest.Pytester) -> None:
    text = "def test_it(flight):\n    pass\n"
    result = _run(pytester, text, "--realtime", "--fccd-program", "/none/fccd")
    result.assert_outcomes(errors=1)
    result.stdout.fnmatch_lines(["there is no program /none/fccd: *--fccd-program*"])


def test_the_same_test_twice_is_the_same_to_the_last_bit(pytester: pytest.Pytester) -> None:
    first, again = (_left(_run(pytester, FAILING, "--flight-artifacts", d)) for d in ("a", "b"))
    assert first[1] != again[1]
    assert first[1].read_bytes() == again[1].read_bytes()
    records = [
        [m.data for m in by_index(files[2]) if m.topic == RECORD] for files in (first, again)
    ]
    assert records[0] == records[1]


def test_without_the_module_fcc_the_message_says_how_to_install_it(
    pytester: pytest.Pytester, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytester.makepyfile(IMPORTS + "def test_it(flight):\n    pass\n")
    pytester.makepyfile(fcc="raise ImportError('not here')\n")
    monkeypatch.setenv("PYTHONPATH", os.fspath(pytester.path))
    result = pytester.runpytest_subprocess("-p", "no:cacheprovider")
    result.assert_outcomes(errors=1)
    result.stdout.fnmatch_lines(["there is no module fcc: `pip install ./crates/fcc-py`*"])
