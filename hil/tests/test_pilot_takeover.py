"""The pilot's own stick takes over, in JSBSim's c172p."""

from __future__ import annotations

import math

import fcc
import pytest

from fcc_hil.aircraft import by_name
from fcc_hil.lockstep_rig import LockstepRig
from fcc_hil.plant import Plant
from fcc_hil.standin import Settings

CONFIG = '[guidance]\nmode = "hold"\n[engage]\nstick_takeover = 0.3\n'
TEXT = "the pilot takes over: the roll control is {:.2f} of full deflection"


def flight(config: str = CONFIG, rest: float = 0.0) -> LockstepRig:
    """Fly in standby for two seconds, the stick resting there."""
    settings = Settings(port=0, aircraft="c172p", seed=12, noise=True)
    rig = LockstepRig(settings, Plant(by_name("c172p"), seed=12), fcc.Machine(config))
    rig.stick = (0.0, rest, 0.0)
    rig.prepare()
    return rig


def fly(rig: LockstepRig, seconds: float) -> str:
    """Fly on; return the state of the loop."""
    rig.fly_to(rig.time_s + seconds)
    return rig.machine.state


def engaged(config: str = CONFIG, rest: float = 0.0) -> LockstepRig:
    rig = flight(config, rest)
    rig.set_switch(on=True)
    assert fly(rig, 1.0) == "engaged"
    return rig


def texts(rig: LockstepRig) -> str:
    return "\n".join(event.text for event in rig.events)


@pytest.mark.fault(
    "Simulator and link",
    "pilot moves stick or pedals (`engage.stick_takeover`)",
    "[threshold](envelope.md#who-has-control)",
    "{engage.stick_takeover_s} s (`stick_takeover_s`)",
    "given back; event",
)
@pytest.mark.parametrize(("rest", "held"), [(0.0, -0.35), (0.4, 0.75), (0.4, 0.0)])
def test_the_stick_takes_over_and_keeps_control(rest: float, held: float) -> None:
    rig = engaged(rest=rest)
    assert fly(rig, 1.0) == "engaged"
    rig.stick = (0.0, held, 0.0)
    assert fly(rig, 0.19) == "engaged"
    assert fly(rig, 0.06) == "standby"
    assert not rig.holds_control
    assert TEXT.format(abs(held - rest)) in texts(rig)
    assert "the pilot moves the controls" in texts(rig)
    # Engaging is refused while it is held there.
    rig.machine.engage()
    assert fly(rig, 0.5) == "standby"
    # It does not engage by itself, but by the switch: off and on.
    rig.stick = (0.0, rest, 0.0)
    assert fly(rig, 3.0) == "standby"
    rig.set_switch(on=False)
    assert fly(rig, 1.0) == "standby"
    rig.set_switch(on=True)
    assert fly(rig, 1.0) == "engaged"


@pytest.mark.parametrize("bad", [math.nan, 1.0, -1.0, 1e9, math.inf])
def test_single_bad_samples_change_nothing(bad: float) -> None:
    rig = engaged()
    for _ in range(20):
        rig.stick = (bad, bad, bad)
        assert fly(rig, 0.025) == "engaged"
        rig.stick = (0.0, 0.0, 0.0)
        assert fly(rig, 0.1) == "engaged"


def test_a_stick_that_is_not_measured_any_longer_counts_for_nothing() -> None:
    rig = engaged()
    rig.stick = (0.0, 0.8, 0.0)
    assert fly(rig, 0.1) == "engaged"
    rig.stick = None
    assert fly(rig, 3.0) == "engaged"


def test_without_the_key_the_stick_does_nothing() -> None:
    rig = engaged('[guidance]\nmode = "hold"\n')
    rig.stick = (1.0, 1.0, 1.0)
    assert fly(rig, 3.0) == "engaged"
