"""The real daemon in real time: `fccd run` against JSBSim behind X-Plane's protocol.

With `--fccd HOST` it is the daemon on that host, whose configuration must have the guidance of the
mark below.
"""

import pytest

from fcc_hil import altitude, heading
from fcc_hil.flight import Flight
from fcc_hil.sensor_faults import Faults


@pytest.mark.realtime
@pytest.mark.autopilot(
    hold_s=2, leg_s=12, turn_deg=20, climb_ft=30, failsafe_hold_s=1, all_silent_s=0.5
)
def test_a_link_that_breaks_in_flight(flight: Flight, faults: Faults) -> None:
    """The limits are wide, because a busy machine is late now and then."""
    flight.engages(by=5)
    flight.flies(to=2)
    flight.settles(heading, within=3, by=10, for_=1)
    flight.stays(altitude, within=40)
    cut = faults.loss("everything")
    flight.falls_into_failsafe(by=2, after=cut)
    flight.releases(by=5, after=cut)
