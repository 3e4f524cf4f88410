"""Recovery from upsets of any attitude and rate, on seeds that nothing was tuned on."""

from __future__ import annotations

import math
import os

import pytest
from drawn_upsets import LIMIT_LOAD, LIMIT_NEGATIVE_LOAD, Upset, begin
from upset_flights import Flight, Recovery, load_of

from fcc_hil.campaign.aircraft import AIRCRAFT
from fcc_hil.units import FT_TO_M, KT_TO_MPS

SEED = 11_001
UPSETS = int(os.environ.get("FCCD_UPSETS", "8"))
"""How many are flown; `make test-upsets` flies 100."""
_HEADING_RAD = math.pi / 2
_FLOWN_S = 90.0


def _fly(upset: Upset, flight: Flight) -> tuple[Recovery, list[str]]:
    """Fly on at a heading, the altitude and 1.5 Vs (best climb: 76 of 51 kt, 172P's handbook).

    Returns what went wrong as well.
    """
    plant, begin_s = flight.plant, flight.plant.time_s
    start = plant.state()
    recovery = Recovery(start, flight.events, before_ft=start.altitude_m / FT_TO_M)
    slowest_kt = AIRCRAFT[upset.aircraft].slowest_order_kt + 1.0
    flight.machine.command(
        heading_rad=_HEADING_RAD,
        altitude_m=start.altitude_m,
        airspeed_mps=max(1.5 * upset.stall_kt, slowest_kt) * KT_TO_MPS,
    )
    loads = []
    while plant.time_s - begin_s < _FLOWN_S and plant.state().height_m > 0.0:
        flight.tick(None)
        state, time_s = plant.state(), plant.time_s - begin_s
        recovery.see(time_s, state)
        loads.append(load_of(state))
    recovery.state = flight.machine.state
    end = plant.state()
    off_deg = math.degrees(math.remainder(end.heading_rad - _HEADING_RAD, math.tau))
    off_ft = end.altitude_m / FT_TO_M - recovery.before_ft
    wrong = {
        f"{recovery.greatest_kt:.0f} kt": recovery.greatest_kt > upset.never_exceed_kt,
        f"{min(loads):.2f} g": min(loads) < LIMIT_NEGATIVE_LOAD,
        f"{max(loads):.2f} g": max(loads) > LIMIT_LOAD,
        f"is {recovery.state}": recovery.state != "engaged",
        f"{off_deg:.0f} degrees off the heading": abs(off_deg) > 5.0,
        f"bank {math.degrees(end.roll_rad):.0f}": abs(end.roll_rad) > math.radians(10.0),
        f"{off_ft:.0f} ft off, {-end.down_mps:.1f} m/s": abs(off_ft) > 60.0
        and not (off_ft < 0.0 and end.down_mps < 0.0),
    }
    return recovery, [what for what, is_wrong in wrong.items() if is_wrong]


@pytest.mark.parametrize("number", range(UPSETS))
def test_any_upset_is_recovered_from(number: int) -> None:
    """Limits: 14 CFR 23.337, the handbooks' never-exceed speeds, 5 degrees, 60 ft or climbing."""
    upset, flight = begin(SEED, number)
    recovery, wrong = _fly(upset, flight)
    start = recovery.begin
    print(
        f"{number}: {upset.aircraft} {upset.weight}, bank {math.degrees(start.roll_rad):.0f}, "
        f"pitch {math.degrees(start.pitch_rad):.0f}, {start.airspeed_mps / KT_TO_MPS:.0f} kt: "
        f"lost {recovery.lost_ft:.0f} ft, {recovery.greatest_kt:.0f} kt, "
        f"{recovery.least_load:.2f} to {recovery.greatest_load:.2f} g; {wrong or 'recovered'}"
    )
    assert not wrong
