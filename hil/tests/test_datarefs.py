"""Datarefs and rows: units and signs, checked against the state that they come from."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from fcc_hil.cockpit import GENERIC_LIGHTS, OVERRIDE_JOYSTICK, YOKE_PITCH, Cockpit
from fcc_hil.datarefs import getter, readable
from fcc_hil.local_axes import LocalAxes
from fcc_hil.plant import Plant
from fcc_hil.protocol import Dialect
from fcc_hil.readout import Readout
from fcc_hil.rows import row_values
from fcc_hil.state import Controls, State

P = "sim/flightmodel/position/"
F = "sim/flightmodel/forces/"
LEVEL = Plant("c172p").state()
# A climbing left turn, heading south-west, with the numbers chosen by hand.
TURNING = replace(
    LEVEL,
    pitch_rad=math.radians(5.0),
    roll_rad=math.radians(-20.0),
    heading_rad=math.radians(225.0),
    roll_rate_radps=0.1,
    pitch_rate_radps=0.2,
    yaw_rate_radps=-0.3,
    north_mps=-30.0,
    east_mps=-40.0,
    down_mps=-5.0,
)


def readout(state: State, version: int = 121_000, variation_deg: float = 0.0) -> Readout:
    return Readout(
        state=state,
        cockpit=Cockpit(Controls(throttle=0.7)),
        dialect=Dialect(version),
        flight_time_s=12.5,
        paused=False,
        frame_period_s=0.02,
        axes=LocalAxes(),
        magnetic_variation_deg=variation_deg,
    )


def value(path: str, of: Readout) -> float:
    read = getter(path, of.cockpit, of.dialect)
    assert read is not None, path
    return read(of)


@pytest.mark.parametrize(
    ("path", "expected"),
    [
        (P + "theta", 5.0),
        (P + "phi", -20.0),
        (P + "psi", 225.0),
        (P + "Prad", 0.1),
        (P + "Qrad", 0.2),
        (P + "Rrad", -0.3),
        (P + "P", math.degrees(0.1)),
        (P + "groundspeed", 50.0),
        (P + "hpath", 233.130),  # atan2(-40, -30)
        (P + "vpath", 5.711),  # atan(5 / 50)
        (P + "local_vx", -40.0),
        (P + "local_vy", 5.0),
        (P + "local_vz", 30.0),
        (P + "vh_ind_fpm", 984.25),  # 5 m/s
        ("sim/time/total_flight_time_sec", 12.5),
        ("sim/time/paused", 0.0),
        ("sim/version/xplane_internal_version", 121_000.0),
    ],
)
def test_units_and_signs(path: str, expected: float) -> None:
    assert value(path, readout(TURNING)) == pytest.approx(expected, abs=0.005)


@pytest.mark.parametrize(
    ("path", "expected", "tolerance"),
    # 100 kt calibrated at 3,000 ft in the standard atmosphere: 104.5 kt true.
    [
        (P + "indicated_airspeed", 100.0, 0.01),
        (P + "true_airspeed", 53.76, 0.05),
        ("sim/cockpit2/gauges/indicators/altitude_ft_pilot", 3_000.0, 1.0),
        (P + "elevation", 914.4, 0.1),
        (P + "y_agl", 914.4, 0.1),
        ("sim/weather/barometer_current_inhg", 26.817, 0.01),
        ("sim/weather/aircraft/barometer_current_pas", 90_812.0, 30.0),
        ("sim/weather/aircraft/qnh_pas", 101_325.0, 0.1),
        ("sim/weather/aircraft/temperature_ambient_deg_c", 9.06, 0.05),
        (F + "g_nrml", 1.0, 0.01),
        (F + "g_side", 0.0, 0.01),
        (P + "local_ax", 0.0, 0.05),
        (P + "local_ay", 0.0, 0.05),
        (P + "local_az", 0.0, 0.05),
    ],
)
def test_level_flight_in_the_standard_atmosphere(
    path: str, expected: float, tolerance: float
) -> None:
    assert value(path, readout(LEVEL)) == pytest.approx(expected, abs=tolerance)


def test_local_acceleration_points_into_the_turn() -> None:
    # A coordinated 30 deg right turn northbound: g tan 30 deg = 5.662 m/s2 to the east.
    load = 9.80665 / math.cos(math.radians(30.0))
    turn = replace(
        LEVEL,
        pitch_rad=0.0,
        roll_rad=math.radians(30.0),
        heading_rad=0.0,
        specific_force_x_mps2=0.0,
        specific_force_y_mps2=0.0,
        specific_force_z_mps2=-load,
    )
    assert value(P + "local_ax", readout(turn)) == pytest.approx(5.662, abs=0.001)
    assert value(P + "local_ay", readout(turn)) == pytest.approx(0.0, abs=1e-9)
    assert value(P + "local_az", readout(turn)) == pytest.approx(0.0, abs=1e-9)


def test_local_position_agrees_with_the_velocity() -> None:
    plant = Plant("c172p", heading_deg=60.0)
    before = readout(plant.state())
    plant.step(120)
    after = readout(plant.state())
    for axis in ("x", "y", "z"):
        moved = value(P + f"local_{axis}", after) - value(P + f"local_{axis}", before)
        velocity = value(P + f"local_v{axis}", before)
        # The ellipsoid's curvature at the equator differs north to south by 0.7 %.
        assert moved == pytest.approx(velocity, abs=0.4)


def test_magnetic_heading_is_true_less_variation_east() -> None:
    assert value(P + "mag_psi", readout(TURNING, variation_deg=10.0)) == pytest.approx(215.0)
    assert value(P + "mag_psi", readout(LEVEL, variation_deg=10.0)) == pytest.approx(350.0)


def test_x_plane_11_has_not_the_datarefs_of_12() -> None:
    cockpit = Cockpit(Controls())
    path = "sim/weather/aircraft/barometer_current_pas"
    assert getter(path, cockpit, Dialect(115_501)) is None
    assert getter(path, cockpit, Dialect(121_000)) is not None
    assert getter("sim/no/such", cockpit, Dialect(121_000)) is None


def test_every_dataref_reads_finite() -> None:
    of = readout(TURNING)
    for path in readable(of.dialect):
        assert math.isfinite(value(path, of)), path


def test_writable_datarefs_read_back() -> None:
    of = readout(LEVEL)
    of.cockpit.write(0.0, OVERRIDE_JOYSTICK, 1.0)
    of.cockpit.write(0.0, YOKE_PITCH, 0.25)
    assert value(OVERRIDE_JOYSTICK, of) == 1.0
    assert value(YOKE_PITCH, of) == 0.25
    assert value(f"{GENERIC_LIGHTS}[5]", of) == 0.0


def columns(row: int, of: Readout) -> tuple[float, ...]:
    found = row_values(row, of)
    assert found is not None
    assert len(found) == 8
    return found


def test_rows() -> None:
    of = readout(TURNING, variation_deg=10.0)
    assert columns(17, of)[:4] == pytest.approx((5.0, -20.0, 225.0, 215.0))
    assert columns(17, of)[4:] == (-999.0,) * 4
    assert columns(25, of)[:2] == (0.7, -999.0)
    assert columns(4, of)[2] == pytest.approx(984.25, abs=0.01)
    assert columns(20, of)[5] == pytest.approx(3_000.0, abs=1.0)
    assert columns(21, of)[3:6] == (-40.0, 5.0, 30.0)
    assert columns(3, of)[0] == pytest.approx(100.0, abs=0.01)
    assert columns(6, of)[3] == pytest.approx(0.9151, abs=0.001)  # density ratio at 3,000 ft
    assert row_values(99, of) is None


def test_row_16_changed_with_version_12() -> None:
    assert columns(16, readout(TURNING, 115_501))[:3] == pytest.approx((0.2, 0.1, -0.3))
    degrees = [math.degrees(rate) for rate in (0.1, 0.2, -0.3)]
    assert columns(16, readout(TURNING, 121_000))[:3] == pytest.approx(degrees)
