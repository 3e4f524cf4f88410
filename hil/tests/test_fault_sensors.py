"""Faults of single sensors: silent, frozen, wrong, jumping, late.

One flight for each of the six quantities that control needs, all at the same time. In each the
faults follow one another: engaged, fault, detected, restored, engaged again.
"""

from __future__ import annotations

import functools
import itertools
import math
import signal
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
from daemon_under_test import DaemonUnderTest, Ending, start, switch_on, write_config
from fault_flights import (
    ENGAGED,
    FAILSAFE,
    NS,
    STANDBY,
    Flown,
    assert_flown_again,
    at_once,
    seconds,
)
from tampered_link import TamperedLink

from fcc_hil.faulty_sensors import Kind, SensorFault
from fcc_hil.fly import ENGAGE_SWITCH
from fcc_hil.process import StandInProcess
from fcc_hil.quantities import SENSORS
from fcc_hil.standin import Settings

MAX_AGE_S = 0.6
"""Older readings are lost; more than the default, because a busy machine is late now and then."""
FROZEN_S = 2.0
"""The daemon's default: constant for this time, while the aircraft moves, is frozen."""

# A pattern that turns and climbs soon after engaging, so that a frozen sensor is detected.
PATTERN = 'mode = "timed-pattern"\nhold_s = 1.0\nleg_s = 20.0'
PATIENT = f"[failsafe]\nsensor_max_age_ms = {MAX_AGE_S * 1e3:.0f}\n"
FLOWN_THROUGH_S = 3.0
SHORT_S = 0.1
"""A jump back so soon is none: six frames, and a sixth of what may be missing."""

P = "sim/flightmodel/position/"


@dataclass(frozen=True)
class Sensor:
    """A quantity, and its implausible values."""

    missing: str
    """The daemon's message without valid readings."""
    frozen: str | None
    value: Callable[[Any], tuple[float, ...]]
    """Of a record."""
    impossible: Mapping[str, float]
    """Datarefs and values, finite and out of range."""
    infinite: Mapping[str, float]
    jump: float
    """In SI units: at once, and within the range."""
    stands_still: float = 1e-5
    """How little a frozen value changes, in SI units."""


def _one(name: str) -> Callable[[Any], tuple[float, ...]]:
    return lambda record: (getattr(record.measurements, name).value,)


def _three(name: str, *axes: str) -> Callable[[Any], tuple[float, ...]]:
    return lambda record: tuple(
        getattr(getattr(record.measurements, name).value, axis) for axis in axes
    )


SENSED: dict[str, Sensor] = {
    "attitude": Sensor(
        "attitude is missing or too old",
        "attitude is frozen",
        _three("attitude", "pitch_rad", "roll_rad"),
        {P + "theta": 95.0},
        {P + "phi": math.inf},
        jump=math.radians(45.0),
    ),
    "heading": Sensor(
        "heading is missing or too old",
        "heading is frozen",
        _one("heading_rad"),
        {P + "mag_psi": 1e4},
        {P + "mag_psi": -math.inf},
        jump=math.radians(90.0),
    ),
    "body_rates": Sensor(
        "body rates are missing or too old",
        "body rates ",  # Frozen, or before that in contradiction to the attitude.
        _three("body_rates", "roll_radps", "pitch_radps", "yaw_radps"),
        {P + "Prad": 60.0},
        {P + "Rrad": math.inf},
        jump=3.0,
    ),
    "specific_force": Sensor(
        "acceleration is missing or too old",
        "acceleration is frozen",
        _three("specific_force", "x_mps2", "y_mps2", "z_mps2"),
        {P + "local_ay": 2_000.0},
        {P + "local_ax": math.inf},
        jump=60.0,
        # It is computed from accelerations along axes that are level some kilometres away.
        stands_still=0.01,
    ),
    "airspeed": Sensor(
        "airspeed is missing or too old",
        "airspeed is frozen",
        _one("airspeed_mps"),
        {P + "indicated_airspeed": -5_000.0},
        {P + "indicated_airspeed": math.inf},
        jump=40.0,
    ),
    "altitude": Sensor(
        "altitude is missing or too old",
        None,  # One that stands is one that differs: `test_air_data.py`.
        _one("altitude_m"),
        {"sim/cockpit2/gauges/indicators/altitude_ft_pilot": 2e6},
        {"sim/cockpit2/gauges/indicators/altitude_ft_pilot": math.inf},
        jump=300.0,
    ),
}
HARMLESS = ("reordered", "a little late", "a short jump")
LOSSES = ("silent", "nan", "infinite", "out of range", "jumping", "late")
FAULTS = {name: (*LOSSES, *(["frozen"] if one.frozen else [])) for name, one in SENSED.items()}


def test_the_sensors_are_those_that_control_needs() -> None:
    assert set(SENSED) == set(SENSORS)


class Breaking:
    """A flight with one fault of a sensor after the other."""

    def __init__(
        self, name: str, simulator: StandInProcess, link: TamperedLink, daemon: DaemonUnderTest
    ) -> None:
        self.name = name
        self.simulator = simulator
        self.link = link
        self.daemon = daemon

    def put_in(self, fault: str) -> None:
        sensor = SENSED[self.name]
        if fault == "out of range":
            self.link.replace_values(sensor.impossible)
        elif fault == "infinite":
            self.link.replace_values(sensor.infinite)
        else:
            made = {
                "silent": (Kind.LOSS, 0.0),
                "nan": (Kind.NAN, 0.0),
                "jumping": (Kind.BIAS, sensor.jump),
                "a short jump": (Kind.BIAS, sensor.jump),
                "late": (Kind.DELAY, 3 * MAX_AGE_S),
                "frozen": (Kind.FREEZE, 0.0),
                "a little late": (Kind.DELAY, 0.05),
                "reordered": (Kind.REORDER, 0.0),
            }
            kind, amount = made[fault]
            share = 0.5 if kind is Kind.REORDER else 1.0
            begins_s, ends_s = 0.0, math.inf
            if fault == "a short jump":
                # Far enough ahead that it is received in time.
                begins_s = self.simulator.progress().time_s + 1.0
                ends_s = begins_s + SHORT_S
            channels = SENSORS[self.name]
            self.simulator.set_sensor_faults(
                [SensorFault(kind, self.name, channels, begins_s, ends_s, amount, share)]
            )

    def restore(self) -> None:
        self.link.restore()
        self.simulator.set_sensor_faults([])

    def engage(self) -> None:
        switch_on(self.simulator, self.daemon)

    def disengage(self) -> None:
        self.simulator.write(ENGAGE_SWITCH, 0.0)
        self.daemon.wait_for("-> standby")


def fly(fccd: Path, scratch: Path, name: str) -> Ending:
    """Fly one sensor through all of its faults."""
    scratch.mkdir()
    # About local axes that are not level, a frozen specific force turns with the heading.
    level = Settings(port=0, origin_offset_deg=(0.0, 0.0))
    with (
        StandInProcess(level) as simulator,
        TamperedLink(simulator.port) as link,
        start(
            fccd, scratch, write_config(scratch, link.port, others=PATIENT, guidance=PATTERN)
        ) as daemon,
    ):
        flight = Breaking(name, simulator, link, daemon)
        for fault in HARMLESS:
            flight.engage()
            flight.put_in(fault)
            began_s = simulator.progress().time_s
            while simulator.progress().time_s < began_s + FLOWN_THROUGH_S:
                assert daemon.next_state() == "engaged", daemon.log
            flight.disengage()
            flight.restore()
        for fault in FAULTS[name]:
            flight.engage()
            flight.put_in(fault)
            words = SENSED[name].frozen if fault == "frozen" else SENSED[name].missing
            log = daemon.wait_for("engaged -> ", within_s=40.0)
            assert "failsafe" in log, log
            assert str(words) in log, f"{fault}: {log}"
            if fault == "silent":
                daemon.wait_for("now: flying on without a lost quantity")
            flight.restore()
            if fault == "silent":
                daemon.wait_for("failsafe -> engaged")
            flight.disengage()
        return daemon.end(signal.SIGTERM)


@pytest.fixture(scope="module")
def flown(fccd: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Flown]:
    """All six flights, side by side."""
    scratch = tmp_path_factory.mktemp("sensors")
    endings = at_once({name: functools.partial(fly, fccd, scratch / name, name) for name in SENSED})
    return {
        name: Flown.of(ending, scratch / name / "recordings") for name, ending in endings.items()
    }


def failsafe_of(flown: Flown, name: str, fault: str) -> int:
    """Return where in the records a fault led to failsafe."""
    assert len(flown.failsafes) == len(FAULTS[name]), flown.texts()
    return flown.failsafes[FAULTS[name].index(fault)]


def last_good_ns(flown: Flown, name: str, fault: str) -> int:
    """Return when the last valid value before a fault was taken."""
    sensor = SENSED[name]
    place = failsafe_of(flown, name, fault)
    present = sensor.value(flown.records[place])
    # What jumped is in the records, and only what was there before is valid.
    while fault == "jumping" and not any(
        abs(is_ - was) >= sensor.jump / 2
        for is_, was in zip(sensor.value(flown.records[place]), present, strict=True)
    ):
        place -= 1
    return _taken_ns(flown.records[place], name)


def _taken_ns(record: Any, name: str) -> int:
    names = {"heading": "heading_rad", "airspeed": "airspeed_mps", "altitude": "altitude_m"}
    taken: int = getattr(record.measurements, names.get(name, name)).taken_ns
    return taken


@pytest.mark.fault(
    "Sensors",
    "sensor late",
    "age of last reading; by 50 ms: none",
    "{failsafe.sensor_max_age_ms} ms",
    "failsafe; by 50 ms: continues",
)
@pytest.mark.fault(
    "Sensors",
    "sensor NaN, infinite or out of range",
    "rejected",
    "{failsafe.sensor_max_age_ms} ms",
    "failsafe",
)
@pytest.mark.fault(
    "Sensors",
    "sensor silent",
    "age of last reading",
    "{failsafe.sensor_max_age_ms} ms (`failsafe.sensor_max_age_ms`)",
    "failsafe",
)
@pytest.mark.parametrize("fault", LOSSES)
@pytest.mark.parametrize("name", SENSED)
def test_a_loss_is_failsafe_when_it_is_too_old(
    flown: dict[str, Flown], name: str, fault: str
) -> None:
    flight = flown[name]
    record = flight.records[failsafe_of(flight, name, fault)]
    after_s = (record.tick.woke_ns - last_good_ns(flight, name, fault)) * NS
    # As soon as the last good one is too old, within a tick or two that may be missed.
    assert MAX_AGE_S < after_s < 2 * MAX_AGE_S


@pytest.mark.fault(
    "Sensors",
    "sensor frozen, not the altimeter: identical bits, new times; each gyroscope axis by itself",
    "unchanged for {failsafe.sensor_frozen_s} s (`failsafe.sensor_frozen_s`) while others "
    "show a turn (5°), bank (10°), pitch (4°), for airspeed also 15 kt or 0.2 g, beyond its "
    "[resolution](envelope.md#coarse-and-slow-sensors)",
    "2 s, once it moves; coarse: 2 to 20 s",
    "failsafe",
)
@pytest.mark.parametrize("name", [name for name in SENSED if "frozen" in FAULTS[name]])
def test_a_frozen_sensor_is_failsafe_once_the_aircraft_moves(
    flown: dict[str, Flown], name: str
) -> None:
    flight, sensor = flown[name], SENSED[name]
    place = failsafe_of(flight, name, "frozen")
    last = flight.records[place]
    present = sensor.value(last)
    while sensor.value(flight.records[place - 1]) == pytest.approx(
        present, rel=0, abs=sensor.stands_still
    ):
        place -= 1
    after_s = seconds(last, flight.records[place])
    assert after_s + 0.1 >= FROZEN_S or name == "body_rates"
    # A second of hold, a bank within three.
    assert after_s < 15.0
    # Its readings arrived all the time: its age is fine.
    assert (last.tick.woke_ns - _taken_ns(last, name)) * 1e-9 < MAX_AGE_S


@pytest.mark.fault(
    "Sensors",
    "sensor reordered; datagrams reordered, doubled, lost",
    "time in each",
    "",
    "continues",
)
@pytest.mark.parametrize("name", SENSED)
def test_reordered_or_slightly_late_samples_have_no_effect(
    flown: dict[str, Flown], name: str
) -> None:
    states = [text for text in flown[name].texts() if " -> " in text]
    through = ["standby -> engaged", "engaged -> standby"] * len(HARMLESS)
    assert states[: len(through)] == through


@pytest.mark.fault(
    "Sensors",
    "sensor jumping",
    "rejected: farther than any light aircraft moves in that time",
    "lasting: {failsafe.sensor_max_age_ms} ms",
    "short: continues; lasting: failsafe",
)
@pytest.mark.parametrize("name", SENSED)
def test_a_short_jump_is_flown_through(flown: dict[str, Flown], name: str) -> None:
    flight = flown[name]
    phases = [record.state.phase for record in flight.records]
    engaged = [
        place
        for place, (last, phase) in enumerate(itertools.pairwise(phases), 1)
        if phase == ENGAGED != last
    ]
    begin = engaged[HARMLESS.index("a short jump")]
    end = begin + phases[begin:].index(STANDBY)
    assert FAILSAFE not in phases[begin:end]
    records = flight.records[begin:end]
    values = [SENSED[name].value(record) for record in records]
    jumped = [place for place, step in enumerate(_steps(values), 1) if step > SENSED[name].jump / 2]
    there, back = jumped[0], jumped[-1]
    assert 0.0 < seconds(records[back], records[there]) < MAX_AGE_S


def _steps(values: Sequence[tuple[float, ...]]) -> list[float]:
    return [
        max(abs(now - before) for now, before in zip(later, earlier, strict=True))
        for earlier, later in itertools.pairwise(values)
    ]


@pytest.mark.parametrize("name", SENSED)
def test_what_is_good_again_is_flown_on(flown: dict[str, Flown], name: str) -> None:
    flight = flown[name]
    lost = failsafe_of(flight, name, "silent")
    records = flight.records[lost:]
    back = next(place for place, record in enumerate(records) if record.state.phase == ENGAGED)
    good = max(
        place
        for place, record in enumerate(records[:back])
        if record.tick.woke_ns - _taken_ns(record, name) > MAX_AGE_S * 1e9
    )
    # Good for 2 s, by the simulator's time.
    assert 1.8 < seconds(records[back], records[good]) < 3.0
    # The pattern is continued where it was.
    before, after = records[0].setpoints.guidance, records[back].setpoints.guidance
    assert after.mode == before.mode
    assert after.elapsed_s == pytest.approx(before.elapsed_s, abs=0.2)
    # A captured altitude is refined in the first seconds.
    assert after.captured.altitude_m == pytest.approx(before.captured.altitude_m, abs=0.3)
    assert after.captured.heading_rad == before.captured.heading_rad
    assert after.captured.airspeed_mps == before.captured.airspeed_mps


@pytest.mark.parametrize("name", SENSED)
def test_every_failsafe_ends_in_a_release(flown: dict[str, Flown], name: str) -> None:
    flight = flown[name]
    assert flight.ending.report["released"] is True
    assert (
        flight.texts().count("release sent to the actuators")
        == len(FAULTS[name]) + len(HARMLESS) + 1
    )


@pytest.mark.parametrize("name", SENSED)
def test_a_replay_is_identical(fccd: Path, flown: dict[str, Flown], name: str) -> None:
    assert_flown_again(fccd, flown[name])
