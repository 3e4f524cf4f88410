"""The whole: stand-in and a little daemon in processes of their own, in real time."""

from __future__ import annotations

import json
import shlex
import sys
import time
from dataclasses import replace
from pathlib import Path

import pytest

from fcc_hil import documents
from fcc_hil.__main__ import main
from fcc_hil.cockpit import OVERRIDE_JOYSTICK
from fcc_hil.daemon import Daemon, DaemonError, command
from fcc_hil.fly import Plan, altitudes_note, fly
from fcc_hil.pattern import TimedPattern
from fcc_hil.peer import fly_peer
from fcc_hil.plot import plot_pattern
from fcc_hil.process import StandInError, StandInProcess
from fcc_hil.rig import FlightError
from fcc_hil.standin import Mode, Settings
from fcc_hil.udp import free_port

FAKE = Path(__file__).parent / "fake_daemon.py"
SHORT = TimedPattern(hold_s=1.0, leg_s=3.0, turn_deg=0.0, climb_ft=0.0)


def plan(*options: str, pattern: TimedPattern = SHORT) -> Plan:
    port = free_port()
    words = [sys.executable, str(FAKE), str(port), *options]
    return Plan(words, Settings(port=port), legs=1, pattern=pattern)


def test_a_flight_from_switch_to_score(tmp_path: Path) -> None:
    lines: list[str] = []
    flight = fly(plan(), lines.append)
    assert flight.failures == []
    assert flight.exit_code == 0
    (leg,) = flight.figures["legs"]
    # It held what it had: wings level, on heading, at its height.
    assert leg["heading_settle_s"] == pytest.approx(0.0, abs=0.03)
    assert leg["altitude_rms_ft"] < 10.0
    assert len([line for line in lines if " hdg " in line]) == pytest.approx(4, abs=1)

    document_path = tmp_path / "flight.json"
    documents.write(
        document_path, flight.document(fly_peer(flight.plan.legs, pattern=flight.plan.pattern)[0])
    )
    document = json.loads(document_path.read_text())
    assert document["timing"]["rate_hz"] == 40.0
    assert document["aircraft"] == "c172p"
    assert document["seed"] == 1
    assert set(document["flight"]) == {"legs", "worst"}

    picture = tmp_path / "flight.png"
    plot_pattern(picture, flight.truth, SHORT, flight.engaged_at_s, 1, "A short flight")
    assert picture.read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"


@pytest.mark.parametrize(
    ("qnh_inhg", "words"),
    # The pilots' table of pressure altitudes (FAA-H-8083-25C, figure 11-3), interpolated.
    [(30.12, "about 180 ft lower"), (29.5, "about 390 ft higher")],
)
def test_the_two_altitudes_that_are_printed_are_explained(qnh_inhg: float, words: str) -> None:
    assert words in altitudes_note(Settings(qnh_inhg=qnh_inhg))


def test_at_the_standard_pressure_there_is_one_altitude() -> None:
    assert not altitudes_note(Settings.plain())


def test_a_flight_with_a_freeze() -> None:
    lines: list[str] = []
    flight = fly(replace(plan(), actions=((0.5, "freeze:0.4"), (1.0, "knob:30.5"))), lines.append)
    assert flight.failures == []
    assert [line for line in lines if ":" in line and " " not in line] == [
        "freeze:0.4",
        "knob:30.5",
    ]


def test_a_daemon_that_ends_is_reported() -> None:
    with pytest.raises(FlightError, match="ended with exit code 3"):
        fly(plan("--exit-after", "4"), lambda _: None)


def test_a_daemon_that_never_engages_is_reported() -> None:
    with pytest.raises(FlightError, match="has not taken the controls"):
        fly(plan("--never-engage"), lambda _: None)


def test_overrides_left_behind_are_a_failure() -> None:
    brief = TimedPattern(hold_s=0.2, leg_s=0.5, turn_deg=0.0, climb_ft=0.0)
    flight = fly(plan("--keep-overrides", pattern=brief), lambda _: None)
    assert len(flight.failures) == 1
    assert OVERRIDE_JOYSTICK in flight.failures[0]


def test_a_missing_daemon_is_reported(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    code = main(["fly", "--fccd", str(tmp_path / "fccd"), "--port", "0"])
    assert code == 1
    assert "cannot start" in capsys.readouterr().err
    with pytest.raises(DaemonError, match="give its path with --fccd"):
        Daemon(command(tmp_path / "fccd", None))


def test_command_line_of_the_daemon() -> None:
    words = command(Path("fccd"), Path("xplane.toml"))
    assert words == ["fccd", "run", "--config", "xplane.toml", "--json"]


@pytest.mark.parametrize(
    ("printed", "found"),
    [
        ('{"timing": {"ticks": 3}}', {"timing": {"ticks": 3}}),
        ('starting\n{"timing": null}\n', {"timing": None}),
        ('{\n  "a":\n  1\n}\n', {"a": 1}),
        ("no JSON here", None),
        ("[1, 2]", None),
        ("", None),
    ],
)
def test_the_daemons_report_is_found_in_its_output(
    printed: str, found: dict[str, object] | None
) -> None:
    with Daemon(["/bin/sh", "-c", f"printf %s {shlex.quote(printed)}"]) as daemon:
        while daemon.exit_code is None:
            time.sleep(0.01)
        assert daemon.report() == found


def test_the_stand_ins_process_takes_commands_and_can_be_killed() -> None:
    simulator = StandInProcess(Settings(port=0))
    simulator.set_mode(Mode.PAUSED)
    before = simulator.progress()
    assert before.mode is Mode.PAUSED
    simulator.act("fps:200")
    simulator.set_mode(Mode.RUNNING)
    while simulator.progress().time_s < before.time_s + 0.1:
        pass
    assert simulator.read("sim/time/paused") == 0.0
    assert simulator.read("sim/no/such") is None
    simulator.kill()
    with pytest.raises(StandInError, match="has ended"):
        simulator.progress()
    simulator.stop()


def test_a_port_in_use_is_reported_by_the_process() -> None:
    with (
        StandInProcess(Settings(port=0)) as simulator,
        pytest.raises(StandInError, match="cannot listen"),
    ):
        StandInProcess(Settings(port=simulator.port))


def test_peer_command(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    assert main(["peer", "--legs", "2", "--plot", str(tmp_path / "peer.png")]) == 0
    assert "0 of 2 legs" in capsys.readouterr().out
    assert (tmp_path / "peer.png").exists()
    with pytest.raises(SystemExit, match="2"):
        main(["peer", "--legs", "0"])
