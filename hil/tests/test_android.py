"""The app's classes and native library, in a Java process: they fly JSBSim as the daemon does.

By X-Plane's own sensors, and by those of a phone. Only in `make test-android`, which builds them
and sets FCC_ANDROID to the program that has the command line of `fccd run`.
"""

from __future__ import annotations

import json
import os
import signal
import subprocess
import time
from pathlib import Path
from typing import Any

import pytest
from daemon_under_test import wait_until, write_config

from fcc_hil.cockpit import ENGAGE_SWITCH
from fcc_hil.daemon import Daemon, command
from fcc_hil.fly import Flight, Plan, fly
from fcc_hil.pattern import TimedPattern
from fcc_hil.process import StandInProcess
from fcc_hil.servo_board import FAILSAFE_AFTER_S, Control
from fcc_hil.settings import Settings
from fcc_hil.state import Controls
from fcc_hil.udp import free_port

PROGRAM = os.environ.get("FCC_ANDROID")
CUT_OFF = 8
"""fccd's exit code for a recording that does not end as one does."""
MOST_GROWTH_KIB = 20_000
pytestmark = pytest.mark.skipif(PROGRAM is None, reason="make test-android builds it")


def test_the_pattern_is_flown_in_a_java_process_and_replayed_to_the_last_bit(
    fccd: Path, tmp_path: Path
) -> None:
    assert PROGRAM is not None
    port = free_port()
    pattern = TimedPattern(hold_s=5.0)
    config = write_config(
        tmp_path, port, guidance=f'mode = "timed-pattern"\nhold_s = {pattern.hold_s}'
    )
    recordings = tmp_path / "recordings"
    words = [*command(Path(PROGRAM), config), "--recordings", str(recordings)]
    flown = fly(Plan(words, Settings(port=port), legs=2, pattern=pattern), print)
    # The daemon's own limits; a busy machine makes the loop miss some ticks.
    assert [failure for failure in flown.failures if "missed" not in failure] == []
    assert flown.report is not None
    assert flown.report["released"]
    assert flown.report["recording"]["not_recorded"] == 0
    assert_replayed(fccd, recordings, flown)


def test_the_pattern_is_flown_by_the_phones_raw_sensors(
    fccd: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Airspeed and switch are the simulator's, as the thesis' were those of the servo board."""
    from fcc_hil.phoned import MOUNTING  # noqa: PLC0415 - needs the module fcc
    from fcc_hil.raw_flight import RAW_STANDBY_S  # noqa: PLC0415
    from fcc_hil.raw_sensors import FIELD_UT  # noqa: PLC0415

    assert PROGRAM is not None
    port, sensors_port, positions_port = free_port(), free_port(), free_port()
    monkeypatch.setenv("FAKE_LIBANDROID_PORT", str(sensors_port))
    monkeypatch.setenv("FCC_POSITIONS_PORT", str(positions_port))
    mountings = "".join(
        f'calibration.{sensor}.mounting = "{MOUNTING}"\n'
        for sensor in ("accelerometer", "gyroscope", "magnetometer")
    )
    pattern = TimedPattern(hold_s=5.0)
    config = write_config(
        tmp_path,
        port,
        guidance=f'mode = "timed-pattern"\nhold_s = {pattern.hold_s}',
        others=f'[navigation]\nmethod = "kalman"\nmagnetic_field_ut = {list(FIELD_UT)}\n'
        f'[[sensor]]\nkind = "phone"\n{mountings}',
    )
    recordings = tmp_path / "recordings"
    words = [*command(Path(PROGRAM), config), "--recordings", str(recordings)]
    settings = Settings(
        port=port,
        phone=(sensors_port, positions_port),
        frame_rate_hz=60.0,
        frame_rates_hz=None,
    )
    plan = Plan(words, settings, legs=2, pattern=pattern, steady_s=RAW_STANDBY_S, attempts=5)
    flown = fly(plan, print)
    assert [failure for failure in flown.failures if "missed" not in failure] == []
    assert flown.report is not None
    assert flown.report["released"]
    print(json.dumps(flown.figures))
    # The most of six flights in lockstep by the same sensors.
    for leg in flown.figures["legs"]:
        assert leg["altitude_rms_ft"] <= 6.2
        assert leg["airspeed_error_kt"] <= 13.9
        assert leg["heading_rms_deg"] <= 12.0
    assert_replayed(fccd, recordings, flown)


@pytest.mark.parametrize("by", ["the second process", "the next start"])
def test_x_plane_is_released_when_the_app_is_killed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, by: str
) -> None:
    """By its second process; or, if that is killed, too, as by a force stop, at the next start."""
    assert PROGRAM is not None
    recordings = tmp_path / "recordings"
    if by == "the second process":
        monkeypatch.setenv("FCC_RELEASE_HELPER", "1")
    with StandInProcess(Settings(port=0)) as simulator:
        config = write_config(tmp_path, simulator.port)
        words = [*command(Path(PROGRAM), config), "--recordings", str(recordings)]
        for _ in range(2):
            simulator.write(ENGAGE_SWITCH, 0.0)
            with Daemon(words) as app:
                engage(simulator)
                app.stop(signal.SIGKILL)
            simulator.write(ENGAGE_SWITCH, 0.0)
            if by == "the next start":
                time.sleep(2.0)
                assert simulator.progress().overridden
                monkeypatch.setenv("FCC_RELEASE_LEFT", "1")
                left = subprocess.run(words, check=True, capture_output=True, text=True)
                monkeypatch.delenv("FCC_RELEASE_LEFT")
                assert f"X-Plane at 127.0.0.1:{simulator.port} was released" in left.stdout
            wait_until(lambda: not simulator.progress().overridden, "released")
            wait_until(lambda: not (recordings / "held").exists(), "nothing is left")


def test_a_servo_board_centres_the_surfaces_of_an_app_that_is_killed(
    fccd: Path, tmp_path: Path
) -> None:
    assert PROGRAM is not None
    recordings = tmp_path / "recordings"
    with StandInProcess(Settings(port=0, board="udp")) as aircraft:
        config = tmp_path / "fccd.toml"
        config.write_text(
            f'[servo-board]\naddress = "127.0.0.1:{aircraft.board_port()}"\n'
            '[[sensor]]\nkind = "servo-board"\n'
            f'[[sensor]]\nkind = "x-plane"\nsimulator = "127.0.0.1:{aircraft.port}"\n'
            'engage_switch = "no/such/switch"\n'
            '[[actuator]]\nkind = "servo-board"\n'
        )
        words = [*command(Path(PROGRAM), config), "--recordings", str(recordings)]
        with Daemon(words) as app:
            engage_board(aircraft)
            time.sleep(3.0)
            app.stop(signal.SIGKILL)
        wait_until(
            lambda: aircraft.board_changes()[-1].control is Control.FAILSAFE,
            "the board is in failsafe",
            15.0,
        )
        change = aircraft.board_changes()[-1]
    assert change.driven == Controls()
    assert change.silent_before_s < FAILSAFE_AFTER_S <= change.silent_s
    # What was recorded until a second before is there.
    (recording,) = recordings.glob("*.mcap")
    result = replayed(fccd, recording, CUT_OFF)
    assert result["ticks"] > 2.0 * 40.0
    assert result["identity"]["differing"] == 0


def test_a_processor_without_a_library_is_told_so(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert PROGRAM is not None
    monkeypatch.setenv("FCC_ANDROID_LIBRARY", str(tmp_path))
    config = tmp_path / "fccd.toml"
    config.write_text("[built-in]\n")
    words = command(Path(PROGRAM), config)
    ended = subprocess.run(words, check=False, capture_output=True, text=True)
    assert ended.returncode != 0
    assert "no native library for this processor" in ended.stderr


def test_a_thousand_flights_take_no_memory(monkeypatch: pytest.MonkeyPatch) -> None:
    """The heap of Java is of one size, so that what remains is what native code has taken."""
    assert PROGRAM is not None
    monkeypatch.setenv("JAVA_TOOL_OPTIONS", "-Xms64m -Xmx64m -XX:+AlwaysPreTouch")
    words = [PROGRAM, "flights", "1000"]
    ended = subprocess.run(words, check=True, capture_output=True, text=True)
    after_ten_kib, after_all_kib = (int(line) for line in ended.stdout.split())
    print(f"after 10 flights {after_ten_kib} KiB, after 1,000 {after_all_kib} KiB")
    # What Java compiles meanwhile.
    assert after_all_kib - after_ten_kib < MOST_GROWTH_KIB


def engage(simulator: StandInProcess) -> None:
    """Move the simulator's switch until the app has control: it may not be ready at first."""
    for _ in range(15):
        simulator.write(ENGAGE_SWITCH, 0.0)
        time.sleep(1.0)
        simulator.write(ENGAGE_SWITCH, 1.0)
        time.sleep(1.0)
        if simulator.progress().overridden:
            return
    pytest.fail("not engaged within 30 s")


def engage_board(aircraft: StandInProcess) -> None:
    """Move the board's switch until the app has control: it may not be ready at first."""
    for _ in range(15):
        aircraft.write(ENGAGE_SWITCH, 0.0)
        time.sleep(1.0)
        aircraft.write(ENGAGE_SWITCH, 1.0)
        time.sleep(1.0)
        changes = aircraft.board_changes()
        if changes and changes[-1].control is Control.HELD:
            return
    pytest.fail("not engaged within 30 s")


def replayed(fccd: Path, recording: Path, exit_code: int = 0) -> Any:
    """Return what a replay of a recording finds."""
    words = [str(fccd), "replay", "--json", str(recording)]
    finished = subprocess.run(words, check=False, capture_output=True, text=True)
    assert finished.returncode == exit_code, finished.stderr
    return json.loads(finished.stdout)


def assert_replayed(fccd: Path, recordings: Path, flown: Flight) -> None:
    """Assert that the only recording is whole, and that a replay has the same bits."""
    assert flown.report is not None
    (recording,) = recordings.glob("*.mcap")
    result = replayed(fccd, recording)
    assert result["ticks"] == flown.report["timing"]["ticks"]
    assert result["identity"]["outputs"] > 0
    assert result["identity"]["differing"] == 0
