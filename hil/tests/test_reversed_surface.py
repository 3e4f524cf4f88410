"""Ailerons and elevator that act the wrong way, or are exchanged, with JSBSim: named, left alone.

As by a servo whose direction is set wrongly, or two plugs that are exchanged. None of the law's
constants was chosen on these aircraft and seeds (c172p, c172x, J3Cub and c182, seeds 1 to 3).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import fcc
import pytest

from fcc_hil.actuation import Actuation
from fcc_hil.lockstep_rig import Conditions, LockstepRig
from fcc_hil.plant import Plant, Weather
from fcc_hil.standin import Settings
from fcc_hil.state import Controls

ENDS_S = 40.0
FOUND_S = 6.0
"""The slowest, pa28, diverges for 5 s."""
MOST_BANK_DEG = 60.0
"""The most of a light aircraft in the normal category (14 CFR 23.3, 2016)."""
LEAST_FT = 2_000.0
"""From 3,000 ft."""
SEEDS = ((61, 0), (62, 3))
"""And the severity of the turbulence."""
AIRCRAFT = ("c172r", "pa28")
WRONG = "move the aircraft the wrong way"
SAID = {
    "ailerons": ("the ailerons move the aircraft the wrong way",),
    "elevator": ("the elevator moves the aircraft the wrong way",),
    "exchanged": ("ailerons and elevator move the aircraft the wrong way, or are exchanged",),
}
Wiring = Callable[[Controls], Controls]
WIRINGS: dict[str, Wiring] = {
    "ailerons": lambda to: replace(to, aileron=-to.aileron),
    "elevator": lambda to: replace(to, elevator=-to.elevator),
    "exchanged": lambda to: replace(to, elevator=to.aileron, aileron=to.elevator),
}


class WiredRig(LockstepRig):
    """The autopilot's outputs reach the surfaces through a wiring; the pilot's do not."""

    wiring: Wiring | None = None
    began_s = 0.0

    def _write(self, controls: Controls) -> None:
        if self.wiring is not None and self.holds_control:
            controls = self.wiring(controls)
        super()._write(controls)


def _fly(
    aircraft: str,
    seed: int,
    severity: int,
    wiring: str | None,
    conditions: Conditions | None = None,
    ends_s: float = ENDS_S,
) -> WiredRig:
    weather = Weather(wind_kt=10.0, wind_from_deg=40.0, turbulence_severity=severity)
    plant = Plant(aircraft, seed=seed, weather=weather)
    settings = Settings(aircraft=aircraft, seed=seed, noise=True)
    machine = fcc.Machine('[guidance]\nmode = "timed-pattern"\n')
    rig = WiredRig(settings, plant, machine, conditions)
    rig.wiring = WIRINGS[wiring] if wiring else None
    rig.prepare()
    rig.set_switch(on=True)
    rig.fly_to(rig.time_s + 1.0, until=lambda: rig.holds_control)
    assert rig.holds_control
    rig.began_s = rig.time_s
    rig.fly_to(rig.time_s + ends_s)
    return rig


def _wrong(rig: WiredRig) -> list[str]:
    return [event.text for event in rig.events if "wrong way" in event.text]


@pytest.mark.parametrize(("seed", "severity"), SEEDS)
@pytest.mark.parametrize("wiring", WIRINGS)
@pytest.mark.parametrize("aircraft", AIRCRAFT)
def test_a_wrong_wiring_is_named_and_left_alone(
    aircraft: str, wiring: str, seed: int, severity: int
) -> None:
    rig = _fly(aircraft, seed, severity, wiring)
    said = _wrong(rig)
    assert said, [event.text for event in rig.events]
    assert any(text in said[-1] for text in SAID[wiring]), said
    first_s = next(event.time_s for event in rig.events if "wrong way" in event.text)
    assert first_s - rig.began_s < FOUND_S
    flown = rig.truth()
    assert abs(flown["roll_deg"]).max() < MOST_BANK_DEG
    assert flown["altitude_ft"].min() > LEAST_FT


@pytest.mark.parametrize(("seed", "severity"), [*SEEDS, (63, 7)])
@pytest.mark.parametrize(
    "conditions",
    [
        pytest.param(Conditions(), id="at once"),
        pytest.param(Conditions(actuation=Actuation(servo_hz=0.53)), id="servo lags 0.3 s"),
        pytest.param(Conditions(sensor_delay_ticks=12), id="readings 0.3 s old"),
        pytest.param(Conditions(raw_sensors="phone"), id="phone"),
    ],
)
@pytest.mark.parametrize("aircraft", AIRCRAFT)
def test_a_right_wiring_is_not_wrong(
    aircraft: str, conditions: Conditions, seed: int, severity: int
) -> None:
    rig = _fly(aircraft, seed, severity, None, conditions, ends_s=15.0)
    assert _wrong(rig) == []
