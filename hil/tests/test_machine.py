"""The daemon's own loop from Python: states, messages, recording."""

from __future__ import annotations

import math
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import fcc
import pytest
from hypothesis import given
from hypothesis import strategies as st
from recordings import EVENT, RECORD, by_index, metadata

from fcc_hil.lockstep import measurements
from fcc_hil.plant import Plant

HOLD = '[guidance]\nmode = "hold"\n'
READBACK = (0.6, 0.0, 0.0, 0.0)
SENSORS = ("attitude", "heading", "body_rates", "specific_force", "airspeed", "altitude")

bad_numbers = st.sampled_from([math.nan, math.inf, -math.inf])


@pytest.fixture(scope="module")
def level() -> fcc.Measurements:
    """Return the measurements of a trimmed Cessna."""
    return measurements(Plant("c172p").state())


def _watch(
    machine: fcc.Machine, level: fcc.Measurements, seconds: float, *, switch: bool | None = False
) -> None:
    for _ in range(round(seconds / machine.period_s)):
        machine.step(level, readback=READBACK, switch=switch)


def _switch_on(machine: fcc.Machine, level: fcc.Measurements) -> None:
    """Give the two readings with which a position counts."""
    assert machine.step(level, readback=READBACK, switch=True) is None
    assert machine.step(level, readback=READBACK, switch=True) is not None


def _texts(machine: fcc.Machine) -> list[str]:
    return [event.text for event in machine.events() if not event.text.startswith("mode: ")]


def test_it_engages_and_releases_by_the_switch(level: fcc.Measurements) -> None:
    machine = fcc.Machine(HOLD)
    assert (machine.state, machine.tick, machine.time_s) == ("standby", 0, 0.0)
    _watch(machine, level, 2.0)
    assert (machine.state, machine.tick, machine.engage_inhibits) == ("standby", 80, [])
    assert machine.time_s == pytest.approx(2.0)
    assert machine.step(level, readback=READBACK, switch=True) is None, "one may be wrong"
    surfaces = machine.step(level, readback=READBACK, switch=True)
    assert surfaces is not None
    assert surfaces.throttle == pytest.approx(READBACK[0], abs=0.05), "no bump"
    assert (machine.state, machine.holds_control) == ("engaged", True)
    assert machine.step(level, readback=READBACK, switch=False) is not None, "one may be wrong"
    assert machine.step(level, readback=READBACK, switch=False) is None
    assert (machine.state, machine.holds_control) == ("standby", False)
    assert _texts(machine) == [
        "standby -> engaged",
        "engaged -> standby",
        "release sent to the actuators",
    ]
    assert _texts(machine) == [], "each is told once"


def test_engage_inhibits_are_reported(level: fcc.Measurements) -> None:
    machine = fcc.Machine(HOLD)
    machine.engage()
    assert machine.step(level) is None
    assert _texts(machine) == [
        "command: engage",
        "not engaged: navigation is settling: engage again some seconds later",
    ]
    assert machine.engage_inhibits == ["navigation is settling: engage again some seconds later"]


@pytest.mark.parametrize(
    ("quantity", "factor", "offset", "contradicted"),
    [
        pytest.param("specific_force_z_mps2", 1 / 9.80665, 0.0, "vertical", id="in g"),
        pytest.param("specific_force_z_mps2", 1 / 0.3048, 0.0, "vertical", id="in ft/s2"),
        pytest.param("specific_force_z_mps2", -1.0, 0.0, "vertical", id="upwards"),
        pytest.param("pitch_rad", 1.0, math.radians(5.0), "forward", id="pitch + 5"),
        pytest.param("pitch_rad", 1.0, math.radians(-5.0), "forward", id="pitch - 5"),
    ],
)
def test_sensors_that_contradict_each_other_are_not_engaged(
    quantity: str, factor: float, offset: float, contradicted: str
) -> None:
    aircraft, machine = fcc.BuiltInAircraft(), fcc.Machine(HOLD)
    for _ in range(200):
        measured = aircraft.step(None, machine.period_s)
        setattr(measured, quantity, getattr(measured, quantity) * factor + offset)
        machine.step(measured, switch=False, readback=READBACK)
    assert [text.startswith(contradicted) for text in machine.engage_inhibits] == [True]


@pytest.mark.parametrize("sensor", SENSORS)
def test_a_sensor_that_is_missing_for_longer_than_allowed_is_a_failsafe(
    level: fcc.Measurements, sensor: str
) -> None:
    """250 ms by default, and a second of failsafe by this configuration."""
    machine = fcc.Machine(HOLD + "[failsafe]\nhold_s = 1.0\ndegraded_s = 0.0\n")
    _watch(machine, level, 2.0)
    _switch_on(machine, level)
    for _ in range(10):
        machine.step(level, missing=[sensor], readback=READBACK, switch=True)
        assert machine.state == "engaged"
    machine.step(level, missing=[sensor], readback=READBACK, switch=True)
    assert machine.state == "failsafe"
    words = {"body_rates": "body rates are", "specific_force": "acceleration is"}
    assert machine.faults == [f"{words.get(sensor, sensor + ' is')} missing or too old"]
    for _ in range(39):
        assert machine.step(level, missing=[sensor], switch=True) is not None
    assert machine.step(level, missing=[sensor], switch=True) is None
    assert (machine.state, machine.holds_control) == ("standby", False)


def test_no_measurements_are_a_silent_sensor(level: fcc.Measurements) -> None:
    machine = fcc.Machine(HOLD)
    _watch(machine, level, 2.0)
    _switch_on(machine, level)
    machine.step()
    machine.step(level, readback=READBACK, switch=True)
    assert _texts(machine) == [
        "standby -> engaged",
        "sensor lockstep: nothing arrives",
        "sensor lockstep: works again",
    ]


def test_commands_set_the_set_points(level: fcc.Measurements) -> None:
    machine = fcc.Machine(HOLD)
    _watch(machine, level, 2.0, switch=None)
    machine.engage()
    machine.step(level, readback=READBACK)
    machine.command(heading_rad=1.0, altitude_m=1_000.0, airspeed_mps=50.0)
    machine.step(level)
    aims = machine.setpoints
    assert (aims.heading_rad, aims.altitude_m, aims.airspeed_mps) == (1.0, 1_000.0, 50.0)
    machine.disengage()
    assert machine.step(level) is None
    machine.stop()
    machine.step(level)
    assert machine.state == "stopped"
    assert machine.step(level) is None
    with pytest.raises(RuntimeError, match="stopped"):
        machine.engage()


def test_it_records_as_the_daemon_does(level: fcc.Measurements, tmp_path: Path) -> None:
    """Read back by PyPI's mcap, which knows nothing of us."""
    machine = fcc.Machine(HOLD)
    _watch(machine, level, 2.0)
    _switch_on(machine, level)
    files = machine.record_to(tmp_path / "flights", aircraft="a Cessna", ending="enough")
    assert [path.parent for path in files] == [tmp_path / "flights"]
    messages = by_index(files[0])
    assert sum(message.topic == RECORD for message in messages) == 82
    # Engaged, and the mode that began with it.
    assert sum(message.topic == EVENT for message in messages) == 2
    log = metadata(files[0])
    assert log["fcc.recording"]["plant"] == "a Cessna"
    assert log["fcc.end"]["ending"] == "enough"


def test_a_machine_is_read_while_it_records(level: fcc.Measurements, tmp_path: Path) -> None:
    machine = fcc.Machine(HOLD)
    _watch(machine, level, 50.0)
    with ThreadPoolExecutor(1) as pool:
        recording = pool.submit(machine.record_to, tmp_path)
        while not recording.done():
            assert machine.state == "standby"
            machine.step(level, readback=READBACK, switch=False)
    assert len(recording.result()) == 1
    assert machine.tick > 2_000


def test_a_folder_that_cannot_be_written_to_is_an_error(level: fcc.Measurements) -> None:
    machine = fcc.Machine(HOLD)
    machine.step(level)
    with pytest.raises(OSError, match="/proc/none"):
        machine.record_to("/proc/none")


@given(value=bad_numbers, name=st.sampled_from(["airspeed_mps", "heading_rad", "altitude_m"]))
def test_commands_that_are_not_finite_are_refused(value: float, name: str) -> None:
    with pytest.raises(ValueError, match=f"{name} is .*finite"):
        fcc.Machine(HOLD).command(**{name: value})


@given(
    readback=st.tuples(*[st.floats(allow_nan=True)] * 4).filter(
        lambda s: not (0.0 <= s[0] <= 1.0 and all(-1.0 <= value <= 1.0 for value in s[1:]))
    )
)
def test_impossible_controls_are_refused(
    readback: tuple[float, float, float, float],
) -> None:
    machine = fcc.Machine(HOLD)
    with pytest.raises(ValueError, match=r"is .*: choose -?[01] to 1"):
        machine.step(readback=readback)
    assert machine.tick == 0, "no half a tick"


def _readings() -> list[str]:
    """Return the names of all readings, by the message that lists them."""
    with pytest.raises(ValueError, match="choose of") as refused:
        fcc.Machine(HOLD).step(missing=["?"])
    return str(refused.value).partition("choose of ")[2].split(", ")


READINGS = _readings()


@given(name=st.text().filter(lambda name: name not in READINGS))
def test_sensors_that_do_not_exist_are_refused(name: str) -> None:
    with pytest.raises(ValueError, match=r"(?s)there is no reading .*attitude, heading"):
        fcc.Machine(HOLD).step(missing=[name])


def test_a_configuration_that_is_wrong_is_refused_with_its_line() -> None:
    with pytest.raises(ValueError, match=r"config:2: .*failsafe\.hold_s"):
        fcc.Machine("[failsafe]\nhold_s = -1.0\n")
