"""The floor, against JSBSim's truth: nothing that is flown leads below it.

Noisy sensors, 25 ms late; seeds on which nothing was tuned.
"""

from __future__ import annotations

from dataclasses import replace

import edge_sensors
import fcc
import numpy as np
import pytest

from fcc_hil.faulty_sensors import Kind, SensorFault
from fcc_hil.lockstep_rig import Conditions, LockstepRig
from fcc_hil.plant import Plant, Weather
from fcc_hil.quantities import SENSORS
from fcc_hil.settings import Settings
from fcc_hil.units import FT_TO_M

HOLD = '[guidance]\nmode = "hold"\n'
DESCENDING_PATTERN = """
[guidance]
mode = "timed-pattern"
hold_s = 5.0
leg_s = 25.0
climb_ft = -400.0
"""
FLOOR_FT = 2800.0
MARGIN_FT = 50.0
LIMITED = "the target altitude is limited by the floor or the fence"


def flown(
    config: str, *, floor_ft: float = FLOOR_FT, turbulence: int = 0, seed: int = 7701
) -> LockstepRig:
    """Return a Cessna at 3,000 ft that is engaged."""
    plant = Plant(
        "c172p",
        seed=seed,
        weather=Weather(turbulence_severity=turbulence),
        latitude_deg=edge_sensors.LATITUDE_DEG,
    )
    machine = edge_sensors.machine(f"{config}[autopilot.envelope]\nfloor_ft = {floor_ft}\n")
    settings = Settings(aircraft="c172p", noise=True, seed=seed)
    between = edge_sensors.conditions(seed, Conditions(sensor_delay_ticks=1))
    rig = LockstepRig(settings, plant, machine, between)
    edge_sensors.settle(rig)
    rig.set_switch(on=True)
    rig.fly_to(rig.time_s + 1.0)
    assert rig.holds_control
    return rig


def altitudes_ft(rig: LockstepRig, since_s: float = 0.0) -> np.ndarray:
    """Return the true altitudes, all or from so long after an engagement at 2 s on."""
    truth = rig.truth()
    from_s = since_s + edge_sensors.LATER_S if since_s else 0.0
    values: np.ndarray = truth["altitude_ft"][truth["time_s"] >= from_s]
    return values


def began(rig: LockstepRig) -> list[float]:
    """Return when targets began to be limited."""
    return [event.time_s for event in rig.events if event.text == f"now: {LIMITED}"]


@pytest.mark.fault(
    "The aircraft",
    "descent to the floor, or engaged below it",
    "[`autopilot.envelope.floor_ft`](envelope.md#who-has-control)",
    "",
    "captured `floor_margin_ft` above it; events",
)
@pytest.mark.parametrize(("turbulence", "seed"), [(0, 7701), (3, 7702), (4, 7703)])
def test_a_descent_at_full_rate_ends_above_the_floor(turbulence: int, seed: int) -> None:
    rig = flown(HOLD, turbulence=turbulence, seed=seed)
    # The autopilot limits a pressure altitude: the floor's depends on the altimeter setting.
    rig.machine.command(pressure_altitude_m=2000.0 * FT_TO_M)
    rig.fly_to(40.0 + edge_sensors.LATER_S)
    altitude_ft = altitudes_ft(rig)
    truth = rig.truth()
    sink_fpm = -60.0 * np.gradient(altitude_ft, truth["time_s"])
    assert np.max(sink_fpm) > 900.0
    assert np.min(altitude_ft) > FLOOR_FT
    assert np.max(np.abs(altitudes_ft(rig, 30.0) - FLOOR_FT - MARGIN_FT)) < 40.0
    assert len(began(rig)) == 1


def test_the_legs_of_a_pattern_end_above_the_floor() -> None:
    rig = flown(DESCENDING_PATTERN)
    rig.fly_to(55.0 + edge_sensors.LATER_S)
    assert np.min(altitudes_ft(rig)) > FLOOR_FT
    off_ft = altitudes_ft(rig, 30.0)[0] - FLOOR_FT - MARGIN_FT
    assert abs(off_ft) < 3.0 + edge_sensors.ALTIMETER_FT
    # The next leg climbs back.
    assert abs(altitudes_ft(rig)[-1] - 3000.0) < 5.0 + edge_sensors.ALTIMETER_FT
    assert len(began(rig)) == 1


def test_engaged_below_the_floor_it_climbs_to_it() -> None:
    rig = flown(HOLD, floor_ft=3100.0)
    rig.fly_to(35.0 + edge_sensors.LATER_S)
    assert abs(altitudes_ft(rig)[-1] - 3150.0) < 3.0 + edge_sensors.ALTIMETER_FT
    assert len(began(rig)) == 1


@edge_sensors.measured
@pytest.mark.parametrize("lost", ["heading", "specific_force", "airspeed", "attitude"])
def test_a_failsafe_in_a_descent_stays_above_the_floor(lost: str) -> None:
    """Lost at full rate, 60 ft above the lowest altitude."""
    rig = flown(HOLD)
    rig.machine.command(pressure_altitude_m=2000.0 * FT_TO_M)
    low_ft = FLOOR_FT + MARGIN_FT + 60.0
    rig.fly_to(30.0, until=lambda: rig.plant.state().altitude_m < low_ft * FT_TO_M)
    lost_s = rig.time_s
    rig.set_faults([SensorFault(Kind.LOSS, lost, SENSORS[lost], lost_s, lost_s + 60.0)])
    rig.fly_to(lost_s + 25.0)
    assert rig.machine.state == "failsafe"
    assert np.min(altitudes_ft(rig)) > FLOOR_FT


def test_a_dive_is_pulled_out_above_the_floor() -> None:
    """Engaged at more than 3,000 ft/min, 100 ft above the lowest altitude; 2 ft below before.

    With the load of 2 g that is permitted, and half a second until the path follows, it takes 85
    ft.
    """
    plant = Plant("c172p", seed=7731, latitude_deg=edge_sensors.LATITUDE_DEG)
    machine = edge_sensors.machine(f"{HOLD}[autopilot.envelope]\nfloor_ft = 2700.0\n")
    rig = LockstepRig(
        Settings(aircraft="c172p", noise=True, seed=7731),
        plant,
        machine,
        edge_sensors.conditions(7731, Conditions(sensor_delay_ticks=1)),
    )
    edge_sensors.settle(rig)
    plant.trim = replace(plant.trim, elevator=plant.trim.elevator - 0.12)
    rig.fly_to(rig.time_s + 28.0, until=lambda: plant.state().altitude_m < 2850.0 * FT_TO_M)
    sink_fpm = -60.0 * np.gradient(altitudes_ft(rig), rig.truth()["time_s"])
    assert sink_fpm[-1] > 3000.0
    rig.set_switch(on=True)
    machine.engage()
    rig.fly_to(rig.time_s + 20.0)
    assert rig.holds_control
    assert np.min(altitudes_ft(rig)) > 2700.0


def test_commands_below_the_floor_are_refused_with_the_limit() -> None:
    """2,850 ft are 868.68 m; above a field at 1,000 ft 563.88 m."""
    machine = fcc.Machine(
        "[autopilot.envelope]\nfloor_ft = 2800.0\n[altimeter]\nfield_elevation_ft = 1000.0\n"
    )
    with pytest.raises(ValueError, match=r"altitude_m is 868: choose 868\.68 to 20000"):
        machine.command(altitude_m=868.0)
    with pytest.raises(ValueError, match=r"height_m is 563: choose 563\.88 to 20000"):
        machine.command(height_m=563.0)
    machine.command(altitude_m=868.68)
