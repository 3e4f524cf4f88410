"""Overrides: who has control, and the controls after a release."""

from __future__ import annotations

from dataclasses import replace

import pytest

from fcc_hil.cockpit import (
    GEAR,
    GENERIC_LIGHTS,
    OVERRIDE_JOYSTICK,
    OVERRIDE_THROTTLES,
    THROTTLE_USE,
    YOKE_HEADING,
    YOKE_PITCH,
    YOKE_ROLL,
    Cockpit,
    Release,
)
from fcc_hil.state import Controls

TRIMMED = Controls(throttle=0.7, elevator_trim=0.0)


def test_the_yoke_belongs_to_the_pilot_until_overridden() -> None:
    cockpit = Cockpit(TRIMMED)
    assert not cockpit.write(0.0, YOKE_PITCH, 0.5)
    assert cockpit.controls() == TRIMMED
    cockpit.write(1.0, OVERRIDE_JOYSTICK, 1.0)
    assert cockpit.write(1.0, YOKE_PITCH, 0.5)
    assert cockpit.controls() == replace(TRIMMED, elevator=0.5)


def test_the_throttles_belong_to_the_pilot_until_overridden() -> None:
    cockpit = Cockpit(TRIMMED, engines=2)
    assert not cockpit.write(0.0, f"{THROTTLE_USE}[0]", 0.2)
    # The joystick's override does not give the throttles.
    cockpit.write(0.0, OVERRIDE_JOYSTICK, 1.0)
    assert not cockpit.write(0.0, f"{THROTTLE_USE}[0]", 0.2)
    cockpit.write(0.0, OVERRIDE_THROTTLES, 1.0)
    cockpit.write(0.0, f"{THROTTLE_USE}[0]", 0.2)
    assert cockpit.throttles() == [0.2, 0.7]


def test_a_release_restores_the_trimmed_controls_and_is_recorded() -> None:
    cockpit = Cockpit(TRIMMED)
    for path in (OVERRIDE_JOYSTICK, OVERRIDE_THROTTLES):
        cockpit.write(1.0, path, 1.0)
    cockpit.write(1.0, YOKE_ROLL, -0.4)
    cockpit.write(1.0, YOKE_HEADING, 0.3)
    cockpit.write(1.0, f"{THROTTLE_USE}[0]", 0.1)
    cockpit.write(2.0, OVERRIDE_JOYSTICK, 0.0)
    cockpit.write(2.0, OVERRIDE_THROTTLES, 0.0)
    assert cockpit.controls() == TRIMMED
    assert cockpit.releases[0] == Release(2.0, OVERRIDE_JOYSTICK, 0.0, -0.4, 0.3)
    assert [release.path for release in cockpit.releases] == [OVERRIDE_JOYSTICK, OVERRIDE_THROTTLES]
    # Clearing an override that is not set is not a release.
    cockpit.write(3.0, OVERRIDE_JOYSTICK, 0.0)
    assert len(cockpit.releases) == 2


def test_the_gears_handle_is_an_int_and_stays_until_it_is_moved() -> None:
    cockpit = Cockpit(TRIMMED)
    assert (cockpit.read(GEAR), cockpit.controls().gear) == (1.0, None)
    for value, handle in ((0.0, 0.0), (1.0, 1.0), (0.9, 0.0)):
        assert cockpit.write(0.0, GEAR, value)
        assert (cockpit.read(GEAR), cockpit.controls().gear) == (handle, handle)


def test_values_are_clipped_to_the_range() -> None:
    cockpit = Cockpit(TRIMMED)
    for path in (OVERRIDE_JOYSTICK, OVERRIDE_THROTTLES):
        cockpit.write(0.0, path, 1.0)
    cockpit.write(0.0, YOKE_PITCH, -7.0)
    cockpit.write(0.0, THROTTLE_USE, 3.0)
    assert cockpit.controls() == Controls(elevator=-1.0, throttle=1.2, elevator_trim=0.0)


def test_rows_8_and_25_obey_the_overrides_and_skip_minus_999() -> None:
    cockpit = Cockpit(TRIMMED)
    row = [0.1, -999.0, 0.3, *[-999.0] * 5]
    assert not cockpit.write_row(0.0, 8, row)
    cockpit.write(0.0, OVERRIDE_JOYSTICK, 1.0)
    cockpit.write(0.0, YOKE_ROLL, 0.2)
    assert cockpit.write_row(0.0, 8, row)
    assert cockpit.controls() == replace(TRIMMED, elevator=0.1, aileron=0.2, rudder=0.3)
    cockpit.write(0.0, OVERRIDE_THROTTLES, 1.0)
    assert cockpit.write_row(0.0, 25, [0.4, *[-999.0] * 7])
    assert cockpit.throttles() == pytest.approx([0.4])
    assert not cockpit.write_row(0.0, 17, [0.0] * 8)


def test_switches_and_unknown_datarefs() -> None:
    cockpit = Cockpit(TRIMMED, version=110_501)
    assert cockpit.write(0.0, f"{GENERIC_LIGHTS}[63]", 1.0)
    assert cockpit.is_on(f"{GENERIC_LIGHTS}[63]")
    assert not cockpit.is_on(f"{GENERIC_LIGHTS}[0]")
    assert cockpit.read(f"{GENERIC_LIGHTS}[64]") is None
    # "Was dim [64] until 11.10" (DataRefs.txt).
    since_11_10 = Cockpit(TRIMMED, version=111_000)
    assert since_11_10.read(f"{GENERIC_LIGHTS}[127]") == 0.0
    assert since_11_10.read(f"{GENERIC_LIGHTS}[128]") is None
    assert cockpit.read("sim/no/such") is None
    assert cockpit.read(f"{GENERIC_LIGHTS}[0") is None
    assert not cockpit.write(0.0, "sim/flightmodel/position/theta", 1.0)


def test_the_journal_contains_writes_without_effect() -> None:
    cockpit = Cockpit(TRIMMED)
    cockpit.write(0.5, YOKE_PITCH, 0.25)
    cockpit.write(0.6, OVERRIDE_JOYSTICK, 1.0)
    assert [(w.time_s, w.path, w.value, w.took) for w in cockpit.journal] == [
        (0.5, YOKE_PITCH, 0.25, False),
        (0.6, OVERRIDE_JOYSTICK, 1.0, True),
    ]
