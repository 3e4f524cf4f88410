"""A whole plan: take-off, circuit, landing.

pytest hil/examples/test_circuit.py     in lockstep, from the clone's folder, in 10 s
"""

import pytest

from fcc_hil.flight import Flight


@pytest.mark.aircraft("c172p", wind=(20, 8))
@pytest.mark.autopilot(mode="plan", plan="config/plans/circuit.waypoints")
def test_flies_the_circuit_and_lands(flight: Flight) -> None:
    """In 8 kt of wind, 20° off the runway; the turn at item 4 cuts its corner."""
    flight.engages(by=3)
    flight.passes(4, within=300, by=300)
    flight.lands(by=900, centre_line=5, sink=200, heading=5, along=300)
    flight.never("failsafe")
