"""Ailerons or an elevator that jam, and a reversed rudder, with JSBSim: what is left flies."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

import fcc
import pytest

from fcc_hil.lockstep_rig import LockstepRig
from fcc_hil.plant import Plant, Weather
from fcc_hil.standin import Settings
from fcc_hil.state import Controls

JAMS_S = 60.0
END_S = 300.0
UPSET_DEG = 45.0
"""Bank at which an upset begins (Airplane Upset Recovery Training Aid, FAA 2008, section 2.3)."""
MOST_BANK_DEG = 60.0
"""The most of a Cessna 172P in the normal category (handbook, section 2)."""
STALL_KT = 47.0
NEVER_EXCEED_KT = 158.0
"""Cessna 172P, pilot's operating handbook, sections 5 and 2."""
SEEDS = (31, 32)
"""None of the law's constants was chosen on these."""
HOLD = '[guidance]\nmode = "hold"\n'
TURNS_S, TURNS_BACK_S = 70.0, 160.0
HEADINGS_DEG = {TURNS_S: 90.0, TURNS_BACK_S: 300.0}
"""To the right, and to the left."""
HEADING_DEG = 10.0
ALTITUDE_FT = 100.0
"""As an instrument pilot keeps them (FAA-S-ACS-8)."""
SAID = {
    "aileron": "the ailerons do not move the aircraft",
    "elevator": "the elevator does not move the aircraft",
    "rudder": "the rudder turns the aircraft the other way",
}


class JammingRig(LockstepRig):
    """One control stands still from a time on, a rudder is reversed.

    What is read back is what was commanded.
    """

    jams: str | None = None
    at: float | None = None
    commanded: Controls | None = None

    def _write(self, controls: Controls) -> None:
        self.commanded = controls
        jams = self.jams if self.plant.time_s >= JAMS_S else None
        if jams == "rudder":
            controls = replace(controls, rudder=-controls.rudder)
        elif jams is not None:
            if self.at is None:
                self.at = getattr(controls, jams)
            controls = replace(controls, **{jams: self.at})
        super()._write(controls)

    def _stand(self) -> Controls:
        return self.commanded or self.plant.controls


def _fly(
    seed: int,
    turbulence: int,
    jams: str | None,
    at: float | None = None,
    headings_deg: Mapping[float, float] | None = None,
    aircraft: str = "c172p",
) -> JammingRig:
    """Fly the timed pattern, or hold headings from their times on."""
    weather = Weather(wind_kt=10.0, wind_from_deg=40.0, turbulence_severity=turbulence)
    plant = Plant(aircraft, seed=seed, weather=weather)
    settings = Settings(aircraft=aircraft, seed=seed, noise=True)
    rig = JammingRig(settings, plant, fcc.Machine(HOLD if headings_deg else ""))
    rig.jams, rig.at = jams, at
    rig.prepare()
    rig.set_switch(on=True)
    for time_s, heading_deg in (headings_deg or {}).items():
        rig.fly_to(time_s)
        rig.machine.command(heading_rad=math.radians(heading_deg))
    rig.fly_to(END_S)
    return rig


def _found_after_s(rig: JammingRig, jams: str) -> float:
    said = [event for event in rig.events if SAID[jams] in event.text]
    assert len(said) == 1, [event.text for event in rig.events]
    assert any("the outputs do not reach the aircraft" in event.text for event in rig.events)
    return said[0].time_s - JAMS_S


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("at", [None, 0.15, -0.15])
def test_with_jammed_ailerons_headings_are_flown_by_the_rudder(seed: int, at: float | None) -> None:
    rig = _fly(seed, 2, "aileron", at, HEADINGS_DEG)
    # Where they stand as they should, nothing shows it before the turn.
    assert 0.0 < _found_after_s(rig, "aileron") < TURNS_S - JAMS_S + 10.0
    later = rig.truth().since(JAMS_S)
    assert abs(later["roll_deg"]).max() < UPSET_DEG
    assert abs(later["altitude_ft"] - later["altitude_ft"][0]).max() < ALTITUDE_FT
    for before_s, heading_deg in ((TURNS_BACK_S, 90.0), (END_S, 300.0)):
        truth = rig.truth().since(before_s - 20.0)
        window = truth["time_s"] < before_s
        off_deg = (truth["heading_deg"][window] - heading_deg + 180.0) % 360.0 - 180.0
        assert abs(off_deg).max() < HEADING_DEG


@pytest.mark.parametrize("seed", SEEDS)
def test_with_a_jammed_elevator_height_is_held_by_the_throttle(seed: int) -> None:
    rig = _fly(seed, 2, "elevator")
    assert 0.0 < _found_after_s(rig, "elevator") < 30.0
    later = rig.truth().since(JAMS_S)
    assert later["altitude_ft"][0] - later["altitude_ft"].min() < 1_000.0
    assert later["airspeed_kt"].min() > STALL_KT
    assert later["airspeed_kt"].max() < NEVER_EXCEED_KT


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("aircraft", ["c172p", "c182"])
def test_a_reversed_rudder_stays_where_it_was(aircraft: str, seed: int) -> None:
    rig = _fly(seed, 2, "rudder", headings_deg=HEADINGS_DEG, aircraft=aircraft)
    assert 0.0 < _found_after_s(rig, "rudder") < TURNS_BACK_S - JAMS_S
    later = rig.truth().since(JAMS_S)
    # It rolls before it is found; then the yaw is not damped in turbulence.
    assert abs(later["roll_deg"]).max() < MOST_BANK_DEG
    assert later["airspeed_kt"].min() > STALL_KT
    assert abs(later["altitude_ft"] - later["altitude_ft"][0]).max() < ALTITUDE_FT
    end = rig.truth().since(END_S - 20.0)
    off_deg = (end["heading_deg"] - 300.0 + 180.0) % 360.0 - 180.0
    assert abs(off_deg.mean()) < HEADING_DEG


@pytest.mark.parametrize("turbulence", [3, 6])
def test_turbulence_is_no_jammed_surface(turbulence: int) -> None:
    rig = _fly(SEEDS[0], turbulence, None)
    said = " ".join(event.text for event in rig.events)
    assert not any(text in said for text in SAID.values())
