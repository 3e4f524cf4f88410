"""One bad reading, of whatever size, changes nothing: the loop of the daemon, with JSBSim."""

from __future__ import annotations

from functools import cache

import fcc
import numpy as np
import pytest

from fcc_hil.faulty_sensors import Kind, SensorFault
from fcc_hil.lockstep_rig import Conditions, LockstepRig
from fcc_hil.plant import Plant
from fcc_hil.quantities import SENSORS
from fcc_hil.settings import Settings

HOLD = '[guidance]\nmode = "hold"\n'
BAD_AT_S = 10.0
TICK_S = 0.025
COLUMNS = ("altitude_ft", "heading_deg", "airspeed_kt", "roll_deg", "pitch_deg")

SMALL = {
    "attitude": 0.1,
    "heading": 0.2,
    "body_rates": 1.0,
    "specific_force": 30.0,
    "airspeed": 10.0,
    "altitude": 10.0,
}
"""What the gate passes, since an aircraft can do it, rad, rad/s, m/s², m/s, m."""
LARGE = {
    "attitude": 0.7,
    "heading": 1.5,
    "body_rates": 5.0,
    "specific_force": 100.0,
    "airspeed": 50.0,
    "altitude": 300.0,
}


def flown() -> LockstepRig:
    """Return a Cessna that is engaged, before the bad reading."""
    plant = Plant("c172p", seed=7741)
    settings = Settings(aircraft="c172p", noise=True, seed=7741)
    rig = LockstepRig(settings, plant, fcc.Machine(HOLD), Conditions(sensor_delay_ticks=1))
    rig.prepare()
    rig.set_switch(on=True)
    rig.fly_to(BAD_AT_S)
    assert rig.holds_control
    return rig


def motion(rig: LockstepRig) -> dict[str, np.ndarray]:
    """Return how it flew for 5 s since then."""
    rig.fly_to(BAD_AT_S + 5.0)
    truth = rig.truth()
    return {name: truth[name][truth["time_s"] >= BAD_AT_S] for name in COLUMNS}


@cache
def undisturbed() -> dict[str, np.ndarray]:
    """Return the same flight without a bad reading."""
    return motion(flown())


def largest_change(rig: LockstepRig) -> dict[str, float]:
    """Return by how much it flew otherwise, ft, degrees, kt."""
    flew = motion(rig)
    change = {name: flew[name] - undisturbed()[name] for name in COLUMNS}
    change["heading_deg"] = (change["heading_deg"] + 180.0) % 360.0 - 180.0
    return {name: float(np.max(np.abs(change[name]))) for name in COLUMNS}


@pytest.mark.fault(
    "Sensors",
    "one bad reading",
    "rejected, or weakened by filters",
    "",
    "continues: 4° of bank, 3 ft at most",
)
@pytest.mark.parametrize("name", SENSORS)
@pytest.mark.parametrize("amounts", [SMALL, LARGE], ids=["small", "large"])
def test_one_bad_reading_of_a_sensor_is_flown_through(name: str, amounts: dict[str, float]) -> None:
    rig = flown()
    begin_s, end_s = BAD_AT_S + 0.5 * TICK_S, BAD_AT_S + 1.5 * TICK_S
    channels = SENSORS[name]
    fault = SensorFault(Kind.BIAS, name, channels, begin_s, end_s, amount=amounts[name])
    rig.set_faults([fault])
    change = largest_change(rig)
    assert max(change.values()) > 0.0, "it was read"
    assert change["altitude_ft"] < 3.0
    assert change["heading_deg"] < 1.0
    assert change["airspeed_kt"] < 1.0
    assert change["roll_deg"] < 4.0
    assert change["pitch_deg"] < 2.0
    assert not [event.text for event in rig.events if event.time_s > BAD_AT_S]


def test_one_bad_reading_of_the_switch_changes_nothing() -> None:
    rig = flown()
    rig.set_switch(on=False)
    rig.fly_to(BAD_AT_S + TICK_S)
    rig.set_switch(on=True)
    assert max(largest_change(rig).values()) == 0.0
    assert rig.holds_control
    # Two are believed.
    rig.set_switch(on=False)
    rig.fly_to(rig.time_s + 2.0 * TICK_S)
    assert not rig.holds_control
    rig.set_switch(on=True)
    rig.fly_to(rig.time_s + TICK_S)
    rig.set_switch(on=False)
    rig.fly_to(rig.time_s + 2.0)
    assert not rig.holds_control


def test_commands_that_no_aircraft_flies_are_refused() -> None:
    machine = fcc.Machine(HOLD)
    for order in (
        {"airspeed_mps": 20.0},
        {"airspeed_mps": 1e9},
        {"heading_rad": 1e9},
        {"altitude_m": 1e9},
        {"altitude_m": -501.0},
        {"pressure_altitude_m": 1e9},
        {"altimeter_setting_pa": 1013.25},
    ):
        with pytest.raises(ValueError, match=r"choose -?[\d.]+ to [\d.]+"):
            machine.command(**order)
