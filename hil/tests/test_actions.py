"""What a person or the simulator does: by name, and by X-Plane's own commands."""

from __future__ import annotations

import math
from collections.abc import Iterator

import pytest
from standin_bench import Bench

from fcc_hil.__main__ import main
from fcc_hil.actions import ACTIONS, parse
from fcc_hil.cockpit import (
    GENERIC_LIGHTS,
    OVERRIDE_JOYSTICK,
    OVERRIDE_THROTTLES,
    PROPELLER_MODE,
    SERVOS_ON,
    THROTTLE_LEVER,
    THROTTLE_USE,
    YOKE_ROLL,
)
from fcc_hil.state import Controls

TIME = "sim/time/total_flight_time_sec"
PAUSED = "sim/time/paused"
REPLAY = "sim/time/is_in_replay"
SPEED = "sim/time/sim_speed"
ALTIMETER = "sim/cockpit2/gauges/indicators/altitude_ft_pilot"
KNOB = "sim/cockpit2/gauges/actuators/barometer_setting_in_hg_pilot"
PRESSURE_ALTITUDE = "sim/flightmodel2/position/pressure_altitude"
ON_GROUND = "sim/flightmodel/failures/onground_any"
LATITUDE = "sim/flightmodel/position/latitude"
ROLL = "sim/flightmodel/position/phi"
TRUE_ROLL = "sim/flightmodel/position/true_phi"
AIRSPEED = "sim/flightmodel/position/indicated_airspeed"
GROUNDSPEED = "sim/flightmodel/position/groundspeed"
TOTAL_ROLL = "sim/cockpit2/controls/total_roll_ratio"


@pytest.fixture
def bench() -> Iterator[Bench]:
    made = Bench(version=121_000)
    made.client.subscribe(1, TIME)
    made.client.subscribe(2, PAUSED)
    made.frames(60)
    yield made
    made.close()


def test_a_freeze_stops_everything_and_ends_with_one_frame(bench: Bench) -> None:
    before = bench.frames(1)
    bench.act("freeze:1.5")
    bench.client.write(f"{GENERIC_LIGHTS}[7]", 1.0)
    assert bench.frames(89) == {}, "for 89 of 60 frames a second"
    assert bench.simulator.cockpit.read(f"{GENERIC_LIGHTS}[7]") == 0.0, "it is not read"
    after = bench.frames(1)
    # One frame moves the aircraft by at most 1/19 s, however long it took.
    assert after[1] - before[1] == pytest.approx(1.0 / 19.0, abs=0.01)
    assert bench.simulator.cockpit.read(f"{GENERIC_LIGHTS}[7]") == 1.0
    assert bench.frames(60)[1] - after[1] == pytest.approx(1.0, abs=0.01)


def test_a_freeze_in_a_pause_ends_in_the_pause(bench: Bench) -> None:
    bench.act("pause")
    bench.act("freeze:0.5")
    assert bench.frames(60)[2] == 1.0


def test_a_cut_link_loses_all_and_the_aircraft_flies_on(bench: Bench) -> None:
    before = bench.frames(1)
    bench.act("cut:1")
    bench.client.write(f"{GENERIC_LIGHTS}[7]", 1.0)
    assert bench.frames(59) == {}
    after = bench.frames(1)
    assert after[1] - before[1] == pytest.approx(1.0, abs=1e-3)
    assert bench.simulator.cockpit.read(f"{GENERIC_LIGHTS}[7]") == 0.0, "it was lost"


@pytest.mark.parametrize("window", ["map", "menu", "alert"])
def test_an_open_window_stops_time_without_a_pause(bench: Bench, window: str) -> None:
    before = bench.frames(1)
    bench.act(f"{window}:2")
    assert bench.frames(119) == {1: before[1], 2: 0.0}
    assert bench.frames(61)[1] - before[1] == pytest.approx(1.0, abs=0.02)


def test_a_window_may_stop_the_data_too() -> None:
    bench = Bench(sends_while_stalled=False)
    bench.client.subscribe(1, TIME)
    bench.frames(10)
    bench.act("map")
    assert bench.frames(10) == {}
    bench.act("run")
    assert bench.frames(1) != {}
    bench.close()


def test_a_replay_shows_the_past_and_the_flight_goes_on_where_it_was(bench: Bench) -> None:
    bench.simulator.cockpit.hold(Controls(aileron=0.3, throttle=0.7))
    bench.frames(60)
    time_s, roll_deg = bench.read(TIME), bench.read(TRUE_ROLL)
    bench.act("replay:1.5")
    first = bench.frames(1)
    assert bench.read(REPLAY) == 1.0
    assert bench.read(PAUSED) == 0.0
    assert first[1] < 0.1
    assert abs(bench.read(TRUE_ROLL)) < 1.0 < roll_deg
    assert bench.frames(60)[1] - first[1] == pytest.approx(1.0, abs=0.02)
    bench.frames(29)
    assert bench.read(REPLAY) == 0.0
    assert bench.read(TIME) == pytest.approx(time_s, abs=0.05)


def test_the_clock_of_a_replay_may_stand_still() -> None:
    bench = Bench(replays_clock=False)
    bench.frames(60)
    time_s, north_deg = bench.read(TIME), bench.read(LATITUDE)
    bench.act("replay")
    bench.frames(10)
    assert bench.read(TIME) == time_s
    assert bench.read(LATITUDE) < north_deg
    bench.close()


def test_a_reload_puts_the_aircraft_on_a_runway_and_clears_the_overrides(bench: Bench) -> None:
    bench.client.write(OVERRIDE_JOYSTICK, 1.0)
    bench.client.write(OVERRIDE_THROTTLES, 1.0)
    bench.client.write(f"{THROTTLE_USE}[0]", 0.9)
    bench.client.write(f"{GENERIC_LIGHTS}[63]", 1.0)
    bench.frames(2)
    latitude_deg = bench.read(LATITUDE)
    bench.act("reload")
    assert bench.read(OVERRIDE_JOYSTICK) == bench.read(OVERRIDE_THROTTLES) == 0.0
    assert bench.read(f"{THROTTLE_USE}[0]") == 0.0
    assert bench.read(ON_GROUND) == 1.0
    assert bench.read(GROUNDSPEED) < 0.1
    assert abs(bench.read(LATITUDE) - latitude_deg) > 0.1
    assert bench.read(f"{GENERIC_LIGHTS}[63]") == 1.0, "a client must notice by itself"
    assert bench.frames(1)[1] < 0.1, "the clock begins again"
    bench.frames(120)
    assert bench.read(GROUNDSPEED) < 0.5


def test_a_reload_in_the_air_stays_there(bench: Bench) -> None:
    bench.client.write(OVERRIDE_JOYSTICK, 1.0)
    bench.frames(2)
    latitude_deg = bench.read(LATITUDE)
    bench.act("map")
    bench.act("reload-air")
    assert bench.frames(60)[1] == pytest.approx(1.0, abs=0.02), "no window is open"
    assert bench.read(OVERRIDE_JOYSTICK) == 0.0
    assert bench.read(ON_GROUND) == 0.0
    # A second at 54 m/s to the north.
    assert bench.read(LATITUDE) == pytest.approx(latitude_deg + 0.00049, abs=1e-5)
    bench.client.write(OVERRIDE_JOYSTICK, 1.0)
    bench.frames(2)
    bench.act("relocate")
    assert bench.read(OVERRIDE_JOYSTICK) == 1.0
    assert bench.read(LATITUDE) - latitude_deg > 0.1


def test_the_knob_moves_the_altimeter_and_not_the_pressure(bench: Bench) -> None:
    before_ft, pressure_ft = bench.read(ALTIMETER), bench.read(PRESSURE_ALTITUDE)
    # 14 CFR 43, appendix E, table IV: differences of altitude by altimeter setting.
    for inhg, difference_ft in ((28.50, -1340.0), (29.50, -392.0), (30.50, 531.0), (30.99, 974.0)):
        bench.act(f"knob:{inhg}")
        assert bench.read(ALTIMETER) - before_ft == pytest.approx(difference_ft, abs=3.0)
    assert bench.read(PRESSURE_ALTITUDE) == pytest.approx(pressure_ft, abs=0.1)


def test_the_pressure_at_sea_level_changes_slowly(bench: Bench) -> None:
    before_ft = bench.read(PRESSURE_ALTITUDE)
    bench.act("qnh:30.02")
    bench.frames(60)
    assert bench.read("sim/weather/barometer_sealevel_inhg") == pytest.approx(29.93, abs=0.002)
    bench.frames(600)
    assert bench.read("sim/weather/barometer_sealevel_inhg") == pytest.approx(30.02)
    assert bench.read("sim/weather/aircraft/qnh_pas") == pytest.approx(101_659.0, abs=1.0)
    # 0.1 inHg is about 90 ft at 3,000 ft.
    assert bench.read(PRESSURE_ALTITUDE) - before_ft == pytest.approx(-90.0, abs=5.0)


def test_the_origin_moves_and_the_aircraft_does_not(bench: Bench) -> None:
    roll_deg, true_deg = bench.read(ROLL), bench.read(TRUE_ROLL)
    position_m = bench.read("sim/flightmodel/position/local_x")
    bench.act("origin")
    assert abs(bench.read(ROLL) - roll_deg) == pytest.approx(1.0, abs=0.1)
    assert bench.read(TRUE_ROLL) == true_deg
    # A degree of longitude at the equator is 111.3 km.
    moved_m = bench.read("sim/flightmodel/position/local_x") - position_m
    assert abs(moved_m) == pytest.approx(111_319.0, rel=0.01)


def test_the_simulators_autopilot_moves_the_controls_and_not_the_yoke(bench: Bench) -> None:
    bench.simulator.cockpit.hold(Controls(aileron=0.2, throttle=0.7))
    bench.frames(60)
    bench.act("servos")
    bench.frames(1)
    assert bench.read(YOKE_ROLL) == pytest.approx(0.2)
    assert bench.read("sim/joystick/servo_roll_ratio") < -0.05
    total = bench.read(TOTAL_ROLL)
    assert total == pytest.approx(0.2 + bench.read("sim/joystick/servo_roll_ratio"))
    # A client can only read it.
    bench.client.write(SERVOS_ON, 0.0)
    bench.frames(1)
    assert bench.read(SERVOS_ON) == 1.0
    bench.act("servos:0")
    bench.frames(1)
    assert bench.read(TOTAL_ROLL) == pytest.approx(0.2)


def test_another_plugin_writes_the_yoke_under_the_override(bench: Bench) -> None:
    bench.act("writer:1")
    bench.frames(15)
    assert bench.read(YOKE_ROLL) == 0.0
    bench.client.write(OVERRIDE_JOYSTICK, 1.0)
    bench.client.write(YOKE_ROLL, 0.0)
    bench.frames(15)
    assert abs(bench.read(YOKE_ROLL)) > 0.1
    bench.frames(60)
    bench.client.write(YOKE_ROLL, 0.0)
    bench.frames(1)
    assert bench.read(YOKE_ROLL) == 0.0


def test_time_runs_twice_as_fast(bench: Bench) -> None:
    bench.act("speed:2")
    before = bench.frames(1)
    assert bench.frames(60)[1] - before[1] == pytest.approx(2.0, abs=0.01)
    assert bench.read(SPEED) == bench.read("sim/time/sim_speed_actual") == 2.0
    bench.client.write(SPEED, 0.0)
    assert bench.frames(2)[2] == 1.0, "0 is a pause"


def test_fewer_frames_than_19_are_reported(bench: Bench) -> None:
    bench.act("fps:9.5")
    bench.frames(20)
    assert bench.read("sim/time/sim_speed_actual") == 1.0
    assert bench.read("sim/time/sim_speed_actual_ogl") == pytest.approx(0.5)
    assert bench.read("sim/time/framerate_period") == pytest.approx(1 / 9.5, rel=0.05)


def test_reverse_and_the_lever(bench: Bench) -> None:
    bench.act("lever:0.4")
    assert bench.read(f"{THROTTLE_USE}[0]") == pytest.approx(0.4)
    bench.act("reverse")
    assert bench.read(f"{PROPELLER_MODE}[0]") == 3.0
    assert bench.read(f"{THROTTLE_USE}[0]") == pytest.approx(-0.4)
    bench.act("reverse:0")
    bench.client.write(OVERRIDE_THROTTLES, 1.0)
    bench.client.write(f"{THROTTLE_USE}[0]", 1.1)
    bench.frames(1)
    bench.act("lever:0.2")
    assert bench.read(f"{THROTTLE_LEVER}[0]") == pytest.approx(0.2)
    assert bench.read(f"{THROTTLE_USE}[0]") == pytest.approx(1.1)
    bench.client.write(OVERRIDE_THROTTLES, 0.0)
    bench.frames(1)
    assert bench.read(f"{THROTTLE_USE}[0]") == pytest.approx(0.2), "back to the lever"


def test_ice_takes_the_airspeed_indicator(bench: Bench) -> None:
    before_kt, true = bench.read(AIRSPEED), bench.read("sim/flightmodel/position/true_airspeed")
    bench.act("ice:0.5")
    assert bench.read(AIRSPEED) == pytest.approx(0.5 * before_kt)
    assert bench.read("sim/flightmodel/position/true_airspeed") == true


@pytest.mark.parametrize(
    ("commands", "path", "expected"),
    [
        (["sim/operation/pause_toggle"], PAUSED, 1.0),
        (["sim/operation/pause_toggle"] * 2, PAUSED, 0.0),
        (["sim/replay/replay_toggle"], REPLAY, 1.0),
        (["sim/replay/replay_toggle", "sim/replay/replay_off"], REPLAY, 0.0),
        (["sim/instruments/barometer_up"] * 3, KNOB, 29.951),
        (["sim/instruments/barometer_down", "sim/instruments/barometer_2992"], KNOB, 29.921),
        (["sim/autopilot/servos_on"], SERVOS_ON, 1.0),
        (["sim/autopilot/servos_on", "sim/autopilot/servos_off_any"], SERVOS_ON, 0.0),
        (["sim/operation/flightmodel_speed_change"], SPEED, 2.0),
        (["sim/operation/flightmodel_speed_change"] * 3, SPEED, 1.0),
        (["sim/operation/go_to_default"], ON_GROUND, 1.0),
        (["sim/engines/thrust_reverse_toggle"], f"{PROPELLER_MODE}[0]", 3.0),
        (["sim/lights/generic_64_light_tog"], f"{GENERIC_LIGHTS}[63]", 1.0),
        (["sim/lights/generic_64_light_on", "sim/no/such"], f"{GENERIC_LIGHTS}[63]", 1.0),
        (["sim/lights/generic_01_light_tog"] * 2, f"{GENERIC_LIGHTS}[0]", 0.0),
    ],
)
def test_x_planes_own_commands(
    bench: Bench, commands: list[str], path: str, expected: float
) -> None:
    for command in commands:
        bench.client.command(command)
    bench.frames(1)
    assert bench.read(path) == pytest.approx(expected, abs=1e-3)


def test_the_map_is_opened_and_closed_by_command(bench: Bench) -> None:
    before = bench.frames(1)
    bench.client.command("sim/map/show_current")
    assert bench.frames(30)[1] == before[1]
    bench.client.command("sim/map/show_current")
    assert bench.frames(30)[1] - before[1] == pytest.approx(0.5, abs=1e-3)


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("frob", "'frob' is no action: give one of run, pause"),
        ("run:3", "takes nothing after it"),
        ("knob", "give knob:INHG with 20 to 32"),
        ("knob:1013", "give knob:INHG with 20 to 32"),
        ("freeze:soon", "give freeze:SECONDS"),
        ("cut:nan", "give cut:SECONDS"),
        ("speed:-1", "give speed:RATIO"),
    ],
)
def test_a_wrong_action_is_refused_with_what_can_be_given(
    text: str, why: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(ValueError, match=why):
        parse(text)
    with pytest.raises(SystemExit):
        main(["standin", "--at", f"3:{text}"])
    assert why in " ".join(capsys.readouterr().err.split())


def test_the_command_line_acts_at_its_times(capsys: pytest.CaptureFixture[str]) -> None:
    words = ["standin", "--port", "0", "--seconds", "0.6", "--at", "0.3:knob:30.22"]
    assert main([*words, "--at", "0.1:freeze:0.1", "--at", "0.4:pause"]) == 0
    first, *done = capsys.readouterr().out.splitlines()
    assert "and sends from port" in first
    acted = [line.partition(" s: ")[2] for line in done if " s: " in line]
    assert acted == ["freeze:0.1", "knob:30.22", "pause"]
    assert '"mode": "paused"' in "".join(done)


def test_every_action_can_be_written_as_its_help_says(bench: Bench) -> None:
    for name, action in ACTIONS.items():
        argument = action.argument
        needed = argument.name and argument.otherwise is None
        bench.act(f"{name}:{argument.least:g}" if needed else name)
        bench.act("run")
        bench.frames(1)
    assert math.isfinite(bench.read(ALTIMETER))
