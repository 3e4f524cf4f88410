"""Requirements on where a flight with a plan goes, by the pytest plugin."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from fcc_hil.flight import Flight, RequirementError
from fcc_hil.marks import autopilot_mark
from fcc_hil.requirements import all_below, passes
from fcc_hil.tangent_plane import away_m

PLANS = Path(__file__).parents[2] / "config/plans"
CIRCUIT = PLANS / "circuit.waypoints"


@pytest.mark.aircraft(wind=(270, 8))
@pytest.mark.autopilot(mode="plan", plan=CIRCUIT)
def test_a_circuit_is_flown_and_landed(flight: Flight) -> None:
    """Within the limits of a landing with a range finder but for the sink rate: there is none."""
    flight.engages(by=3)
    flight.passes(4, within=700, by=400)
    with pytest.raises(RequirementError, match=r"required: the aircraft lands by 410 s\n") as short:
        flight.lands(by=410)
    assert "flown:    it is not on the plan's runway at the end" in str(short.value)
    flight.lands(by=900, centre_line=5, sink=400, heading=5, along=300)
    # At the beginning it took off from there.
    flight.passes((45.0027, 8.0), within=20, by=900)
    with pytest.raises(RequirementError) as hard:
        flight.lands(by=900, sink=0.1)
    words = str(hard.value)
    assert "required: the aircraft lands by 900 s: sink 0.1 ft/min" in words
    assert re.search(
        r"flown: +off the centre line -?\d+\.\d m, sink \d+\.\d ft/min, off the", words
    )


@pytest.mark.autopilot(mode="plan", plan=PLANS / "twelve-legs.waypoints")
def test_what_is_not_passed_is_a_failure_that_says_how_near_it_came(flight: Flight) -> None:
    flight.engages(by=3)
    with pytest.raises(RequirementError) as failed:
        flight.passes(12, within=50, by=10)
    words = str(failed.value)
    assert "required: the aircraft passes item 12 within 50 m by 10 s" in words
    assert re.search(r"flown: +it comes within \d+\.\d m of it, at \d+\.\d+ s", words)
    with pytest.raises(ValueError, match="no item 99 of the plan has a place: those are 1, 2"):
        flight.passes(99, within=50, by=20)
    with pytest.raises(ValueError, match="within is 0: give more than 0"):
        flight.passes(1, within=0, by=20)


def test_a_flight_without_a_plan_has_no_items(flight: Flight) -> None:
    flight.engages(by=3)
    with pytest.raises(ValueError, match="those are none"):
        flight.passes(1, within=50, by=20)
    with pytest.raises(RuntimeError, match="there is no plan"):
        flight.lands(by=20)


def test_a_plan_and_its_mode_belong_together() -> None:
    for mode, plan in (("plan", None), ("hold", CIRCUIT)):
        with pytest.raises(ValueError, match="belong together"):
            autopilot_mark(mode, plan=plan)
    text = autopilot_mark("plan", plan=CIRCUIT).toml()
    assert f'[guidance]\nmode = "plan"\n[plan]\nfile = "{CIRCUIT.resolve()}"' in text


def test_how_far_a_place_is_from_a_track() -> None:
    """A minute of latitude is a sea mile: on WGS-84 at 45°, 1,852.2 m (NIMA TR8350.2, 3.4)."""
    track = (np.array([45.0, 45.0 + 1.0 / 60.0]), np.array([8.0, 8.0]))
    away = away_m(45.0, 8.0, track)
    assert away[0] == pytest.approx(0.0, abs=1e-6)
    assert away[1] == pytest.approx(1_852.2, abs=0.3)
    met = passes(np.array([1.0, 2.0]), away, 10.0)
    assert met.is_met
    assert met.flown == "it comes within 0.0 m of it, at 1.00 s"
    assert not passes(np.array([1.0]), away[1:], 1_000.0).is_met


def test_a_value_beyond_its_limit_on_either_side_is_not_met() -> None:
    for value, limit, is_met in ((-3.0, 2.0, False), (2.0, 2.0, True), (9.0, None, True)):
        verdict = all_below([("off", value, limit, "m")])
        assert verdict.is_met is is_met
        assert verdict.flown == f"off {value:.1f} m"
