"""Attitude or body rates that get an offset or a drift in flight.

JSBSim's truth; aircraft, gains and limits are the defaults. The seeds were not used while the
monitor was designed (those were 1 to 3).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import fcc
import numpy as np
import pytest

from fcc_hil.lockstep_rig import LockstepRig
from fcc_hil.plant import Plant, Weather
from fcc_hil.sensor_faults import Faults
from fcc_hil.standin import Settings
from fcc_hil.truth import Truth

SEED = 41
BEGINS_S = 30.0
LASTS_S = 40.0
END_S = 95.0
ATTITUDE = "attitude contradicts"
RATES = "body rates contradict"
OTHERS = ("airspeed of sensor", "altitude contradicts", "recovering from an upset")

Break = Callable[[Faults], object]


@dataclass(frozen=True)
class Flown:
    """A flight with a fault, in the first leg of the pattern."""

    truth: Truth
    events: list[tuple[float, str]]
    """With their times since engaging."""
    is_released: bool

    def when(self, text: str) -> float:
        """Return when an event came first, s."""
        return next(time_s for time_s, words in self.events if text in words)

    def said(self, *texts: str) -> list[str]:
        """Return the events with one of these texts."""
        return [words for _, words in self.events if any(text in words for text in texts)]

    def stayed_inside(self) -> None:
        """Assert that the aircraft stayed inside of its envelope."""
        load, airspeed_kt = self.truth["load_g"], self.truth["airspeed_kt"]
        altitude_ft = self.truth["altitude_ft"]
        assert load.min() > 0.0, load.min()
        assert load.max() < 2.5
        assert airspeed_kt.min() > 70.0
        assert airspeed_kt.max() < 130.0
        assert self.truth["angle_of_attack_deg"].max() < 10.0
        assert altitude_ft.min() > 2_900.0, altitude_ft.min()
        assert altitude_ft.max() < 3_300.0, altitude_ft.max()
        assert np.abs(self.truth["roll_deg"]).max() < 50.0
        assert not self.is_released


def _fly(break_it: Break, severity: int = 0) -> Flown:
    plant = Plant("c172p", seed=SEED, weather=Weather(turbulence_severity=severity))
    settings = Settings(port=0, aircraft="c172p", seed=SEED, noise=True)
    rig = LockstepRig(settings, plant, fcc.Machine('[guidance]\nmode = "timed-pattern"\n'))
    faults = Faults(lambda: rig.time_s, rig.set_faults, SEED)
    rig.prepare()
    rig.set_switch(on=True)
    rig.fly_to(rig.time_s + 1.0, until=lambda: rig.holds_control)
    began_s = rig.time_s
    break_it(faults)
    rig.fly_to(began_s + END_S, until=lambda: not rig.holds_control)
    events = [(event.time_s - began_s, event.text) for event in rig.events]
    return Flown(rig.truth(), events, is_released=not rig.holds_control)


@pytest.mark.fault(
    "Sensors",
    "attitude wrong in flight: offset, drift",
    "[3.5° off the integrated rates](envelope.md#attitude-and-body-rates)",
    "2 to 10 s",
    "failsafe, *attitude lost*",
)
@pytest.mark.parametrize("severity", [0, 3])
@pytest.mark.parametrize(
    "break_it",
    [
        pytest.param(
            lambda f: f.bias("attitude", by=8.0, after=BEGINS_S, lasts=LASTS_S), id="8 degrees"
        ),
        pytest.param(
            lambda f: f.drift("pitch", per_s=1.5, after=BEGINS_S, lasts=LASTS_S), id="drifts up"
        ),
        pytest.param(
            lambda f: f.drift("pitch", per_s=-1.5, after=BEGINS_S, lasts=LASTS_S),
            id="drifts down",
        ),
    ],
)
def test_a_wrong_attitude_is_doubted_and_flown_on_without(break_it: Break, severity: int) -> None:
    flown = _fly(break_it, severity)
    flown.stayed_inside()
    assert flown.said(*OTHERS, RATES) == []
    assert BEGINS_S < flown.when(ATTITUDE) < BEGINS_S + 10.0
    assert flown.when("failsafe cleared") < BEGINS_S + LASTS_S + 20.0


@pytest.mark.fault(
    "Sensors",
    "body rates wrong in flight by more than 4 °/s",
    "[3.5° off the integrated rates](envelope.md#attitude-and-body-rates)",
    "2 to 6 s",
    "failsafe, *body rates lost*",
)
@pytest.mark.parametrize("severity", [0, 3])
@pytest.mark.parametrize(
    "break_it",
    [
        pytest.param(
            lambda f: f.bias("pitch_rate", by=10.0, after=BEGINS_S, lasts=LASTS_S), id="offset"
        ),
        pytest.param(
            lambda f: f.drift("roll_rate", per_s=0.3, after=BEGINS_S, lasts=LASTS_S), id="drift"
        ),
    ],
)
def test_wrong_body_rates_are_doubted_and_flown_on_without(break_it: Break, severity: int) -> None:
    flown = _fly(break_it, severity)
    flown.stayed_inside()
    assert flown.said(*OTHERS, ATTITUDE) == []
    assert BEGINS_S < flown.when(RATES) < BEGINS_S + LASTS_S
    assert flown.when("failsafe cleared") < BEGINS_S + LASTS_S + 20.0


@pytest.mark.fault(
    "Sensors",
    "body rates wrong by up to 4 °/s",
    "[3.5° off the integrated rates](envelope.md#attitude-and-body-rates)",
    "2 to 10 s",
    "the offset is learned",
)
def test_an_offset_of_2_degrees_per_second_is_flown() -> None:
    flown = _fly(lambda f: f.bias("body_rates", by=2.0, after=BEGINS_S, lasts=LASTS_S))
    flown.stayed_inside()
    assert flown.said("failsafe", *OTHERS) == []
