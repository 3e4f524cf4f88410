"""A flight, a broken sensor and the required reaction, in ten lines.

pytest hil/examples/test_ten_lines.py                   in lockstep, in a second
pytest hil/examples/test_ten_lines.py --realtime        by the daemon, over UDP
pytest hil/examples/test_ten_lines.py --fccd pi.local   by the daemon on a Pi
"""

from fcc_hil import airspeed, altitude, bank, heading
from fcc_hil.flight import Flight
from fcc_hil.sensor_faults import Faults


def test_airspeed_lost_after_the_first_turn(flight: Flight, faults: Faults) -> None:
    """The daemon's own pattern holds for 20 s, then turns 90° right and climbs 150 ft."""
    flight.engages(by=3)
    flight.flies(to=20)
    flight.settles(heading, within=2, by=17)
    flight.settles(altitude, within=10, by=12)
    flight.overshoots_less_than(heading, 1.5)
    gone = faults.loss(airspeed)
    flight.falls_into_failsafe(by=0.5, after=gone)
    flight.releases(by=6, after=gone)
    flight.never(abs(bank) > 35)
