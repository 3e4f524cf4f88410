"""JSBSim's Cessna over X-Plane's protocol, flown from the page."""

from __future__ import annotations

import os
from pathlib import Path

from daemon_under_test import assert_released, flight, wait_until
from fcc_hil.cockpit import OVERRIDE_JOYSTICK, OVERRIDE_THROTTLES
from ground_station import Station, waited

from air import Visit
from test_commands import said, slide
from test_numbers import row

OTHERS = """
[engage]
command_needs_switch = false
[telemetry]
instance = "{instance}"
"""
ALTIMETER = "sim/cockpit2/gauges/indicators/altitude_ft_pilot"


def test_jsbsim_is_engaged_watched_and_released_from_the_page(
    fccd: Path, station_program: Path, tmp_path: Path, visit: Visit
) -> None:
    instance = f"jsbsim-{os.getpid()}"
    with flight(fccd, tmp_path, others=OTHERS.format(instance=instance)) as (simulator, daemon):
        daemon.wait_until_ready()
        given: list[str | Path] = [
            station_program,
            "--config",
            tmp_path / "fccd.toml",
            "--state",
            tmp_path / "state",
        ]
        station = Station(given, fccd, instance)
        try:
            page = visit(station).open()
            page.get_by_role("button", name="ft", exact=True).click()
            page.wait_for_selector(".slide[aria-disabled=false]")
            slide(page, 1.0)
            said(page, "engage: carried out at tick")
            wait_until(lambda: simulator.read(OVERRIDE_JOYSTICK) == 1.0, "the joystick is held")
            wait_until(lambda: simulator.read(OVERRIDE_THROTTLES) == 1.0, "the throttle is held")
            # The height of the simulator's altimeter, which is set to 30.12 inHg: above the
            # pressure altitude by 1,000 ft for an inch.
            altimeter_ft = simulator.read(ALTIMETER)
            assert altimeter_ft is not None
            height_ft = altimeter_ft - (30.12 - 29.92) * 1000
            waited("the altitude", lambda: abs(row(page, "Altitude")[0] - height_ft) < 60)
            slide(page, 1.0)
            said(page, "disengage: carried out")
            assert_released(simulator)
        finally:
            station.end()
