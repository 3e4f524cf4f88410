"""The autopilot step by step, in series, in fleets, and in the daemon's loop around a plant."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor

import fcc
import numpy as np
import pytest

HOLD = '[guidance]\nmode = "hold"\n'
KNOT_MPS = 1852 / 3600
FOOT_M = 0.3048


def flown(seconds: float, loop: fcc.Machine, aircraft: fcc.BuiltInAircraft) -> None:
    """Fly on by the loop."""
    surfaces = None
    for _ in range(round(seconds / loop.period_s)):
        measured = aircraft.step(surfaces, loop.period_s)
        surfaces = loop.step(measured, switch=aircraft.switch, readback=aircraft.controls)


def series(seconds: float = 10.0) -> np.ndarray:
    """Return the measurements of trimmed flight without control."""
    aircraft = fcc.BuiltInAircraft()
    return np.array([aircraft.step(None).to_array() for _ in range(round(seconds * 40))])


def engaged(config: str, measured: np.ndarray) -> fcc.Autopilot:
    autopilot = fcc.Autopilot(config)
    autopilot.observe_series(measured[:100])
    autopilot.engage(fcc.Measurements.from_array(measured[100]), throttle=0.6)
    return autopilot


def test_threads_use_one_autopilot_in_turn() -> None:
    autopilot, measured = fcc.Autopilot(HOLD), np.tile(series(), (50, 1))
    with ThreadPoolExecutor(3) as pool:
        runs = [pool.submit(autopilot.observe_series, measured) for _ in range(3)]
        looks = [autopilot.engaged for _ in range(100)]
        for run in runs:
            run.result()
    assert not any(looks)


def test_a_series_is_its_steps_to_the_last_bit() -> None:
    measured = series()
    one, other = engaged(HOLD, measured), engaged(HOLD, measured)
    rows = measured[101:]
    steps = [one.step(fcc.Measurements.from_array(row)).to_array() for row in rows]
    # Without a trim's position at engaging none is moved: NaN.
    assert np.array_equal(other.fly(rows), np.array(steps), equal_nan=True)
    assert other.fly(np.empty((0, len(fcc.MEASUREMENTS)))).shape == (0, len(fcc.SURFACES))


def test_a_fleet_is_its_autopilots_to_the_last_bit() -> None:
    configs = [HOLD, HOLD + "[autopilot.heading]\nroll_gain_per_s = 1.0\n"]
    measured = series()
    fleet = fcc.Fleet([configs[0], fcc.Config(configs[1])])
    for row in measured[:100]:
        fleet.observe([row, row])
    # Of the outputs that an aircraft need not have none is known.
    outputs = [0.6, 0.0, 0.0, 0.0] + [np.nan] * (len(fcc.SURFACES) - 4)
    fleet.engage([measured[100]] * 2, [outputs] * 2)
    both = np.array([fleet.step([row, row]) for row in measured[101:]])
    for n, config in enumerate(configs):
        alone = engaged(config, measured).fly(measured[101:])
        assert np.array_equal(both[:, n], alone, equal_nan=True)
    assert not np.array_equal(both[:, 0], both[:, 1], equal_nan=True)
    assert len(fleet) == 2
    assert fleet.setpoints.shape == (2, 6)


def test_the_loop_engages_by_its_switch_and_holds_the_captured_state() -> None:
    loop, aircraft = fcc.Machine(HOLD), fcc.BuiltInAircraft()
    flown(40.0, loop, aircraft)
    assert loop.state == "engaged"
    assert [event.text for event in loop.events()] == ["standby -> engaged", "mode: hold, was none"]
    # What the built-in aircraft begins with.
    assert loop.setpoints.altitude_m == pytest.approx(3_000 * FOOT_M, abs=15.0)
    assert aircraft.truth.altitude_m == pytest.approx(3_000 * FOOT_M, abs=15.0)
    assert aircraft.truth.indicated_airspeed_mps == pytest.approx(100 * KNOT_MPS, abs=2.0)
    records = loop.records()
    assert len(records) == 1_600
    assert records.dtype == fcc.RECORD
    assert np.array_equal(records["tick"], np.arange(1, 1_601))


def test_commands_change_the_set_points() -> None:
    loop, aircraft = fcc.Machine(HOLD), fcc.BuiltInAircraft()
    flown(5.0, loop, aircraft)
    loop.command(heading_rad=1.0, altitude_m=930.0)
    flown(60.0, loop, aircraft)
    assert loop.estimate.heading_rad == pytest.approx(1.0, abs=np.radians(2.0))
    assert aircraft.truth.altitude_m == pytest.approx(930.0, abs=6.0)
    loop.disengage()
    flown(0.1, loop, aircraft)
    assert loop.state == "standby"


def test_a_sensor_that_breaks_leads_to_failsafe_after_its_age() -> None:
    """Failsafe comes after 250 ms; without degraded flight it releases after 5 s."""
    config = HOLD + "[failsafe]\ndegraded_s = 0.0\n"
    loop, aircraft = fcc.Machine(config), fcc.BuiltInAircraft()
    flown(10.0, loop, aircraft)
    broke_s, surfaces, failed_s = loop.time_s, None, 0.0
    while loop.state != "standby":
        surfaces = loop.step(aircraft.step(surfaces), switch=True, missing=["airspeed"])
        if loop.state == "failsafe" and not failed_s:
            failed_s = loop.time_s
            assert loop.faults == ["airspeed is missing or too old"]
        assert loop.time_s < broke_s + 10.0
    assert failed_s - broke_s == pytest.approx(0.275, abs=0.001)
    assert loop.time_s - failed_s == pytest.approx(5.0, abs=0.03)
    texts = [event.text for event in loop.events()]
    assert "engaged -> failsafe: airspeed is missing or too old" in texts
    assert surfaces is None


def test_missing_sensors_are_reported() -> None:
    config = HOLD + "[failsafe]\nall_silent_s = 0.25\n"
    loop, aircraft = fcc.Machine(config), fcc.BuiltInAircraft()
    flown(10.0, loop, aircraft)
    for _ in range(10):
        loop.step(None)
        assert loop.state == "engaged"
    loop.step(None)
    assert loop.state == "failsafe"
    assert "sensor-fault" in [event.kind for event in loop.events()]


def test_a_stop_is_final() -> None:
    loop = fcc.Machine(HOLD)
    loop.stop()
    assert loop.step(None) is None
    assert loop.state == "stopped"
    assert loop.step(None) is None


def test_engaging_is_refused_with_the_reason() -> None:
    loop = fcc.Machine()
    loop.engage()
    loop.step(None)
    assert loop.state == "standby"
    assert "attitude is missing or too old" in loop.engage_inhibits
    assert any(event.kind == "engage-refused" for event in loop.events())


def test_a_configuration_by_its_keys() -> None:
    config = fcc.Config(HOLD)
    bank = "autopilot.envelope.max_bank_deg"
    assert config["guidance.mode"] == "hold"
    assert bank in config
    assert {bank, "loop.timer"} <= set(config.keys())
    steep = config.replace({bank: 45, "loop.rate_hz": np.float64(100.0)})
    assert steep[bank] == 45.0
    assert fcc.Machine(steep).period_s == pytest.approx(0.01)
    assert config[bank] != 45.0
    assert fcc.Config(steep.to_toml()) == steep
    assert steep.to_dict()["autopilot"]["envelope"]["max_bank_deg"] == 45.0
    pattern = config.replace({"guidance": {"mode": "timed-pattern", "leg_s": 30.0}})
    assert pattern["guidance"]["leg_s"] == 30.0
