"""Good sensors that are coarse or slow are flown; frozen ones are found.

The pattern turns by 90 degrees and climbs or descends 150 ft each 20 s. Truth is JSBSim's. The
seeds were not used for tuning.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import fcc
import numpy as np
import pytest

from fcc_hil import airspeed, altitude, heading
from fcc_hil.lockstep_rig import LockstepRig
from fcc_hil.plant import Plant, Weather
from fcc_hil.quantities import SENSORS, Samples
from fcc_hil.sensor_faults import Faults
from fcc_hil.standin import Settings

SEED = 4107
LEGS_S = 59.5
"""20 s of hold and two legs."""


def _one_knot(faults: Faults) -> None:
    faults.round(airspeed, to=1.0)


def _hundred_feet(faults: Faults) -> None:
    faults.round(altitude, to=100.0)


def _one_degree(faults: Faults) -> None:
    faults.round(heading, to=1.0)


def _ten_hertz(faults: Faults) -> None:
    for name in SENSORS:
        faults.slow(name, to_hz=10.0)


def _all(faults: Faults) -> None:
    for make in (_one_knot, _hundred_feet, _one_degree, _ten_hertz):
        make(faults)


def _fly(
    make: Callable[[Faults], None], turbulence: int, seconds: float = LEGS_S
) -> tuple[LockstepRig, Faults]:
    settings = Settings(port=0, aircraft="c172p", noise=turbulence > 0, seed=SEED)
    plant = Plant("c172p", seed=SEED, weather=Weather(turbulence_severity=turbulence))
    rig = LockstepRig(settings, plant, fcc.Machine(""))
    faults = Faults(lambda: rig.time_s, rig.set_faults)
    make(faults)
    rig.prepare()
    rig.set_switch(on=True)
    rig.fly_to(rig.time_s + seconds)
    return rig, faults


CASES: Mapping[str, tuple[Callable[[Faults], None], float]] = {
    # Beside the way it is made coarse: how far the altitude may be from its set point, ft; an
    # altimeter of 100 ft shows it to within half of that.
    "1 kt": (_one_knot, 10.0),
    "100 ft": (_hundred_feet, 60.0),
    "1 deg": (_one_degree, 10.0),
    "10 Hz": (_ten_hertz, 10.0),
    "all of it": (_all, 60.0),
}


@pytest.mark.parametrize("turbulence", [0, 3])
@pytest.mark.parametrize("case", CASES)
def test_coarse_and_slow_sensors_are_flown(case: str, turbulence: int) -> None:
    make, altitude_ft = CASES[case]
    rig, _ = _fly(make, turbulence)
    assert rig.holds_control
    assert not [event for event in rig.events if "failsafe" in event.text or "frozen" in event.text]
    truth = rig.truth()
    engaged = truth["time_s"] > 3.0
    # In calm air the pattern ends on its first altitude, 180 degrees away.
    assert truth["altitude_ft"][-1] == pytest.approx(3_000.0, abs=altitude_ft)
    assert np.max(truth["altitude_ft"][engaged]) < 3_150.0 + altitude_ft
    assert np.min(truth["altitude_ft"][engaged]) > 3_000.0 - altitude_ft
    gust_kt = 12.0 * (turbulence > 0)
    assert np.max(np.abs(truth["airspeed_kt"][engaged] - 100.0)) < 4.0 + gust_kt
    away_deg = (truth["heading_deg"][-1] - truth["heading_deg"][0]) % 360.0
    assert away_deg == pytest.approx(180.0, abs=1.5 + 3.0 * (turbulence > 0))
    assert np.max(np.abs(truth["roll_deg"])) < 36.0


def test_an_altimeter_of_100_ft_does_not_move_the_nose_with_each_step() -> None:
    """Half of the steps of an ideal altimeter come in the climbs; none moves the pitch by a degree.

    A filter that follows the steps pitches by more than 5 degrees.
    """
    fine, coarse = (_fly(make, 0)[0].truth() for make in (_one_degree, _hundred_feet))
    assert len(fine["pitch_deg"]) == len(coarse["pitch_deg"])

    def fastest(pitch_deg: Samples) -> float:
        return float(np.max(np.abs(np.diff(pitch_deg[200:])))) * 40.0

    assert fastest(coarse["pitch_deg"]) < fastest(fine["pitch_deg"]) + 2.0


def test_a_coarse_heading_that_freezes_is_found() -> None:
    rig, faults = _fly(_all, 0, seconds=12.0)
    faults.freeze(heading)
    rig.fly_to(rig.time_s + 60.0, until=lambda: not rig.holds_control)
    assert any("heading is frozen" in event.text for event in rig.events), rig.events
