"""The altimeter setting, flown in JSBSim's air: numbers by the pilots' table.

Pressure altitude minus altitude by FAA-H-8083-25C, figure 11-3: 0 ft at 29.92 inHg, -275 ft at
30.22 (between -257 at 30.2 and -348 at 30.3).
"""

from __future__ import annotations

from collections.abc import Callable

import fcc
import pytest

from fcc_hil.lockstep import measurements
from fcc_hil.plant import Plant
from fcc_hil.state import State
from fcc_hil.units import FT_TO_M, INHG_TO_PA, PSF_TO_PA

HOLD = '[guidance]\nmode = "hold"\n'
TICK_S, STEPS = 0.025, 3
SETTLED_S = 40.0


class Flight:
    """A Cessna at 3,000 ft, held by the autopilot."""

    def __init__(self, config: str = HOLD, qnh_inhg: float | None = None) -> None:
        """Engage, in air of this pressure at sea level."""
        self.plant = Plant("c172p")
        if qnh_inhg is not None:
            self.plant.fdm["atmosphere/P-sl-psf"] = qnh_inhg * INHG_TO_PA / PSF_TO_PA
        self.autopilot = fcc.Autopilot(config)
        for _ in range(80):
            self.plant.step(STEPS)
            self.autopilot.observe(measurements(self.plant.state()), TICK_S)
        self.plant.step(STEPS)
        held = self.plant.controls
        self.autopilot.engage(
            measurements(self.plant.state()), TICK_S, throttle=held.throttle, elevator=held.elevator
        )

    def fly(self, seconds: float, watch: Callable[[State], None] | None = None) -> State:
        """Fly on; return the true state at the end."""
        for _ in range(round(seconds / TICK_S)):
            self.plant.step(STEPS)
            state = self.plant.state()
            surfaces = self.autopilot.step(measurements(state), TICK_S)
            self.plant.write(
                type(self.plant.controls)(
                    elevator=surfaces.elevator,
                    aileron=surfaces.aileron,
                    rudder=surfaces.rudder,
                    throttle=surfaces.throttle,
                )
            )
            if watch:
                watch(state)
        return self.plant.state()


def test_a_setting_moves_nothing_that_was_captured() -> None:
    flight = Flight()
    before_m = flight.fly(5.0).altitude_m
    off_ft: list[float] = []
    for setting_pa in (97_000.0, 104_000.0, 101_325.0):
        flight.autopilot.command(altimeter_setting_pa=setting_pa)
        flight.fly(5.0, lambda s: off_ft.append((s.altitude_m - before_m) / FT_TO_M))
    assert max(map(abs, off_ft)) < 1.0
    assert flight.autopilot.setpoints.altitude_reference == "pressure-level"


def test_the_flown_altitude_changes_with_the_setting_by_the_pilots_table() -> None:
    flight = Flight()
    flight.autopilot.command(altitude_m=3_000 * FT_TO_M)
    before_m = flight.fly(SETTLED_S).altitude_m
    flight.autopilot.command(altimeter_setting_pa=30.22 * INHG_TO_PA)
    rates: list[float] = []
    after_m = flight.fly(SETTLED_S, lambda s: rates.append(s.down_mps)).altitude_m
    assert (after_m - before_m) / FT_TO_M == pytest.approx(-275.0, abs=2.0)
    assert max(rates) < 965.0 * FT_TO_M / 60.0 * 1.1, "the descent is within the envelope"
    aims = flight.autopilot.setpoints
    assert aims.altitude_above_reference_m == pytest.approx(3_000 * FT_TO_M)
    assert aims.altitude_reference == "sea-level"
    # By a pressure altitude, the setting does not matter.
    flight.autopilot.command(pressure_altitude_m=2_900 * FT_TO_M)
    flight.autopilot.command(altimeter_setting_pa=28.5 * INHG_TO_PA)
    assert flight.fly(SETTLED_S).altitude_m / FT_TO_M == pytest.approx(2_900.0, abs=2.0)


def test_by_the_present_qnh_the_true_altitude_is_flown() -> None:
    """JSBSim's air has a standard temperature: an altimeter shows 0.2 % too much there, 6 ft."""
    flight = Flight(qnh_inhg=30.22)
    state = flight.plant.state()
    assert (state.altitude_m - state.elevation_m) / FT_TO_M == pytest.approx(-269.0, abs=2.0)
    flight.autopilot.command(altimeter_setting_pa=30.22 * INHG_TO_PA, altitude_m=3_300 * FT_TO_M)
    assert flight.fly(SETTLED_S).elevation_m / FT_TO_M == pytest.approx(3_300.0, abs=10.0)


def test_a_height_is_above_the_configured_field() -> None:
    flight = Flight(HOLD + "[altimeter]\nsetting_hpa = 1022.69\nfield_elevation_ft = 700.0\n")
    flight.autopilot.command(height_m=2_500 * FT_TO_M)
    # 30.2 inHg: 257 ft less.
    assert flight.fly(SETTLED_S).altitude_m / FT_TO_M == pytest.approx(2_943.0, abs=2.0)
    with pytest.raises(ValueError, match=r"altimeter\.field_elevation_ft"):
        Flight().autopilot.command(height_m=100.0)
    with pytest.raises(ValueError, match="several altitudes"):
        flight.autopilot.command(height_m=100.0, altitude_m=100.0)
    with pytest.raises(
        ValueError, match=r"altimeter_setting_pa is 1013\.25: choose 94000 to 106000"
    ):
        flight.autopilot.command(altimeter_setting_pa=1_013.25)


def test_the_loop_sets_its_altimeter_in_standby() -> None:
    machine = fcc.Machine(HOLD)
    machine.command(altimeter_setting_pa=102_000.0)
    machine.step()
    assert machine.state == "standby"
    assert machine.setpoints.altimeter_setting_pa == 102_000.0
    assert [event.text for event in machine.events()] == [
        "command: altimeter setting 1020.00 hPa",
        "sensor lockstep: nothing arrives",
    ]
